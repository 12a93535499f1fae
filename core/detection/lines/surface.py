# SPDX-License-Identifier: GPL-3.0-or-later
"""Points near a mesh brought onto it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from ..mesh.blocks import parts
from ..mesh.mesh import TriangleMesh
from ..mesh.ordering import order_by


@dataclass(frozen=True)
class Surface:
    """Closest points on a mesh, looked for among the faces at the nearest vertices."""

    mesh: TriangleMesh

    def near_boundary(self, points: np.ndarray, distance: float) -> np.ndarray:
        """(k,) bool, points nearer than `distance` (scene units, exclusive) to a vertex of an open boundary.

        The surface there is known from one side only, and its curvature with it.
        """
        rim = self.mesh.vertices[self.mesh.boundary_vertices]
        if distance <= 0 or not len(rim) or not len(points):
            return np.zeros(len(points), bool)
        return cKDTree(rim).query(points, distance_upper_bound=distance)[0] < distance

    @cached_property
    def _tree(self):
        # cuts at the middle of the box instead of the median: built in a third of the time, scans are even enough
        return cKDTree(self.mesh.vertices, balanced_tree=False, compact_nodes=False)

    @cached_property
    def _fan(self):
        """Faces at each vertex: offsets (n + 1,) and face ids."""
        flat = self.mesh.faces.ravel()
        order = order_by(flat, count=len(self.mesh.vertices))
        offsets = np.r_[0, np.cumsum(np.bincount(flat, minlength=len(self.mesh.vertices)))]
        return offsets, order // 3

    def closest(self, points: np.ndarray, neighbours: int = 6, tick=lambda: None):
        """Closest point on the surface to each point; `tick()` is called now and then.

        Returns
        -------
        faces : (k,) int64
        barycentric : (k, 3) float64, weights of the face's corners
        distance : (k,) float64
        """
        tree, fan = self._tree, self._fan
        tick()
        faces, weights, distance = np.zeros(len(points), np.int64), np.zeros((len(points), 3)), np.zeros(len(points))
        for part in parts(len(points)):
            faces[part], weights[part], distance[part] = self._closest(points[part], neighbours, tree, fan)
            tick()
        return faces, weights, distance

    def _closest(self, points, neighbours, tree, fan):
        neighbours = min(neighbours, len(self.mesh.vertices))
        near = np.asarray(tree.query(points, neighbours)[1]).reshape(len(points), -1)
        offsets, fan = fan
        size = (offsets[near + 1] - offsets[near]).ravel()
        owner = np.repeat(np.repeat(np.arange(len(points)), neighbours), size)
        start = np.repeat(offsets[near].ravel() - (np.cumsum(size) - size), size)
        faces = fan[np.arange(len(start)) + start]
        weights, distance = _on_triangles(points[owner], self.mesh.vertices[self.mesh.faces[faces]])
        order = np.lexsort((distance, owner))
        best = order[np.r_[True, np.diff(owner[order]) > 0]] if len(order) else order
        return faces[best], weights[best], distance[best]


def _on_triangles(points, corners):
    """Barycentric weights (k, 3) of the point of each triangle (k, 3, 3) closest to each point, and the distance.

    The foot on the plane if it lies inside, else the closest of the feet on the three sides.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    wb = np.einsum("ij,ij->i", np.cross(points - a, c - a), normal) / square
    wc = np.einsum("ij,ij->i", np.cross(b - a, points - a), normal) / square
    candidates = [np.stack([1 - wb - wc, wb, wc], axis=1)]
    valid = [(candidates[0] >= 0).all(axis=1)]
    for j in range(3):
        p, q = corners[:, j], corners[:, (j + 1) % 3]
        side = q - p
        t = np.einsum("ij,ij->i", points - p, side) / np.maximum(np.einsum("ij,ij->i", side, side), 1e-300)
        t = np.clip(t, 0, 1)
        weight = np.zeros((len(points), 3))
        weight[:, j], weight[:, (j + 1) % 3] = 1 - t, t
        candidates.append(weight)
        valid.append(np.ones(len(points), bool))
    candidates, valid = np.stack(candidates, axis=1), np.stack(valid, axis=1)
    feet = np.einsum("kcj,kjd->kcd", candidates, corners)
    distance = np.where(valid, np.linalg.norm(feet - points[:, None], axis=2), np.inf)
    best = distance.argmin(axis=1)
    rows = np.arange(len(points))
    return candidates[rows, best], distance[rows, best]
