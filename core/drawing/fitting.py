# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses and clean curves fitted to the samples that show them, in turn; and poses that show nothing of their own."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..consolidation.averaging import settle
from ..geometry.motions import apply, best_rotation, inverse, motion
from ..geometry.polylines import directions
from ..network.network import CurveNetwork
from .evidence import log_odds
from .overlay import Overlay

STEPS, HELD = 3, 30
"""Tolerances: steps of the iterated closest points, and points that must be seen for a pose to be moved."""


def refined_poses(network: CurveNetwork, curves, poses, free, *, radius, sets=None):
    """Poses (k, 4, 4) moved so that the curves lie on the free samples that show them, across the curves only.

    sets : (c, k) bool, the poses that have each curve; None for all
    """
    points = np.concatenate(curves)
    lines = np.concatenate([directions(c) for c in curves])
    has = np.ones((len(points), len(poses)), bool)
    if sets is not None:
        has = np.repeat(sets, [len(c) for c in curves], axis=0)
    samples = np.flatnonzero(free)
    poses = poses.copy()
    if not len(samples):
        return poses
    tree = cKDTree(network.points[samples])
    for k in range(len(poses)):
        mine, way = points[has[:, k]], lines[has[:, k]]
        for _ in range(STEPS):
            at, turned = apply(poses[k], mine), way @ poses[k, :3, :3].T
            distance, near = tree.query(at, distance_upper_bound=radius)
            hit = np.isfinite(distance)
            near = samples[np.where(hit, near, 0)]
            hit &= np.abs((network.tangents[near] * turned).sum(1)) > 0.8
            if hit.sum() < HELD:
                break
            a, t = mine[hit], way[hit]
            offset = apply(inverse(poses[k]), network.points[near[hit]]) - a
            b = a + offset - t * (offset * t).sum(1)[:, None]
            mean_a, mean_b = a.mean(0), b.mean(0)
            turn = best_rotation(((b - mean_b).T @ (a - mean_a) + 1e-3 * np.eye(3))[None])[0][0]
            poses[k] = poses[k] @ motion(turn, mean_b - turn @ mean_a)
    return poses


def fitted_curves(curves, closed, sets, overlay: Overlay, *, radius, tick=None):
    """The curves as the mean of all samples that show them at their poses.

    sets : (c, k) bool, the poses that have each curve
    """
    line, way = np.concatenate(curves), np.concatenate([directions(c) for c in curves])
    owner = np.repeat(np.arange(len(curves)), [len(c) for c in curves])
    distance, near = cKDTree(line).query(overlay.points, k=4, distance_upper_bound=radius)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    found &= np.abs((way[near] * overlay.tangents[:, None]).sum(-1)) > 0.7
    found &= sets[owner[near], overlay.cell[:, None]]
    use = np.flatnonzero(found.any(axis=1))
    if not len(use):
        return curves
    return settle(
        curves, closed, overlay.points[use], overlay.tangents[use], overlay.weights[use], overlay.run[use], tick=tick
    )


def own_evidence(found, overlay: Overlay, sets, p, q, predicted=None):
    """(k,) float64, nats that speak for each pose: what it shows that no stronger pose explains.

    found : sightings of the curves in the overlay; sets : (c, k) bool; p, q (c,) : chance to be seen where a curve is
    and where it is not; predicted : (k,) bool, poses of an orbit, which explain their samples before the others
    """
    size = np.diff(found.offsets)
    curve = np.repeat(np.arange(len(size)), size)
    chance, has = q[curve], sets[curve]
    cell, sample = overlay.cell[found.item], overlay.sample[found.item]
    valid = has[found.point, cell]
    rows = [np.flatnonzero(valid & (cell == k)) for k in range(overlay.cells)]

    def worth(k, use):
        seen = np.zeros(len(curve), bool)
        seen[found.point[use]] = True
        return log_odds(seen[None], p, chance)[0][has[:, k]].sum()

    alone = np.array([worth(k, rows[k]) for k in range(overlay.cells)])
    taken = np.zeros(int(overlay.sample.max(initial=-1)) + 1, bool)
    out = np.zeros(overlay.cells)
    later = np.zeros(overlay.cells, bool) if predicted is None else ~predicted
    for k in np.lexsort((-alone, later)):
        out[k] = worth(k, rows[k][~taken[sample[rows[k]]]])
        taken[sample[rows[k]]] = True
    return out
