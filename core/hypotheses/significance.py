# SPDX-License-Identifier: GPL-3.0-or-later
"""How many things as good as one a scene without recurrence would give (E-value; Karlin and Altschul 1990).

Growth chooses its points by the score, which therefore says nothing. What tells is everything else about the poses: all
samples near the thing, moved from one pose to the next, chosen or not, against decoys of that motion.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.decoys import decoys
from ..evidence.field import Field
from ..evidence.odds import LEAST_CHANCE, UNIT, between, log_odds, sliding
from .hypothesis import Hypothesis

ABOUT, MOST = 8.0, 6
"""Edge lengths about the points within which samples tell, and poses that are asked; the rest counts in proportion."""

SELECTED = 5.0
"""Log odds that a pose must exceed to tell anything: it was the best of many that were looked at, and the poses of a
false thing are many, each a little better than chance."""

CHOSEN = 50.0
"""Edge lengths of the best fragment that count nothing: a match of l0 was chosen there, and chance hits run on for up
to as much again. A longer fragment that recurs, such as one closed outline, is evidence of its own."""

RATE, SCALE = 0.7, 5.0
"""Things per scene without recurrence whose evidence is above 0, and the scale of its exponential tail, nats; fitted on
scenes without recurrence (see benchmarks)."""


def expected_by_chance(field: Field, thing: Hypothesis) -> float:
    """The E-value of a thing."""
    return float(RATE * np.exp(-min(independent_evidence(field, thing), 600.0) / SCALE))


def independent_evidence(field: Field, thing: Hypothesis) -> float:
    """Log odds of the poses on samples that growth did not choose, without the fragment that made the seed."""
    centres, total = thing.centres(), 0.0
    asked = min(len(thing), MOST + 1)
    for k in range(1, asked):
        i = int(np.linalg.norm(centres[:k] - centres[k], axis=1).argmin())
        ways = np.array([_one_way(field, thing, thing.poses[a], thing.poses[b]) for a, b in ((i, k), (k, i))])
        whole, chosen, lead = ways.mean(axis=0)
        total += max(0.0, min(whole - chosen, 2 * max(lead, 0.0)) - SELECTED)
    return total * (len(thing) - 1) / max(asked - 1, 1)


def _one_way(field, thing, base, pose, p=0.5):
    """Log odds of the samples about the thing at one pose, moved to another: without the best fragment's, and less the
    best decoy's."""
    at = thing.points @ base[:3, :3].T + base[:3, 3]
    near = np.flatnonzero(np.isfinite(cKDTree(at).query(field.points, distance_upper_bound=ABOUT)[0]))[::2]
    if not len(near):
        return 0.0, 0.0, 0.0
    motion = between(pose[None], base[None])
    probe = field.probe(near)
    wrong = decoys(motion, probe.points.mean(axis=0), probe.tangents)[0]
    hit = field.targets(np.concatenate([motion, wrong]), probe) >= 0
    prior = 6.0
    q = (hit[1:].sum(axis=0) + prior * max(hit[1:].mean(), LEAST_CHANCE)) / (len(wrong) + prior)
    q = np.clip(q, 0.02, p - 0.05)
    tells = ~sliding(field, motion, type(probe)(probe.points[None], probe.tangents[None]))[0]
    terms = log_odds(hit, p, q) * (2 * field.weights[near] / UNIT * tells)
    _, fragment = np.unique(field.network.curve_of[near], return_inverse=True)
    own = np.bincount(fragment, terms[0])
    chosen = min(max(own.max(), 0.0), CHOSEN / UNIT * np.log(p / LEAST_CHANCE))
    return terms[0].sum(), chosen, terms[0].sum() - terms[1:].sum(axis=1).max()


def evident(field: Field, thing: Hypothesis) -> Hypothesis:
    """The thing with the poses that the samples about it speak for, moved from one of the two nearest other poses.

    That the thing is real does not say that each pose is. A pose must have more than `SELECTED`, and beat its decoys.
    """
    centres, kept = thing.centres(), [0]
    for k in range(1, len(thing)):
        gap = np.linalg.norm(centres - centres[k], axis=1)
        gap[k] = np.inf
        for i in np.argsort(gap, kind="stable")[: min(2, len(thing) - 1)]:
            ways = np.array([_one_way(field, thing, thing.poses[a], thing.poses[b]) for a, b in ((i, k), (k, i))])
            total, _, lead = ways.mean(axis=0)
            if min(total, 2 * lead) > SELECTED:
                kept.append(k)
                break
    return thing if len(kept) == len(thing) else thing.at(np.array(kept))
