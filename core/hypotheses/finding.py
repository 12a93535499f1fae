# SPDX-License-Identifier: GPL-3.0-or-later
"""All things of a scene: the one that explains most, again and again, on what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..evidence.field import Field
from .growth import REACHES, full_grown, grown, started
from .hypothesis import explained
from .leading import leading, scored_widely
from .seeding import Seeds
from .significance import evident, expected_by_chance
from .splitting import split

STARTS, APART, FRESH = 12, 15.0, 120
"""Seeds that are grown in each round, edge lengths by which they must differ, and seeds among which they are chosen;
counts that bound the work."""

LEAST_SEED, FAILURES, MOST = 8.0, 2, 40
"""Log odds of a seed that is started (two independent observations), rounds without a thing after which the search
ends, and things that are looked for at most."""


def find_things(field: Field, seeds: Seeds, *, significance, tick=lambda: None, log=lambda *a: None):
    """Hypotheses (list) of a scene.

    Parameters
    ----------
    significance : E-value up to which a thing is taken

    Notes
    -----
    What a seed comes to is seen only when it is full-grown: a small part of a thing has its poses early, and many of
    them. So all starts of a round are grown to the end, and the one that explains most is taken. Growths that a taken
    thing does not touch are kept for the next round.
    """
    taken = np.zeros(len(field), bool)
    lead = leading(field, seeds, tick=tick)
    dead = np.zeros(len(lead), bool)
    score, stale = lead.score.copy(), np.zeros(len(lead), bool)
    full, found, failures = {}, [], 0
    while len(found) < MOST and failures < FAILURES:
        score = _fresh(field, lead, score, stale, taken, ~dead, tick)
        starts = _apart(field, lead, score, dead | taken[lead.source] | taken[lead.target])
        if not len(starts):
            break
        for s in starts:
            if s not in full:
                full[s] = _full_grown(field, lead, s, seeds, taken, tick)
                dead[s] = full[s] is None
        best = None
        for s in sorted((s for s in full if not dead[s]), key=lambda s: (-full[s].gain, s)):
            thing = evident(field, full[s])
            tick()
            expected = expected_by_chance(field, thing)
            if expected <= significance:
                smaller = split(field, thing, seeds, taken, tick)
                if smaller is not thing:
                    thing = evident(field, smaller)
                    expected = expected_by_chance(field, thing)
            log(f"thing: {len(thing)} poses, {len(thing.points)} points, gain {thing.gain:.0f}, E {expected:.2g}")
            dead[s] = True
            if len(thing) >= 2 and expected <= significance:
                best = replace(thing, expected=expected)
                break
        if best is None:
            failures += 1
            continue
        failures = 0
        found.append(best)
        new = explained(field, best)
        taken = taken | new
        stale[:] = True
        full = {s: t for s, t in full.items() if t is not None and not dead[s] and not (explained(field, t) & new).any()}
    return found


def _full_grown(field, lead, s, seeds, taken, tick):
    thing = started(field, lead.motions[s], lead.stretch[s])
    thing = thing and grown(field, thing, seeds, taken, (0.0, *REACHES), tick)
    if thing is None or thing.gain <= 0:
        return None
    thing = full_grown(field, thing, seeds, taken, tick=tick)
    return thing if len(thing) > 1 and thing.gain > 0 else None


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
