# SPDX-License-Identifier: GPL-3.0-or-later
"""What a thing starts as: what both ends of a seed show, all that is around them, or what is around one place."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.field import Field
from ..evidence.odds import LEAST_CHANCE
from ..geometry.motions import inverse
from .extent import chance_of, joined, spread
from .hypothesis import SPACING, Hypothesis
from .symmetry import replace_frame

CORE, WHOLE = 15.0, 25.0
"""Edge lengths: what is shared about a seed that a thing starts with, and what is whole."""

PLACES, BESIDE, FEWEST = 24, 30.0, 8
"""Places that are asked, those where most is; edge lengths between them; and fewest points that a thing starts with.
Counts that bound the work."""


def started(field: Field, seed_motion, stretch, *, shown=0.5) -> Hypothesis | None:
    """The thing of one seed: the samples about its stretch that the motion takes onto the network."""
    ball = np.unique(np.concatenate(field.tree.query_ball_point(field.points[stretch], CORE))).astype(np.int64)
    probe = field.probe(ball)
    ball = ball[field.targets(seed_motion[None], probe)[0] >= 0]
    if len(ball) < FEWEST:
        return None
    ball = np.sort(ball)[spread(field.points[np.sort(ball)], np.zeros(len(ball)), SPACING)]
    return _begun(field, field.probe(ball), np.stack([np.eye(4), seed_motion]), shown)


def started_whole(field: Field, seed_motion, stretch, taken, *, shown=0.5) -> Hypothesis | None:
    """The thing of one seed: all samples about its stretch at either end, whether the other shows them or not.

    taken : (n,) bool, samples that other things explain

    Notes
    -----
    Where an occurrence shows half of a thing, two have a quarter in common and three quarters between them.
    """
    poses = np.stack([np.eye(4), seed_motion])
    ways = [field.points[stretch] @ pose[:3, :3].T + pose[:3, 3] for pose in poses]
    probe = joined(*(replace_frame(_about(field, at, taken), inverse(p)) for at, p in zip(ways, poses)), SPACING)
    return _begun(field, probe, poses, shown)


def places(field: Field, taken, tick, *, shown=0.5):
    """Things (iterator of Hypothesis) of one pose: what is around each of the places where most is that nothing
    explains.

    taken : (n,) bool, samples that other things explain
    """
    free = np.flatnonzero(~taken)
    if not len(free):
        return
    tree = cKDTree(field.points[free])
    many = tree.query_ball_point(field.points[free], WHOLE, return_length=True)
    middle = spread(field.points[free], many.astype(float), BESIDE)
    for k in middle[np.argsort(-many[middle], kind="stable")][:PLACES]:
        tick()
        probe = _about(field, field.points[free[k : k + 1]], taken)
        thing = _begun(field, probe.take(spread(probe.points, -np.arange(len(probe)), SPACING)), np.eye(4)[None], shown)
        if thing is not None:
            yield thing


def _about(field, at, taken):
    """The free samples within WHOLE of points (k, 3) of the network, as a probe."""
    ball = np.unique(np.concatenate(field.tree.query_ball_point(at, WHOLE))).astype(np.int64)
    return field.probe(ball[~taken[ball]])


def _begun(field, probe, poses, shown):
    """The thing of a probe at poses (k, 4, 4), none scored yet; None where it is next to nothing."""
    if len(probe) < FEWEST:
        return None
    chance = np.clip(chance_of(field, poses, probe), LEAST_CHANCE, 0.45)
    zero = np.zeros(len(poses))
    return Hypothesis(probe, chance, poses, zero, zero, shown)
