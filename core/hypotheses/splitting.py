# SPDX-License-Identifier: GPL-3.0-or-later
"""Double cells: a thing that repeats within itself at a fraction of the step between its poses is two of a smaller one.

What repeats at one offset in each pose, and not from pose to pose, is a thing within a thing (two jambs of each window)
and no reason to split. A thing that reaches over its neighbours keeps them from being poses of their own.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align
from ..evidence.field import Field
from ..geometry.motions import inverse
from ..transformations.description import saving
from .completing import with_empty_cells
from .extent import extended
from .growth import EAGER, PROMINENT, SAME_POSE, appraised, full_grown, posed, prominence, rescored, with_more_poses
from .hypothesis import Hypothesis, distinct, pose_scores, relative
from .seeding import Seeds
from .significance import independent_evidence

FRACTIONS, CLOSES, AWAY = (2, 3, 4), 4.0, 8.0
"""Parts of a step that are tried, RMS edge lengths within which the parts must close a step (times their number), and
edge lengths that the middle must move."""

REPEATED, TRIES, FEWEST = 0.2, 3, 12
"""Share of the thing that repeats within it, motions that are tried, and points that must repeat."""

LOOKED, MANY, MEET = 100, 0.3, 3.0
"""Poses beside that are looked at (count that bounds the work); how many of them there must be for each pose; and edge
lengths within which points of two poses are one (tolerance)."""


def split(field: Field, thing: Hypothesis, seeds: Seeds, taken, tick=lambda: None) -> Hypothesis:
    """The smaller thing with more poses that explains more, or the thing itself."""
    if len(thing) < 2:
        return thing
    best, most = thing, saving(appraised(field, thing, taken))
    for motion in _inner_motions(field, thing, seeds)[:TRIES]:
        tick()
        smaller = _halved(field, thing, motion, seeds, taken)
        if smaller is None or len(smaller) <= len(thing):
            continue
        smaller = appraised(field, smaller, taken)
        if len(smaller) > len(thing) and saving(smaller) > most:
            best, most = smaller, saving(smaller)
    return best


def _inner_motions(field, thing, seeds):
    """Motions (k, 4, 4) of the frame that take a part of the thing onto another and are a fraction of a step."""
    tree = cKDTree(thing.points)
    source, out = field.points[seeds.source], []
    for pose in thing.poses[:2]:
        back = inverse(pose)
        inside = np.isfinite(tree.query(source @ back[:3, :3].T + back[:3, 3], distance_upper_bound=3.0)[0])
        out.append(back @ seeds.motions[inside] @ pose)
    motions = np.concatenate(out)
    if len(motions):
        centre = thing.points.mean(axis=0)
        way = np.linalg.norm(motions[:, :3, :3] @ centre + motions[:, :3, 3] - centre, axis=1)
        motions = motions[way > AWAY]
    if len(motions):
        motions = motions[_closing(thing, motions)]
    if not len(motions):
        return motions
    share = np.array([_repeated(thing, tree, m).mean() for m in motions])
    motions, share = motions[share > REPEATED], share[share > REPEATED]
    return motions[distinct(thing, motions, share, gap=AWAY)] if len(motions) else motions


def _closing(thing, motions):
    # From one pose to another: what half a turn brings back to its own pose is a thing within a thing.
    steps = relative(thing.poses[:24])[~np.eye(len(thing.poses[:24]), dtype=bool).ravel()]
    steps = cKDTree(thing.embedded(steps))
    closes = np.zeros(len(motions), bool)
    for n in FRACTIONS:
        power = thing.embedded(np.linalg.matrix_power(motions, n))
        closes |= steps.query(power)[0] < CLOSES * n
    return closes


def _repeated(thing, tree, motion):
    """(m,) bool, points that a motion (4, 4) of the frame takes onto the thing itself."""
    distance, near = tree.query(thing.points @ motion[:3, :3].T + motion[:3, 3])
    same = np.abs(((thing.tangents @ motion[:3, :3].T) * thing.tangents[near]).sum(axis=1)) > 0.8
    return (distance < 3.0) & same


def _halved(field, thing, motion, seeds, taken):
    """The part of a thing that a motion repeats within it, at the poses of both, grown anew; or None."""
    inside = _repeated(thing, cKDTree(thing.points), motion)
    if inside.sum() < FEWEST:
        return None
    part = replace(thing, probe=thing.probe.take(inside), chance=thing.chance[inside])
    poses = np.concatenate([thing.poses, thing.poses @ motion])
    part = posed(part, poses[np.sort(distinct(part, poses, -np.arange(len(poses)), gap=6.0))])
    for reach in (0.0, 15.0, 30.0, 60.0):
        if reach:
            part = extended(field, part, taken, reach=reach)
            if part is None:
                return None
        part = replace(part, poses=align(field, part.poses, part.probe, radii=(2.5, 2.0)))
        part = rescored(field, part, taken)
        if len(part) < 2:
            return None
        if reach:
            part = rescored(field, with_more_poses(field, part, seeds, taken), taken)
    return part


def parted(field: Field, thing: Hypothesis, seeds: Seeds, taken, pairs, tick=lambda: None) -> Hypothesis:
    """The thing cut where it reaches over neighbours that show it as well, at the poses of both and grown anew, if more
    is evident of that; or the thing itself.

    pairs : PointPairs of the network
    """
    if len(thing) < 2:
        return thing
    found = _overlapping(field, thing, taken, pairs)
    tick()
    if len(found) < MANY * len(thing):
        return thing
    best, most = thing, independent_evidence(field, thing)
    for inner in _common_motion(thing, found):
        # Of what is there twice, one stays.
        image = thing.points @ inner[:3, :3].T + inner[:3, 3]
        own = ~(cKDTree(image).query(thing.points)[0] < MEET)
        if own.sum() < FEWEST:
            continue
        part = replace(thing, probe=thing.probe.take(own), chance=thing.chance[own])
        part = posed(part, np.concatenate([thing.poses, found]))
        # Its poses first, lest it grows over the same neighbours again.
        part = rescored(field, replace(part, poses=align(field, part.poses, part.probe, radii=(2.5, 2.0))), taken)
        if len(part) < 2:
            continue
        part = with_more_poses(field, part, seeds, taken, EAGER, pairs.poses(part))
        part = full_grown(field, part, seeds, taken, price=EAGER, pairs=pairs, tick=tick)
        part = with_empty_cells(field, part, part.orbit, taken)
        worth = independent_evidence(field, part)
        if len(part) > len(thing) and worth > most:
            best, most = part, worth
    return best


def _common_motion(thing, found):
    """The motion (4, 4) of the frame that most often leads from a pose to a found one (k, 4, 4) beside it, and its
    inverse."""
    motions = (inverse(thing.poses)[:, None] @ found[None]).reshape(-1, 4, 4)
    way = np.linalg.norm(thing.centres(motions) - thing.points.mean(axis=0), axis=1)
    size = 2 * np.linalg.norm(thing.points - thing.points.mean(axis=0), axis=1).max()
    motions = motions[way < size]
    motions = motions[_closing(thing, motions)] if len(motions) else motions
    if not len(motions):
        return motions
    vectors = thing.embedded(np.concatenate([motions, inverse(motions)]))
    alike = cKDTree(vectors).query_ball_point(vectors, SAME_POSE, return_length=True)
    best = motions[alike[: len(motions)].argmax()]
    return np.stack([best, inverse(best)])


def _overlapping(field, thing, taken, pairs):
    """Other poses (k, 4, 4) that show the thing, be it by what it explains at its own poses."""
    poses = pairs.poses(thing)
    if not len(poses):
        return poses
    poses = poses[np.sort(distinct(thing, poses, -np.arange(len(poses)), gap=6.0)[:LOOKED])]
    poses = align(field, poses, thing.probe, radii=(4.0, 2.5, 2.0))
    score = pose_scores(field, thing, poses, taken, beside=thing.poses)[0]
    away = cKDTree(thing.centres()).query(thing.centres(poses))[0] > AWAY
    good = np.flatnonzero((score > EAGER[0]) & away)
    good = good[prominence(field, thing, poses[good], taken) >= PROMINENT]
    good = good[np.argsort(-score[good], kind="stable")]
    kept = np.zeros(0, int)
    for k in good:
        if not len(kept) or np.linalg.norm(thing.centres(poses[kept]) - thing.centres(poses[[k]]), axis=1).min() > AWAY:
            kept = np.append(kept, k)
    return poses[kept]
