# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature lines that are edges of the mesh itself: sharp ones and open boundaries."""

from __future__ import annotations

import numpy as np

from ..curvature.tensor import Curvature
from ..mesh.edges import face_pairs
from ..mesh.mesh import TriangleMesh
from .extremality import fold_angle
from .lines import Lines


def dihedral_angles(mesh: TriangleMesh) -> np.ndarray:
    """(e,) float64, radians: the angle between the normals of an edge's two faces; 0 at a boundary, pi where
    more than two faces meet."""
    p = mesh.vertices[mesh.faces]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    angle = np.where(mesh.edge_faces > 2, np.pi, 0.0)
    a, b = (at // 3 for at in face_pairs(mesh.face_edges, mesh.edge_faces))
    # atan2 keeps small angles exact, which arccos does not
    sine = np.linalg.norm(np.cross(normal[a], normal[b]), axis=1)
    angle[mesh.edge_faces == 2] = np.arctan2(sine, np.einsum("ij,ij->i", normal[a], normal[b]))
    return angle


def sharp_lines(mesh: TriangleMesh, curvature: Curvature, angle: float) -> Lines:
    """Edges that bend the surface by at least `angle` (radians, inclusive)."""
    return _along_edges(mesh, curvature, dihedral_angles(mesh) >= angle)


def boundary_lines(mesh: TriangleMesh, curvature: Curvature) -> Lines:
    """Edges with one face only."""
    return _along_edges(mesh, curvature, mesh.edge_faces == 1)


def _along_edges(mesh, curvature, chosen) -> Lines:
    used, segments = np.unique(mesh.edges[chosen], return_inverse=True)
    strength = curvature.strength[used]
    fold = fold_angle(strength, curvature.width[used], mesh.edge_length)
    return Lines(mesh.vertices[used], curvature.normals[used], strength, fold, segments.reshape(-1, 2))
