# SPDX-License-Identifier: GPL-3.0-or-later
"""All things of a scene: the one that explains most, again and again, on what is left."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.field import Field
from ..geometry.motions import inverse
from .deciding import Growth, best_evident, left_over
from .growth import CAREFUL, EAGER, NEAR_SEED, REACHES, SAME_POSE, appraised, full_grown, grown, with_more_poses
from .hypothesis import explained
from .leading import leading, scored_widely
from .seeding import Seeds
from .starting import places, started, started_whole
from .sweeping import PointPairs

STARTS, APART, FRESH = 8, 15.0, 80
"""Seeds that are grown in each round, edge lengths by which they must differ, and seeds among which they are chosen;
counts that bound the work."""

LEAST_SEED, FAILURES, MOST, AGAIN = 8.0, (2, 1), 40, 3
"""Log odds of a seed that is started (two independent observations); rounds without a thing after which the search
ends, before and after the first thing; things that are looked for at most; and growths that may lead where a seed leads
before it is not grown, too."""


def find_things(field: Field, seeds: Seeds, *, significance, tick=lambda over=None: None, log=lambda *a: None):
    """Hypotheses (list) of a scene.

    Parameters
    ----------
    significance : E-value up to which a thing is taken
    tick : called often, now and then with the share of the work that is over; may raise Cancelled, which is passed on

    Notes
    -----
    What a seed comes to is seen only when it is full-grown: a small part of a thing has its poses early, and many of
    them. So all starts of a round are grown to the end, and the one that explains most is taken. Growths that a taken
    thing does not touch are kept for the next round. Last, what is left is asked place by place: small pieces make no
    match, and may be like others all the same.
    """
    how = {"seeds": seeds, "pairs": PointPairs(field), "tick": tick}
    taken = np.zeros(len(field), bool)
    lead = leading(field, seeds, tick=tick)
    dead = np.zeros(len(lead), bool)
    score, stale = lead.score.copy(), np.zeros(len(lead), bool)
    growths, found, failures, rounds = {}, [], 0, 0
    while len(found) < MOST and failures < FAILURES[len(found) > 0]:
        score = _fresh(field, lead, score, stale, taken, ~dead, tick)
        starts = _apart(field, lead, score, dead | taken[lead.source] | taken[lead.target])
        if not len(starts):
            break
        for k, s in enumerate(starts):
            known = sum(_leads_through(field, lead, s, x.thing) for g in growths.values() for x in g)
            if s not in growths and known < AGAIN:
                growths[s] = _full_grown(field, lead, s, taken, **how)
            tick(_over(rounds, GROWING * (k + 1) / len(starts)))
        best, s = best_evident(field, growths, taken, significance, log, **how)
        rounds += 1
        dead[[k for k in growths if not growths[k] or k == s]] = True
        if best is None:
            dead[list(growths)] = True
            failures += 1
            continue
        failures = 0
        found.append(best)
        new = explained(field, best)
        taken = taken | new
        stale[:] = True
        growths = left_over(field, {s: x for s, x in growths.items() if not dead[s]}, new, taken)
    return found + _of_places(field, taken, MOST - len(found), significance, log, **how)


def _of_places(field, taken, most, significance, log, *, seeds, pairs, tick):
    """Things (list) that single places lead to, of what nothing explains yet."""
    starts = [with_more_poses(field, t, seeds, taken, EAGER, pairs.poses(t)) for t in places(field, taken, tick)]
    starts = sorted((t for t in starts if len(t) > 1), key=lambda t: -t.scores.sum())[:STARTS]
    growths = {k: _grown_from(field, t, seeds, taken, EAGER, pairs, tick) for k, t in enumerate(starts)}
    found = []
    while growths and len(found) < most:
        best, s = best_evident(field, growths, taken, significance, log, seeds=seeds, pairs=pairs, tick=tick)
        if best is None:
            break
        found.append(best)
        new = explained(field, best)
        taken = taken | new
        growths = left_over(field, {k: x for k, x in growths.items() if k != s}, new, taken)
    return found


LEAD, REST, GROWING = 0.1, 0.4, 0.6
"""Shares of the work, for the display of progress: with the leading seeds over; what each round leaves of what is left;
and of a round with its starts grown. Measured on scenes of one to four rounds."""


def _over(rounds, part):
    """Share of the work that is over after some rounds and a part of the next one."""
    return 1 - (1 - LEAD) * REST**rounds * (1 - (1 - REST) * part)


def _full_grown(field, lead, s, taken, *, seeds, pairs, tick):
    """What a seed comes to (list): from what both its ends show, at a careful price of a pose, and from all that is
    around both, at an eager one with all that is like it anywhere; none where it is nothing."""
    out = []
    start = started(field, lead.motions[s], lead.stretch[s])
    if start is not None:
        out += _grown_from(field, start, seeds, taken, CAREFUL, None, tick)
    if out and np.median(out[0].thing.scores[1:]) > 2 * CAREFUL[0]:
        return out  # Other poses of it would be worth that much, too.
    start = started_whole(field, lead.motions[s], lead.stretch[s], taken)
    return out + (_grown_from(field, start, seeds, taken, EAGER, pairs, tick) if start is not None else [])


def _grown_from(field, start, seeds, taken, price, pairs, tick):
    thing = grown(field, start, seeds, taken, (0.0, *REACHES), price=price, pairs=pairs, tick=tick)
    if thing is not None and thing.gain > 0:
        thing = full_grown(field, thing, seeds, taken, price=price, tick=tick)
        thing = appraised(field, thing, taken)
        if len(thing) > 1 and thing.gain > 0:
            return [Growth(thing)]
    return []


def _leads_through(field, lead, s, thing):
    """Whether a seed leads from one pose of a thing to another."""
    at = inverse(thing.poses) @ np.append(field.points[lead.source[s]], 1.0)
    near = np.flatnonzero(cKDTree(thing.points).query(at[:, :3])[0] < NEAR_SEED)
    if not len(near):
        return False
    return bool(thing.differences(lead.motions[s] @ thing.poses[near], thing.poses).min() < SAME_POSE)


def _fresh(field, lead, score, stale, taken, alive, tick):
    """Scores (k,) of seeds of which the best that are alive are those on samples that no thing has taken."""
    while True:
        tick()
        order = np.flatnonzero(alive & (score > LEAST_SEED))
        order = order[np.argsort(-score[order], kind="stable")][:FRESH]
        order = order[stale[order]]
        if not len(order):
            return score
        score[order] = scored_widely(field, lead.take(order), taken).score
        stale[order] = False


def _apart(field, seeds, score, dead):
    """Indices of the best seeds that are alive, none at both ends near an earlier one."""
    order = np.flatnonzero(~dead & (score > LEAST_SEED))
    order = order[np.argsort(-score[order], kind="stable")]
    source, target = field.points[seeds.source[order]], field.points[seeds.target[order]]
    out, alive = [], np.ones(len(order), bool)
    for i in range(len(order)):
        if len(out) == STARTS:
            break
        if alive[i]:
            out.append(order[i])
            alive &= (((source - source[i]) ** 2).sum(1) > APART**2) | (((target - target[i]) ** 2).sum(1) > APART**2)
    return np.array(out, np.int64)
