# SPDX-License-Identifier: GPL-3.0-or-later
"""All things of a scene: the one that explains most, again and again, on what is left."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.field import Field
from ..geometry.motions import inverse
from .growth import NEAR_SEED, REACHES, SAME_POSE, full_grown, grown, started
from .hypothesis import Hypothesis, explained
from .seeding import Seeds
from .significance import expected_by_chance
from .splitting import split

STARTS, GROWN, APART = 24, 3, 15.0
"""Seeds that are started in each round, those of them that are grown on, and edge lengths by which they must differ;
counts that bound the work."""

LEAST_SEED, FAILURES, MOST = 8.0, 4, 40
"""Log odds of a seed that is started (two independent observations), rounds without a thing after which the search
ends, and things that are looked for at most."""


def find_things(field: Field, seeds: Seeds, *, significance, tick=lambda: None, log=lambda *a: None):
    """Hypotheses (list) of a scene, the one that explains most first.

    Parameters
    ----------
    significance : E-value up to which a thing is taken
    """
    search = _Search(field, seeds, tick)
    found, failures = [], 0
    while len(found) < MOST and failures < FAILURES:
        starts = search.starts()
        if not len(starts):
            break
        best = search.best_of(starts)
        if best is None:
            failures += 1
            continue
        thing = full_grown(field, best, seeds, search.taken)
        tick()
        expected = expected_by_chance(field, thing)
        if len(thing) > 1 and expected <= significance:
            thing = split(field, thing, seeds, search.taken)
            expected = expected_by_chance(field, thing)
        log(
            f"    thing: {len(thing)} poses, {len(thing.points)} points, gain {thing.gain:.0f}, shown {thing.shown:.2f}, "
            f"E {expected:.2g}"
        )
        if len(thing) < 2 or expected > significance:
            failures += 1
            search.reject(best)
            search.reject(thing)
            continue
        found.append(replace(thing, expected=expected))
        search.take(thing)
        failures = 0
    return found


class _Search:
    """What is taken, what is dead, and what seeds have grown to so far."""

    def __init__(self, field, seeds, tick):
        self.field, self.seeds, self.tick = field, seeds, tick
        self.taken = np.zeros(len(field), bool)
        self.dead = np.zeros(len(seeds), bool)
        self._small, self._grown = {}, {}

    def starts(self):
        """Indices of the seeds that are started next."""
        lost = self.dead | self.taken[self.seeds.source] | self.taken[self.seeds.target]
        return _apart(self.field, self.seeds, lost)

    def best_of(self, starts):
        """The best of the things that the seeds `starts` grow to, or None; those that come to nothing are dead."""
        small = [(self._of(self._small, s, self._start), s) for s in starts]
        small = sorted(((thing, s) for thing, s in small if thing is not None), key=lambda x: (-x[0].gain, x[1]))
        best = None
        for _, s in small[:GROWN]:
            thing = self._of(self._grown, s, self._grow)
            if thing is not None and (best is None or thing.gain > best[0].gain):
                best = thing, s
        if best is None:
            return None
        self.dead[best[1]] = True
        return best[0]

    def _of(self, store, s, make):
        if s not in store:
            self.tick()
            store[s] = make(s)
            if store[s] is None:
                self.dead[s] = True
        return store[s]

    def _start(self, s):
        thing = started(self.field, self.seeds.motions[s], self.seeds.source[s])
        return thing and grown(self.field, thing, self.seeds, self.taken, (0.0,))

    def _grow(self, s):
        thing = grown(self.field, self._small[s], self.seeds, self.taken, REACHES)
        return thing if thing is not None and thing.gain > 0 else None

    def take(self, thing):
        """The samples that a thing explains are taken; what was grown over them must grow anew."""
        new = explained(self.field, thing) & ~self.taken
        self.taken |= new
        for store in (self._small, self._grown):
            for s in [s for s, t in store.items() if t is not None and new[self._shown(t)].any()]:
                del store[s]

    def _shown(self, thing):
        near = self.field.targets(thing.poses, thing.probe)
        return near[near >= 0]

    def reject(self, thing):
        """The seeds that lead from one pose of a thing to another are dead: they would grow to the same."""
        tree, source = cKDTree(thing.points), self.field.points[self.seeds.source]
        for pose in thing.poses:
            back = inverse(pose)
            distance = tree.query(source @ back[:3, :3].T + back[:3, 3], distance_upper_bound=NEAR_SEED)[0]
            inside = np.flatnonzero(np.isfinite(distance) & ~self.dead)
            if len(inside):
                away = thing.differences(self.seeds.motions[inside] @ pose, thing.poses)
                self.dead[inside[away.min(axis=1) < SAME_POSE]] = True


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
