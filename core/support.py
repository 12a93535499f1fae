# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest samples by table look-up."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

FACING = 0.7
"""Least cosine between the normals of the surface at a sample and at its image. Noise turns them by 20 degrees; the
inner and the outer side of a moulding, which runs beside itself, lie farther apart."""


class NeighbourField:
    """Nearest sample of the network by table look-up: one entry a voxel, exact to half a voxel.

    points : (n, 3) in the network's frame, where the box around them is tight
    radius : look-ups farther than this from every sample give -1
    """

    def __init__(self, points, radius, *, voxel=None, most=1 << 26):
        self.low = points.min(axis=0) - radius
        extent = points.max(axis=0) + radius - self.low
        voxel = radius / 2 if voxel is None else voxel
        while np.prod(np.ceil(extent / voxel) + 1) > most:
            voxel *= 1.2
        self.voxel = voxel
        self.shape = (np.ceil(extent / voxel) + 1).astype(np.int64)
        self.strides = np.array([self.shape[1] * self.shape[2], self.shape[2], 1])
        reach = int(np.ceil(radius / voxel))
        k = np.arange(-reach, reach + 1)
        ball = np.stack(np.meshgrid(k, k, k, indexing="ij"), -1).reshape(-1, 3)
        ball = ball[np.linalg.norm(np.maximum(np.abs(ball) - 1, 0), axis=1) * voxel <= radius]
        cell = np.unique(((points - self.low) / voxel).astype(np.int64) @ self.strides)
        cell = np.stack(np.unravel_index(cell, self.shape), axis=1)
        near = np.zeros(np.prod(self.shape), bool)
        for offset in ball:
            at = cell + offset
            at = at[((at >= 0) & (at < self.shape)).all(axis=1)]
            near[at @ self.strides] = True
        near = np.flatnonzero(near)
        centre = (np.stack(np.unravel_index(near, self.shape), axis=1) + 0.5) * voxel + self.low
        distance, sample = cKDTree(points).query(centre, distance_upper_bound=radius + voxel, workers=-1)
        self.table = np.full(np.prod(self.shape), -1, np.int32)
        found = np.isfinite(distance)
        self.table[near[found]] = sample[found]

    def look_up(self, x, y, z):
        """Nearest samples (...,) int32, or -1, at voxel coordinates (...,) int32."""
        inside = (x >= 0) & (y >= 0) & (z >= 0)
        inside &= (x < self.shape[0]) & (y < self.shape[1]) & (z < self.shape[2])
        key = x * np.int32(self.strides[0])
        key += y * np.int32(self.strides[1])
        key += z
        key *= inside
        near = np.take(self.table, key, mode="clip")
        near[~inside] = -1
        return near
