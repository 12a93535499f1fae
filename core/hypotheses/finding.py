# SPDX-License-Identifier: GPL-3.0-or-later
"""All things of a scene: the one that explains most, again and again, on what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..evidence.field import Field
from .growth import REACHES, full_grown, grown, started
from .hypothesis import explained
from .leading import leading
from .seeding import Seeds
from .significance import evident, expected_by_chance
from .splitting import split

STARTS, APART = 12, 15.0
"""Seeds that are grown in each round, and edge lengths by which they must differ; counts that bound the work."""

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
    full, found, failures = {}, [], 0
    while len(found) < MOST and failures < FAILURES:
        starts = _apart(field, lead, dead | taken[lead.source] | taken[lead.target])
        if not len(starts):
            break
        for s in starts:
            if s not in full:
                full[s] = _full_grown(field, lead, s, seeds, taken, tick)
                dead[s] = full[s] is None
        best = None
        for s in sorted((s for s in full if not dead[s]), key=lambda s: (-full[s].gain, s)):
            thing = evident(field, split(field, full[s], seeds, taken, tick))
            tick()
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
        full = {s: t for s, t in full.items() if t is not None and not dead[s] and not (explained(field, t) & new).any()}
    return found


def _full_grown(field, lead, s, seeds, taken, tick):
    thing = started(field, lead.motions[s], lead.stretch[s])
    thing = thing and grown(field, thing, seeds, taken, (0.0, *REACHES), tick)
    if thing is None or thing.gain <= 0:
        return None
    thing = full_grown(field, thing, seeds, taken, tick=tick)
    return thing if len(thing) > 1 and thing.gain > 0 else None


def _apart(field, seeds, dead):
    """Indices of the best seeds that are alive, none at both ends near an earlier one."""
    order = np.flatnonzero(~dead & (seeds.score > LEAST_SEED))
    order = order[np.argsort(-seeds.score[order], kind="stable")]
    source, target = field.points[seeds.source[order]], field.points[seeds.target[order]]
    out, alive = [], np.ones(len(order), bool)
    for i in range(len(order)):
        if len(out) == STARTS:
            break
        if alive[i]:
            out.append(order[i])
            alive &= (((source - source[i]) ** 2).sum(1) > APART**2) | (((target - target[i]) ** 2).sum(1) > APART**2)
    return np.array(out, np.int64)
