# SPDX-License-Identifier: GPL-3.0-or-later
"""The one score: log odds of "seen again" against "chance".

A point that a motion takes onto the network counts log(p / q), one that it does not log((1 - p) / (1 - q)): p is the
share of a thing that an occurrence shows, q how often a decoy hits there. A point that slides along the motion counts
nothing. Neighbouring points are no independent observations: `UNIT` edges of curve count as one.
"""

from __future__ import annotations

import numpy as np

from ..geometry.motions import inverse, skew
from .field import Field, Probe
from .screws import moment, screws

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
    w, u = screws(motions)
    velocity = probe.points @ -skew(w) + u[:, None]  # (w x p)^T = p^T [w]x^T
    along = _dot(velocity, probe.tangents) ** 2 > ALONG**2 * _dot(velocity, velocity)
    way = probe.points @ np.swapaxes(motions[:, :3, :3] - np.eye(3), 1, 2) + motions[:, None, :3, 3]
    still = _dot(way, way) < STILL**2
    k, m = np.nonzero(along & ~still)
    if len(k):
        shown = np.zeros(len(k), np.int64)
        points, lines = probe.points[k, m], probe.tangents[k, m]
        for f in np.arange(1, FRACTIONS + 1) / (FRACTIONS + 1):
            part = moment(f * w, f * u)[k]
            at = np.einsum("nij,nj->ni", part[:, :3, :3], points) + part[:, :3, 3]
            line = np.einsum("nij,nj->ni", part[:, :3, :3], lines)
            shown += field.shown_by(Probe(at, line)) >= 0
        along[k, m] = shown >= MOSTLY
    return (along & ~still) | still


def _dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def between(poses, bases):
    """Motions (k, 4, 4) of the network that lead from the base poses to the poses, both (k, 4, 4)."""
    return poses @ inverse(bases)
