# SPDX-License-Identifier: GPL-3.0-or-later
"""Halves: a thing that meets itself at its other poses, in pairs and always in the same way, is half of a larger one.

A rectangle is twice the same corner, half a turn apart. Fewest words say the corner twice; a window is what is meant.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align
from ..evidence.field import Field, Probe
from ..evidence.odds import LEAST_CHANCE
from ..geometry.motions import inverse
from ..transformations.description import describe
from .extent import chance_of, extended, joined
from .growth import SAME_POSE, posed, rescored
from .hypothesis import SPACING, Hypothesis

MEET, CONTACTS = 3.0, 2
"""Edge lengths within which points of two poses meet, and points that must; tolerances."""

PAIRED = 0.75
"""Share of the poses that must have a partner: the others lack it by holes."""

REACH = 20.0
"""Edge lengths over which the larger thing is asked for more curves."""


def merged(field: Field, thing: Hypothesis, taken) -> Hypothesis:
    """The larger thing of which a thing is half, or the thing itself."""
    if len(thing) < 4:
        return thing
    inner, first, second = _pairing(thing)
    strand = describe(thing).strand
    apart = (strand[first] != strand[second]) | (strand[first] < 0)
    # Partners that one step of an orbit leads to are cells beside each other.
    first, second = first[apart], second[apart]
    if len(first) and thing.differences((inner @ inner)[None], np.eye(4)[None])[0, 0] < SAME_POSE:
        first, second = _alike(thing, first, second)
    if not len(first) or len(thing) - len(first) < 2 or 2 * len(first) < PAIRED * len(thing):
        return thing
    alone = np.setdiff1d(np.arange(len(thing)), np.r_[first, second])
    image = thing.probe.moved(inner[None])
    image = Probe(image.points[0], image.tangents[0], None if image.normals is None else image.normals[0], image.kind)
    probe = joined(thing.probe, image, 0.75 * SPACING)
    chance = np.clip(chance_of(field, thing.poses[first], probe), LEAST_CHANCE, 0.45)
    # One without its partner may be either half.
    ways = np.stack([thing.poses[alone], thing.poses[alone] @ inverse(inner)], axis=1)
    shown = (field.targets(ways.reshape(-1, 4, 4), probe) >= 0).mean(axis=1).reshape(-1, 2)
    single = ways[np.arange(len(alone)), shown.argmax(axis=1)]
    out = posed(replace(thing, probe=probe, chance=chance), np.concatenate([thing.poses[first], single]))
    for reach in (0.0, REACH):
        if reach:
            out = extended(field, out, taken, reach=reach)
            if out is None:
                return thing
        out = replace(out, poses=align(field, out.poses, out.probe, radii=(2.5, 2.0)))
        out = rescored(field, out, taken)
    return out if len(out) >= 2 and 2 * len(out) >= PAIRED * len(thing) else thing


def _pairing(thing):
    """A motion (4, 4) of the frame that leads from poses `first` (k,) to poses `second` (k,) that they meet, each pose
    being in one pair at most; the one with most pairs. No poses where there is none."""
    placed = thing.poses[:, None, :3, :3] @ thing.points[None, :, :, None]
    placed = placed[..., 0] + thing.poses[:, None, :3, 3]
    trees = [cKDTree(p) for p in placed]
    centres = placed.mean(axis=1)
    size = np.linalg.norm(placed - centres[:, None], axis=2).max()
    i, j = np.array(sorted(cKDTree(centres).query_pairs(2 * size + MEET)), np.int64).reshape(-1, 2).T
    gaps = (trees[a].query(placed[b], distance_upper_bound=MEET)[0] for a, b in zip(i, j))
    meet = np.array([np.isfinite(gap).sum() >= CONTACTS for gap in gaps], bool)
    i, j = i[meet], j[meet]
    i, j = np.r_[i, j], np.r_[j, i]
    motions = inverse(thing.poses[i]) @ thing.poses[j]
    best = np.eye(4), i[:0], i[:0]
    if not len(i):
        return best
    vectors = thing.embedded(motions)
    for c, alike in enumerate(cKDTree(vectors).query_ball_point(vectors, SAME_POSE)):
        a, b = i[alike], j[alike]
        # Half a turn leads there and back: each pair once.
        once = np.array([(y, x) not in set(zip(a[:k], b[:k])) for k, (x, y) in enumerate(zip(a, b))], bool)
        a, b = a[once], b[once]
        if len(np.unique(np.r_[a, b])) == 2 * len(a) and len(a) > len(best[1]):
            best = motions[c], a, b
    return best


def _alike(thing, first, second):
    """The pairs, turned round so that the first pose of each is turned as little as can be from that of the nearest
    pair; half a turn leads from either pose to the other."""
    at = (thing.centres(thing.poses[first]) + thing.centres(thing.poses[second])) / 2
    turn = thing.poses[:, :3, :3]
    first, second = first.copy(), second.copy()
    done = np.zeros(len(first), bool)
    done[0] = True
    while not done.all():
        gap = np.linalg.norm(at[~done][:, None] - at[done][None], axis=2)
        k, near = np.unravel_index(gap.argmin(), gap.shape)
        k, near = np.flatnonzero(~done)[k], np.flatnonzero(done)[near]
        like = np.einsum("aij,ij->a", turn[[first[k], second[k]]], turn[first[near]])
        if like[1] > like[0]:
            first[k], second[k] = second[k], first[k]
        done[k] = True
    return first, second
