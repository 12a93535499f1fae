# SPDX-License-Identifier: GPL-3.0-or-later
"""The example: a wall with six arched windows as a scan would show it, and the curves that were found on it.

It faces the front view (x to the right, z up), one unit is a metre. The same numbers every time.
"""

from __future__ import annotations

import bpy
import numpy as np

from ...core.values import Curves
from . import incoming

EDGE, NOISE, SEED = 0.05, 0.006, 2018
STEPS, PLACES, HEIGHT = (2.0, 3.2), (3, 2), 0.06


def add(context):
    """Put the scan and its curves into the scene; the curves are selected. Returns (scan, curves)."""
    rng = np.random.default_rng(SEED)
    lines = [line + [i * STEPS[0], 0, j * STEPS[1]] for j in range(PLACES[1]) for i in range(PLACES[0])
             for line in window()]  # fmt: skip
    ledge = np.stack([np.arange(-1, 5, EDGE), np.zeros(120), np.full(120, -0.35)], axis=1)
    scan = _scan(context, [*lines, ledge])
    pieces = [piece for line in [*lines, ledge] for piece in damaged(line, rng)]
    pieces += [np.cumsum(rng.normal(scale=0.03, size=(12, 3)), axis=0) + rng.uniform((-1, 0, 0), (5, 0, 6))
               for _ in range(14)]  # fmt: skip
    before = np.array([0, -HEIGHT - 0.01, 0])  # in sight: the rolls of the scan are so high
    curves = incoming.add_curves(context, "Example Curves", Curves.from_list([p + before for p in pieces]), EDGE)
    return scan, curves


def window():
    """The curves of one window, (k, 3) each: a pointed frame, a round light, a sill."""
    side = np.arange(0, 1.4, EDGE)
    turn = np.arange(np.pi, np.pi * 2 / 3, -EDGE / 1.2)
    left = np.stack([0.6 + 1.2 * np.cos(turn), 0 * turn, 1.4 + 1.2 * np.sin(turn)], axis=1)
    half = np.concatenate([np.stack([np.full(len(side), -0.6), 0 * side, side], axis=1), left])
    around = np.arange(0, 2 * np.pi, EDGE / 0.28)
    light = np.stack([0.28 * np.cos(around), 0 * around, 1.55 + 0.28 * np.sin(around)], axis=1)
    across = np.arange(-0.75, 0.75, EDGE)
    sill = np.stack([across, 0 * across, np.full(len(across), -0.12)], axis=1)
    return [half, half * [-1, 1, 1], np.concatenate([light, light[:1]]), sill]


def damaged(line, rng):
    """Pieces of a line, noisy, with a gap or two."""
    noisy = line + rng.normal(scale=NOISE, size=line.shape)
    keep = np.ones(len(line), bool)
    for _ in range(rng.integers(0, 3)):
        first = rng.integers(0, len(line))
        keep[first : first + rng.integers(3, 9)] = False
    edges = np.flatnonzero(np.diff(np.r_[0, keep.astype(int), 0]))
    return [noisy[a:b] for a, b in zip(edges[::2], edges[1::2]) if b - a > 4]


def _scan(context, lines):
    """The wall as a mesh with rolls along the lines."""
    from scipy.spatial import cKDTree

    x, z = np.arange(-1.2, 5.2, EDGE), np.arange(-0.7, 6.3, EDGE)
    grid = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1).reshape(-1, 2)
    distance, _ = cKDTree(np.concatenate(lines)[:, [0, 2]]).query(grid)
    rng = np.random.default_rng(SEED)
    height = HEIGHT * np.exp(-((distance / 0.06) ** 2)) + rng.normal(scale=NOISE / 4, size=len(grid))
    index = np.arange(len(grid)).reshape(len(x), len(z))
    quads = np.stack(
        [part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])], axis=1
    )
    mesh = bpy.data.meshes.new("Example Scan")
    mesh.from_pydata(np.stack([grid[:, 0], -height, grid[:, 1]], axis=1).tolist(), [], quads.tolist())
    item = bpy.data.objects.new("Example Scan", mesh)
    incoming.place(context, item, select=False)
    return item
