# SPDX-License-Identifier: GPL-3.0-or-later
"""Heat diffusion of fields on a mesh: the smoothing scale of detection.

Diffusion for the time s^2 / 2 spreads a value like a Gaussian of standard deviation s. The Laplacian is the
cotangent one, with areas as masses, so that the width is a length on the surface and not a number of edges:
fine and coarse regions are smoothed alike. Where the edges are longer than s, the local edge length takes
its place, because a field cannot be smoothed by less than its sampling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from ..mesh.blocks import gather, parts, sums
from ..mesh.mesh import TriangleMesh

_COTANGENT = (0.02, 5.0)
"""Bounds of an edge weight. A negative weight (obtuse neighbours) would let values overshoot, a huge one
(slivers) would make the system slow to solve; both bounds are far outside well-shaped triangles (0.58)."""

_RESIDUAL = 0.01
"""The solution of a step counts as reached when this share of the first residual is left. That residual is what the
step has to change, so the share holds far from the origin and in large scenes alike."""

_STEPS = 3
"""Implicit steps per diffusion: their kernel is close to a Gaussian, one alone is peaked with long tails."""

_COLUMNS = 5
"""Fields solved for at a time: side by side they share the matrix, but need more memory and longer steps."""


@dataclass(frozen=True)
class Diffusion:
    """Smooths vertex fields of one mesh.

    laplacian : (n, n) sparse, symmetric, rows sum to zero
    diagonal : (n,) int64, where its diagonal stands in `laplacian.data`
    mass : (n,) float64, the area that belongs to each vertex
    local : (n,) float64, local edge length, scene units
    """

    laplacian: sparse.csr_matrix
    diagonal: np.ndarray
    mass: np.ndarray
    local: np.ndarray

    @classmethod
    def of(cls, mesh: TriangleMesh, tick=lambda: None) -> Diffusion:
        n, edges = len(mesh.vertices), len(mesh.edges)
        weight, mass = sums(edges, 1), sums(n, 1)
        for part in parts(len(mesh.faces)):
            faces = mesh.faces[part]
            p = mesh.vertices[faces]
            side = p[:, [2, 0, 1]] - p[:, [1, 2, 0]]  # side j is opposite corner j
            area = 0.5 * np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1)
            cot = corner_cotangents(side, area)
            gather(weight, mesh.face_edges[part].ravel(), 0.5 * cot.reshape(-1, 1))
            gather(mass, faces.ravel(), corner_areas(side, cot, area).reshape(-1, 1))
            tick()
        weight = np.clip(weight[:, 0], *_COTANGENT)
        i, j = mesh.edges.T
        around = np.bincount(i, weight, n) + np.bincount(j, weight, n)
        tick()
        row, column = np.r_[i, j, np.arange(n)], np.r_[j, i, np.arange(n)]
        laplacian = sparse.coo_matrix((np.r_[-weight, -weight, around], (row, column)), (n, n)).tocsr()
        tick()
        row = np.repeat(np.arange(n), np.diff(laplacian.indptr))
        diagonal = np.flatnonzero(laplacian.indices == row)
        tick()
        length = np.bincount(i, mesh.edge_lengths, n) + np.bincount(j, mesh.edge_lengths, n)
        local = length / (np.bincount(i, minlength=n) + np.bincount(j, minlength=n))
        return cls(laplacian, diagonal, mass[:, 0], local)

    def width(self, scale: float, least: float = 0.3) -> np.ndarray:
        """(n,) float64, the standard deviation used at each vertex: `scale`, or `least` local edges if longer.

        A scale of 0 asks for no smoothing at all and gets none."""
        return np.maximum(scale, least * self.local) if scale > 0 else np.zeros_like(self.local)

    def smooth(self, values: np.ndarray, width: np.ndarray, steps: int = _STEPS, tick=None) -> np.ndarray:
        """Diffuse a field (n, k) by the standard deviation `width` (n,), scene units.

        Each step solves (D + L) x = D x0 with D = mass / time, which is symmetric and positive for a width that
        varies too. Conjugate gradients with the diagonal as preconditioner need about as many iterations
        as the width has edge lengths times four. `tick()` is called once an iteration.
        """
        if not np.any(width > 0):
            return np.array(values, np.float64)
        time = width**2 / (2 * steps)
        load = (self.mass / np.maximum(time, 1e-300))[:, None]
        system = self.laplacian.copy()
        system.data[self.diagonal] += load[:, 0]
        inverse = 1 / system.data[self.diagonal][:, None]
        if tick is not None:
            tick()
        out = np.empty(values.shape)
        for first in range(0, values.shape[1], _COLUMNS):
            x = np.array(values[:, first : first + _COLUMNS], np.float64, order="C")
            for _ in range(steps):
                x = _conjugate_gradients(system, load * x, x, inverse, tick)
            out[:, first : first + _COLUMNS] = x
        return out


def corner_areas(side: np.ndarray, cot: np.ndarray, area: np.ndarray) -> np.ndarray:
    """(m, 3) float64: the part of each face nearer to a corner than to the others (Voronoi area).

    side : (m, 3, 3), side j opposite corner j; cot : (m, 3), of the corners; area : (m,)

    In a face with an obtuse corner that part leaves the face; the corner gets half of the area then
    and the others a quarter each (the mixed area of Meyer et al. 2003).
    """
    square = np.einsum("ijk,ijk->ij", side, side)
    share = square * cot / 8
    voronoi = share[:, [1, 2, 0]] + share[:, [2, 0, 1]]
    obtuse = cot < 0
    mixed = area[:, None] * np.where(obtuse, 0.5, 0.25)
    return np.where(obtuse.any(axis=1)[:, None], mixed, voronoi)


def corner_cotangents(side: np.ndarray, area: np.ndarray) -> np.ndarray:
    """(m, 3) float64, cotangents of the corners: -(side j+1 . side j+2) / (2 area)."""
    dot = np.einsum("ijk,ijk->ij", side[:, [1, 2, 0]], side[:, [2, 0, 1]])
    return -dot / np.maximum(2 * area, 1e-300)[:, None]


def _conjugate_gradients(system, right, x, inverse, tick):
    """Columns solved side by side, each with its own step lengths; stops when all have converged."""
    r = right - system @ x
    z = inverse * r
    p = z.copy()
    rz = np.einsum("ij,ij->j", r, z)
    goal = _RESIDUAL**2 * rz.sum()
    if tick is not None:
        tick()
    for _ in range(200):
        if rz.sum() <= goal:
            break
        if tick is not None:
            tick()
        q = system @ p
        curve = np.einsum("ij,ij->j", p, q)
        alpha = np.divide(rz, curve, out=np.zeros_like(rz), where=curve > 0)
        x = x + alpha * p
        r -= alpha * q
        z = inverse * r
        new = np.einsum("ij,ij->j", r, z)
        p *= np.divide(new, rz, out=np.zeros_like(rz), where=rz > 0)
        p += z
        rz = new
    return x
