# SPDX-License-Identifier: GPL-3.0-or-later
"""All things of a scene: the one that explains most, again and again, on what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..evidence.field import Field
from .growth import REACHES, full_grown, grown, started
from .hypothesis import explained
from .seeding import Seeds
from .significance import evident, expected_by_chance, independent_evidence
from .splitting import split

STARTS, GROWN, APART = 24, 3, 15.0
"""Seeds that are started in each round, those of them that are grown on, and edge lengths by which they must differ;
counts that bound the work."""

LEAST_SEED, FAILURES, MOST = 8.0, 4, 40
"""Log odds of a seed that is started (two independent observations), rounds without a thing after which the search
ends, and things that are looked for at most."""


def find_things(field: Field, seeds: Seeds, *, significance, tick=lambda: None, log=lambda *a: None):
    """Hypotheses (list) of a scene, and the number of seeds that were never started.

    Parameters
    ----------
    significance : E-value up to which a thing is taken
    """
    taken = np.zeros(len(field), bool)
    dead = np.zeros(len(seeds), bool)
    found, failures = [], 0
    while len(found) < MOST and failures < FAILURES:
        tick()
        starts = _apart(field, seeds, dead | taken[seeds.source] | taken[seeds.target])
        if not len(starts):
            break
        tried = []
        for s in starts:
            thing = started(field, seeds.motions[s], seeds.source[s])
            thing = thing and grown(field, thing, seeds, taken, (0.0,), tick)
            if thing is None:
                dead[s] = True
            else:
                tried.append((thing.gain, s, thing))
        tick()
        tried.sort(key=lambda x: (-x[0], x[1]))
        best = None
        for _, s, thing in tried[:GROWN]:
            thing = grown(field, thing, seeds, taken, REACHES, tick)
            tick()
            if thing is None or thing.gain <= 0:
                dead[s] = True
            else:
                # What growth did not choose says which is real.
                evidence = independent_evidence(field, thing)
                if best is None or evidence > best[2]:
                    best = thing, s, evidence
        if best is None:
            failures += 1
            continue
        thing, s, _ = best
        thing = full_grown(field, thing, seeds, taken, tick=tick)
        tick()
        thing = evident(field, split(field, thing, seeds, taken, tick))
        dead[s] = True
        expected = expected_by_chance(field, thing)
        log(
            f"thing: {len(thing)} poses, {len(thing.points)} points, gain {thing.gain:.0f}, E {expected:.2g}"
        )
        if len(thing) < 2 or expected > significance:
            failures += 1
            continue
        found.append(replace(thing, expected=expected))
        taken = taken | explained(field, thing)
        failures = 0
    return found


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
