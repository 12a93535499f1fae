# SPDX-License-Identifier: GPL-3.0-or-later
"""The one score: log odds of "seen again" against "chance".

A point that a motion takes onto the network counts log(p / q), one that it does not log((1 - p) / (1 - q)): p is the
share of a thing that an occurrence shows, q how often a decoy hits there. A point that slides along the motion counts
nothing. Neighbouring points are no independent observations: `UNIT` edges of curve count as one.
"""

from __future__ import annotations

import numpy as np

from ..geometry.motions import exponential, inverse, screw_velocity
from .field import Field, Probe

UNIT = 4.0
"""Edge lengths of curve that count as one observation: chance hits run on for so long (measured on decoys)."""

LEAST_CHANCE = 0.05
"""Least q: no decoy hit is no proof that chance never hits (prior of the estimate)."""

ALONG, STILL, FRACTIONS, MOSTLY = 0.95, 4.0, 5, 4
"""Cosine of a way that runs along a curve, edge lengths that a point must move at all, places on its way where the
network is asked for, and how many of them must show the curve (tolerances)."""


def log_odds(hit, p, q):
    """(...) float64, log odds of points that are hit or not."""
    return np.where(hit, np.log(p / q), np.log((1 - p) / (1 - q)))


def sliding(field: Field, motions, probe: Probe):
    """(k, m) bool, points (k, m, 3) that tell nothing for the motions: they slide along their own curve, or stay.

    A point slides where its way runs along its curve and the network shows the curve on most of that way: a cornice
    under a translation, a ring about an axis. A sill that ends before the next one begins does not.
    """
    w, u = screw_velocity(motions)
    velocity = np.cross(w[:, None], probe.points) + u[:, None]
    along = (velocity * probe.tangents).sum(-1) ** 2 > ALONG**2 * (velocity**2).sum(-1)
    way = np.einsum("kij,kmj->kmi", motions[:, :3, :3] - np.eye(3), probe.points) + motions[:, None, :3, 3]
    still = (way**2).sum(-1) < STILL**2
    k, m = np.nonzero(along & ~still)
    if len(k):
        twists = np.concatenate([w, u], axis=1)
        shown = np.zeros(len(k), np.int64)
        for f in np.arange(1, FRACTIONS + 1) / (FRACTIONS + 1):
            part = exponential(f * twists)[k]
            at = np.einsum("nij,nj->ni", part[:, :3, :3], probe.points[k, m]) + part[:, :3, 3]
            line = np.einsum("nij,nj->ni", part[:, :3, :3], probe.tangents[k, m])
            shown += field.shown_by(Probe(at, line)) >= 0
        along[k, m] = shown >= MOSTLY
    return (along & ~still) | still


def between(poses, bases):
    """Motions (k, 4, 4) of the network that lead from the base poses to the poses, both (k, 4, 4)."""
    return poses @ inverse(bases)
