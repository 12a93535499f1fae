# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts from overlaid occurrences: the curves on which the occurrences agree (section 5.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation import condense, fit_curves, trace_curves
from .drafts import Draft, directions, seen_share
from .network import CurveNetwork
from .overlay import Overlay, agreement, chance_shifts, fold_poses
from .rigid import best_rotation, motion

CHANCE_SHARE = 0.1
"""Largest share of the agreeing samples that chance may explain."""


def consolidate(
    network: CurveNetwork, overlay: Overlay, transformation: int, *, epsilon, images=(), progress=None
) -> Draft:
    """The curves on which the occurrences of an overlay agree.

    A sample is kept when enough other occurrences show it: as many as leave only `CHANCE_SHARE` to chance, which
    is what is left when the occurrences are shifted against each other.
    """
    weight = network.weights[overlay.sample] * overlay.inner
    count, mean = agreement(overlay, radius=1.25 * epsilon, progress=progress)
    shifts = chance_shifts(overlay)
    wrong, _ = agreement(overlay, radius=1.25 * epsilon, shifts=shifts)
    least = least_agreement(count, wrong, weight)
    keep = (count >= least) & overlay.inner
    cells = np.ones(len(overlay.poses), bool)
    empty = Draft([], [], overlay.poses, overlay.keys, np.zeros((len(overlay.poses), 0)), transformation, cells)
    if not keep.any():
        return empty
    points, tangents = condense(mean[keep], overlay.tangents[keep], weight[keep], radius=1.0 * epsilon)
    curves, closed = fit_curves(
        trace_curves(points, tangents), mean[keep], tangents, weight[keep], overlay.run[keep],
        trails=(mean, overlay.tangents, overlay.run), images=images,
    )  # fmt: skip
    if not curves:
        return empty
    evidence = seen_share(network, curves, overlay.poses, radius=1.25 * epsilon)
    return Draft(curves, closed, overlay.poses, overlay.keys, evidence, transformation, cells)


def least_agreement(count, wrong, weight):
    """Fewest agreeing occurrences that leave at most `CHANCE_SHARE` of the length to chance."""
    top = int(count.max(initial=0))
    for least in range(1, top + 1):
        seen, chance = weight[count >= least].sum(), weight[wrong >= least].sum()
        if chance <= CHANCE_SHARE * seen:
            return least
    return max(1, top)


def consolidate_places(network, poses, region, transformation, free, *, epsilon, progress=None, rounds=3) -> Draft:
    """Draft of a thing at given places; what some places show beside the region widens it."""
    for _ in range(rounds):
        overlay = fold_poses(network, poses, region, free, reach=12.0)
        draft = consolidate(network, overlay, transformation, epsilon=epsilon, progress=progress)
        draft = replace(draft, orbital=np.zeros(len(poses), bool))
        if not draft.curves:
            break
        region = np.concatenate(draft.curves)
        poses = refined_poses(network, draft, free, radius=2 * epsilon)
    return draft


def refined_poses(network: CurveNetwork, draft: Draft, free, *, radius, rounds=3):
    """Poses moved so that the draft's curves lie on the samples that show them; ICP, across the curves only.

    An occurrence that shows too little to hold it stays where it is.
    """
    points = np.concatenate(draft.curves)
    tangents = np.concatenate([directions(c) for c in draft.curves])
    samples = np.flatnonzero(free)
    tree = cKDTree(network.points[samples])
    poses = draft.poses.copy()
    for a in range(len(poses)):
        for _ in range(rounds):
            r, t = poses[a, :3, :3], poses[a, :3, 3]
            moved, lines = points @ r.T + t, tangents @ r.T
            distance, near = tree.query(moved, distance_upper_bound=radius)
            hit = np.isfinite(distance)
            near = samples[np.where(hit, near, 0)]
            hit &= np.abs((network.tangents[near] * lines).sum(1)) > 0.8
            if hit.sum() < 30:
                break
            offset = network.points[near] - moved
            offset -= lines * (offset * lines).sum(1)[:, None]
            target = moved[hit] + offset[hit]
            mean_a, mean_b = points[hit].mean(0), target.mean(0)
            turn, _ = best_rotation(((target - mean_b).T @ (points[hit] - mean_a) + 1e-3 * r)[None])
            poses[a] = motion(turn[0], mean_b - turn[0] @ mean_a)
    return poses
