# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates whose occurrences all together make the same figure, wherever each figure was cut into parts, are one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from .drafting import consolidate_places
from .drafts import explained_length, placed, seen_share
from .geometry.motions import best_rotation, inverse, motion
from .grouping import group
from .polishing import settled


def one_of_figures(network, drafts, motions, free, epsilon, tick):
    """The best pair of drafts that make the same figure, as one draft in a list; an empty list where there is none.

    A rosette and another one may be cut into petals at other places, so that no petal of one is a petal of the other.
    """
    for a, b, figure_motion in same_figures(drafts, motions, radius=1.25 * epsilon, tick=tick):
        one = drafts[a]
        there = _taken_over(one, drafts[b], figure_motion)
        both = replace(
            one,
            poses=np.concatenate([one.poses, there]),
            keys=np.concatenate([one.keys, np.zeros((len(there), one.keys.shape[1]), np.int64)]),
            orbital=np.concatenate([one.orbital, np.zeros(len(there), bool)]),
        )
        evidence = seen_share(network, both.curves, both.poses, radius=1.25 * epsilon, free=free)
        second = np.repeat([0, 1], [len(one.poses), len(there)])
        how = {"radius": 1.25 * epsilon, "together": second, "tick": tick}
        both = settled(network, replace(both, evidence=evidence), free, **how)
        # Twice as many occurrences tell better which curve goes on in which.
        figure = np.concatenate(both.curves)
        made = consolidate_places(
            network, both.poses, figure, both.transformation, free, epsilon=epsilon, progress=lambda _: tick()
        )
        if made.curves:
            both = replace(made, poses=both.poses, keys=both.keys, orbital=both.orbital)
            both = settled(network, both, free, **how)
        new, _ = group(network, both, free, radius=1.25 * epsilon)
        before = explained_length(network, [one, drafts[b]], radius=1.25 * epsilon)
        if explained_length(network, new, radius=1.25 * epsilon) >= 0.95 * before:
            return new
    return []


def _taken_over(one, other, figure_motion):
    """Poses (b, 4, 4) of the curves of one draft in the same figure that another one shows.

    The other's occurrences were fitted to what is seen there; how its curves lie to those of the first is one motion.
    Where it has none the figure of the first tells.
    """
    points = np.concatenate(one.curves)[::4]

    def places(poses):
        return (points @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, None, :3, 3]).reshape(len(poses), -1)

    moved = figure_motion @ one.poses
    best, least = moved, np.inf
    for pose in other.poses:
        poses = other.poses @ inverse(pose) @ moved[0]
        gap = cdist(places(moved), places(poses)).min(axis=1) / np.sqrt(len(points))
        if np.median(gap) < least:
            best, least = np.concatenate([poses, moved[gap > LOST]]), np.median(gap)
    return best


def same_figures(drafts, motions, *, radius, whole=0.85, most=0.6, tick=None):
    """Pairs of drafts that show the same figure, all occurrences together: (a, b, motion (4, 4)) each, best first.

    The motion takes the figure of a to that of b; it or its inverse begins as one of the given (k, 4, 4). At least a
    share `whole` of one figure is in the other, and `most` of that one in the first, which may have holes.
    """
    found = []
    figures = [placed(draft)[:2] for draft in drafts]
    both = np.concatenate([motions, inverse(motions)]) if len(motions) else np.zeros((0, 4, 4))
    for a, one in enumerate(figures):
        for b, other in enumerate(figures):
            if a == b or (drafts[a].lengths.sum(), -a) < (drafts[b].lengths.sum(), -b):
                continue
            away = both[:, :3, :3] @ one[0].mean(axis=0) + both[:, :3, 3] - other[0].mean(axis=0)
            near = np.linalg.norm(away, axis=1) < NEAR * np.linalg.norm(one[0].std(axis=0)) + 2 * radius
            best = (0.0, None)
            for m in both[near]:
                if tick:
                    tick()
                some = one[0][::8] @ m[:3, :3].T + m[:3, 3], one[1][::8] @ m[:3, :3].T
                if _covered(some, other, 2 * radius) < BEGIN:
                    continue
                m = _aligned(m, one, other, radius=2 * radius)
                moved = one[0] @ m[:3, :3].T + m[:3, 3], one[1] @ m[:3, :3].T
                there, back = _covered(moved, other, radius), _covered(other, moved, radius)
                if max(there, back) >= whole and min(there, back) >= most and there + back > best[0]:
                    best = (there + back, m)
            if best[1] is not None:
                found.append((best[0], a, b, best[1]))
    return [f[1:] for f in sorted(found, key=lambda f: -f[0])]


NEAR, BEGIN, LOST = 0.4, 0.3, 5.0
"""Share of its size by which the middle of a figure may lie beside that of the other, which has holes; share of it
that must lie on the other to be aligned; RMS edge lengths from which on an occurrence of one has none there."""


def _aligned(m, one, other, *, radius, rounds=6):
    """A motion moved so that it takes one figure (points, tangents) onto another one as well as it can."""
    tree, m = cKDTree(other[0]), m.copy()
    for _ in range(rounds):
        moved, ways = one[0] @ m[:3, :3].T + m[:3, 3], one[1] @ m[:3, :3].T
        distance, near = tree.query(moved, distance_upper_bound=radius, workers=-1)
        hit = np.flatnonzero(np.isfinite(distance))
        hit = hit[np.abs((other[1][near[hit]] * ways[hit]).sum(1)) > 0.7]
        if len(hit) < 30:
            break
        line = other[1][near[hit]]
        offset = other[0][near[hit]] - moved[hit]
        target = moved[hit] + offset - line * (offset * line).sum(1)[:, None]
        middle, aim = moved[hit].mean(axis=0), target.mean(axis=0)
        turn, _ = best_rotation(((target - aim).T @ (moved[hit] - middle))[None])
        m = motion(turn[0], aim - turn[0] @ middle) @ m
    return m


def _covered(one, other, radius):
    """Share of the points of a figure that lie on another one and run the same way; each is (points, tangents)."""
    distance, near = cKDTree(other[0]).query(one[0], distance_upper_bound=radius, workers=-1)
    found = np.flatnonzero(np.isfinite(distance))
    return float((np.abs((other[1][near[found]] * one[1][found]).sum(1)) > 0.7).sum() / max(len(one[0]), 1))
