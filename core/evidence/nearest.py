# SPDX-License-Identifier: GPL-3.0-or-later
"""Nearest samples by table look-up: a table over blocks of voxels that exist near the samples only."""

from __future__ import annotations

import numpy as np

SIDE = 8
"""Voxels along the side of a block; numerical."""

MOST = 1 << 24
"""Most blocks that the box around the samples may hold; coarser voxels are taken beyond (bounds the memory)."""


class NearestTable:
    """The sample nearest to the middle of each voxel within a reach of the samples.

    Parameters
    ----------
    points : (n, 3) float64; reach : float, look-ups farther than this from every sample give -1
    voxel : float, side of a voxel, same unit

    Notes
    -----
    Each sample offers itself to the voxels of the ball around it, all samples at a time for each offset of a voxel, and
    the nearest stays: O(n (reach / voxel)^3) operations in few large steps, memory in proportion to the length of
    the curves and not to the box around them.
    """

    def __init__(self, points, reach, voxel):
        self.low = points.min(axis=0) - reach - voxel
        extent = points.max(axis=0) + reach + voxel - self.low
        while np.prod(np.ceil(extent / (voxel * SIDE))) > MOST:
            voxel *= 1.2
        self.voxel = voxel
        self.blocks = np.ceil(extent / (voxel * SIDE)).astype(np.int32) + 1
        self.strides = np.array([self.blocks[1] * self.blocks[2], self.blocks[2], 1], np.int64)
        at = (points - self.low) / voxel
        cell, sample = _one_of_each_cell(at)
        k = int(np.ceil(reach / voxel))
        offsets = np.arange(-k, k + 1)
        shifted = cell[None] + offsets[:, None, None]  # (offset, sample, axis)
        outer = shifted // SIDE * self.strides
        inner = shifted % SIDE * np.array([SIDE * SIDE, SIDE, 1])
        square = ((shifted + 0.5 - at[sample]) ** 2).astype(np.float32)
        ball = np.stack(np.meshgrid(*[np.arange(2 * k + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
        ball = ball[np.linalg.norm(np.maximum(np.abs(ball - k) - 1, 0), axis=1) * voxel <= reach]
        self.top = self._blocks_of(outer)
        self.table = np.full((self.top.max() + 1) * SIDE**3, -1, np.int32)
        best = np.full(len(self.table), (reach / voxel + 1) ** 2, np.float32)
        outer, inner, square = (np.ascontiguousarray(np.moveaxis(x, -1, 0)) for x in (outer, inner, square))
        for x, y, z in ball:
            key = self.top[outer[0, x] + outer[1, y] + outer[2, z]] * np.int64(SIDE**3)
            key += inner[0, x] + inner[1, y] + inner[2, z]
            distance = square[0, x] + square[1, y] + square[2, z]
            nearer = distance < best[key]
            key = key[nearer]
            best[key], self.table[key] = distance[nearer], sample[nearer]

    def _blocks_of(self, outer):
        """(all blocks,) int32, the number of each block that holds a voxel within reach; 0 is the empty one."""
        top = np.zeros(int(np.prod(self.blocks, dtype=np.int64)), np.int32)
        steps = sorted({0, len(outer) - 1, *range(0, len(outer), SIDE)})
        for x in steps:
            for y in steps:
                for z in steps:
                    top[outer[x, :, 0] + outer[y, :, 1] + outer[z, :, 2]] = 1
        filled = np.flatnonzero(top)
        top[filled] = np.arange(1, len(filled) + 1)
        return top

    def look_up(self, points):
        """Samples (...,) int32 near points (..., 3), nearest to about a voxel; any or -1 where none is in reach."""
        cell = ((points - self.low) * (1 / self.voxel)).astype(np.int32)
        # What is outside is asked for at the border, where every sample is too far.
        np.maximum(cell, 0, out=cell)
        np.minimum(cell, (self.blocks * SIDE - 1).astype(np.int32), out=cell)
        block = cell >> 3
        inner = cell & 7
        a, b, _ = (np.int32(x) for x in self.strides)
        at = self.top[block[..., 0] * a + block[..., 1] * b + block[..., 2]] * np.int32(SIDE**3)
        at += (inner[..., 0] << 6) + (inner[..., 1] << 3) + inner[..., 2]
        return self.table[at]


def _one_of_each_cell(at):
    """Voxels (m, 3) int64 that hold samples, and of each the sample (m,) nearest to its middle."""
    cell = np.floor(at).astype(np.int64)
    off = ((at - cell - 0.5) ** 2).sum(axis=1)
    size = cell.max(axis=0) + 1
    key = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
    order = np.lexsort((off, key))
    first = order[np.r_[True, np.diff(key[order]) != 0]]
    first = np.sort(first)
    return cell[first], first
