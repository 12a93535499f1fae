# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids: poses that are turned alike and stand in a lattice of two translations, at right angles or not."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import motion
from .orbits import NEAR, NEIGHBOURS, PAIRS, SMALL_TURN, Orbit


def grids(thing):
    """Orbits of two translations, from the shifts between poses that are turned alike."""
    poses, centres = thing.poses, thing.centres()
    alike = _turned_alike(poses)
    if len(alike) < 4:
        return
    at = centres[alike]
    shifts = (at[None] - at[:, None])[np.triu_indices(len(at), 1)]
    shifts = np.where((shifts[:, :1] < 0) | ((shifts[:, :1] == 0) & (shifts[:, 1:2] < 0)), -shifts, shifts)
    near = cKDTree(shifts).query_ball_point(shifts, NEAR)
    kept, used = [], np.zeros(len(shifts), bool)
    for k in np.argsort([-len(x) for x in near], kind="stable"):
        if not used[k]:
            used[near[k]] = True
            kept.append(shifts[near[k]].mean(axis=0))
        if len(kept) == PAIRS:
            break
    for a in range(len(kept)):
        for b in range(a):
            orbit = _lattice(thing, alike, at, np.stack([kept[a], kept[b]]))
            if orbit is not None:
                yield orbit


def _turned_alike(poses):
    """Indices of the largest set of poses with the same rotation, about the one that has most like it."""
    r = poses[:, :3, :3].reshape(-1, 9)
    like = cKDTree(r).query_ball_point(r, 2 * np.sqrt(2) * np.sin(np.radians(SMALL_TURN) / 2))
    return np.array(max(like, key=len))


def _lattice(thing, alike, at, generators):
    """The grid of two generators (2, 3) through poses `alike` at places `at`, or None."""
    a, b = generators
    if np.linalg.norm(np.cross(a, b)) < 0.1 * np.linalg.norm(a) * np.linalg.norm(b):
        return None
    generators = reduced(generators)
    # The pose that most others stand in a lattice with is the origin.
    best = None
    for origin in range(min(len(at), NEIGHBOURS)):
        g = generators
        for _ in range(3):
            keys = np.round((at - at[origin]) @ np.linalg.pinv(g)).astype(np.int64)
            off = np.linalg.norm(at - at[origin] - keys @ g, axis=1)
            hit = off < NEAR
            if hit.sum() < 4 or np.linalg.matrix_rank(keys[hit] - keys[hit].mean(axis=0)) < 2:
                break
            design = np.concatenate([keys[hit], np.ones((hit.sum(), 1))], axis=1)
            g = np.linalg.lstsq(design, at[hit], rcond=None)[0][:2]
        else:
            if best is None or hit.sum() > best[0]:
                best = hit.sum(), g, keys, hit
    if best is None:
        return None
    _, g, keys, hit = best
    low = keys[hit].min(axis=0)
    strand = np.full(len(thing.poses), -1)
    strand[alike[hit]] = 0
    all_keys = np.zeros((len(thing.poses), 2), np.int64)
    all_keys[alike] = keys - low
    if len(np.unique(all_keys[strand == 0], axis=0)) < hit.sum():
        return None
    middle = thing.points.mean(axis=0)
    turn = thing.poses[alike[hit][0], :3, :3]
    start = at[hit].mean(axis=0) - (keys[hit] - low).mean(axis=0) @ g
    base = motion(turn[None], (start - turn @ middle)[None])
    return Orbit("grid", np.concatenate([np.zeros((2, 3)), g], axis=1), all_keys, strand, base)


def reduced(generators):
    """Shortest basis (2, 3) of the lattice of two vectors (Gauss)."""
    a, b = generators
    while True:
        if a @ a > b @ b:
            a, b = b, a
        n = np.round(a @ b / (a @ a))
        if n == 0 or abs(a @ b) <= 0.5001 * (a @ a):
            return np.stack([a, b])
        b = b - n * a
