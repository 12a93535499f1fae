# SPDX-License-Identifier: GPL-3.0-or-later
"""How a mesh bends at a place, read off its edges alone: a judge that shares nothing with either detection.

The mean curvature measure of Cohen-Steiner and Morvan (2003): dihedral angle times length of the edges near the
place, over the area there. Convex is positive.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from core.detection import TriangleMesh
from core.detection.lines.sharp import dihedral_angles
from core.detection.mesh.edges import face_pairs

_BLOCK = 4000


class Bending:
    """Evaluates the measure within `radius` edge lengths, with a weight that falls smoothly to its rim."""

    def __init__(self, mesh: TriangleMesh, radius: float = 1.5):
        h = mesh.edge_length
        self.mesh, self.radius, step = mesh, radius * h, h / 4
        p = mesh.vertices[mesh.faces]
        normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        area = 0.5 * np.linalg.norm(normal, axis=1)
        normal /= 2 * area[:, None]
        a, b = (at // 3 for at in face_pairs(mesh.face_edges, mesh.edge_faces))
        two, middle = mesh.edge_faces == 2, p.mean(axis=1)
        # out of the plane of one face lies the other, on the inner side where the edge is convex
        convex = np.sign(np.einsum("ij,ij->i", middle[a] - middle[b], normal[a] - normal[b]))
        ends, length = mesh.vertices[mesh.edges[two]], mesh.edge_lengths[two]
        count = np.ceil(length / step).astype(np.int64)
        edge = np.repeat(np.arange(len(count)), count)
        t = ((np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[edge])[:, None]
        self._edges = cKDTree((1 - t) * ends[edge, 0] + t * ends[edge, 1])
        self._turn = (dihedral_angles(mesh)[two] * convex * length / count)[edge]
        count = np.ceil(area / step**2).astype(np.int64)
        face = np.repeat(np.arange(len(count)), count)
        corner = np.random.default_rng(0).dirichlet((1, 1, 1), len(face))
        self._faces = cKDTree(np.einsum("ij,ijk->ik", corner, p[face]))
        self._area = (area / count)[face]

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """(k,) float64, 1 / length."""
        return np.concatenate([self._at(points[i : i + _BLOCK]) for i in range(0, len(points), _BLOCK)] or [[]])

    def _at(self, points):
        tree = cKDTree(points)
        sums = []
        for other, values in ((self._edges, self._turn), (self._faces, self._area)):
            near = tree.sparse_distance_matrix(other, self.radius, output_type="coo_matrix")
            weight = (1 - (near.data / self.radius) ** 2) ** 2
            sums.append(np.bincount(near.row, weight * values[near.col], len(points)))
        return sums[0] / np.maximum(sums[1], 1e-300)

    def borne_out(self, points: np.ndarray, sign: float, around: float = 2.0) -> np.ndarray:
        """(k,) bool: the mesh bends that way here, and at least half as much as anywhere within `around` edges."""
        mesh = self.mesh
        places = np.concatenate([mesh.vertices, mesh.vertices[mesh.edges].mean(axis=1)])
        reach = around * mesh.edge_length
        near = cKDTree(points).sparse_distance_matrix(cKDTree(places), reach, output_type="coo_matrix")
        used, at = np.unique(near.col, return_inverse=True)
        most = np.zeros(len(points))
        np.maximum.at(most, near.row, sign * self(places[used])[at])
        own = sign * self(points)
        return (own > 0) & (own >= 0.5 * most)
