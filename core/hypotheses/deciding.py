# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of the growths is taken: each is put right and asked for its evidence, and held against the others."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from heapq import heapify, heappop, heappush

import numpy as np

from ..transformations.description import saving
from .completing import with_empty_cells
from .growth import EAGER, appraised, full_grown
from .hypothesis import explained
from .merging import merged
from .significance import evident, expected_by_chance
from .splitting import parted, split

SWEEPS, RIVALS = 5, 3
"""Sweeps of the network for more poses, and things that are held against each other before one is taken."""

HALVES = 3
"""How often halves are put together: an eighth of a thing is found at most; count that bounds the work."""

SAME, FEW, HOPELESS = 0.9, 0.1, 0.5
"""Shares of their samples that two things explain both, when they are one and when they are two (tolerances); and share
of what the best thing saves below which others are not put right: what is put right may save more than before."""


class Growth:
    """A full-grown thing, and the nats that it saves, worked out when they are asked for."""

    def __init__(self, thing):
        self.thing = thing
        self.most = float(thing.scores[1:].sum())

    @cached_property
    def saves(self):
        """Nats."""
        return saving(self.thing)


def left_over(field, growths, new, taken):
    """The growths that a thing which was taken leaves: those that share none of its samples, and without the poses
    where they do those that share few.

    new, taken : (n,) bool, samples that the thing explains, and all things
    """
    out = {}
    for s, of_seed in growths.items():
        mine = [explained(field, g.thing) for g in of_seed]
        shared = np.array([(m & new).sum() / max(m.sum(), 1) for m in mine])
        if (shared > FEW).any():
            continue
        again = [g if not f else Growth(_without(field, g.thing, new, taken)) for g, f in zip(of_seed, shared)]
        out[s] = [g for g in again if len(g.thing) > 1]
    return {s: kept for s, kept in out.items() if kept}


def _without(field, thing, new, taken):
    """The thing without the poses of which half of the samples are another's."""
    mine = [explained(field, thing, thing.poses[k : k + 1]) for k in range(len(thing))]
    own = np.flatnonzero([2 * (m & new).sum() <= m.sum() for m in mine])
    return appraised(field, thing.at(own), taken)


def best_evident(field, growths, taken, significance, log, *, seeds, pairs, tick):
    """Of the growths that one that saves most of the evident ones, put right, and its key; those that are not evident
    leave the growths.

    Notes
    -----
    Halves save more than what they are halves of. So what was put right is held against the next ones once more.
    """
    best, key, most, rivals, swept = None, None, -np.inf, 0, 0
    for s, rival in _by_saving(growths, tick):
        if best is not None and (rival.saves < HOPELESS * most or rivals == RIVALS):
            break
        if best is not None and _same(field, rival.thing, best):
            continue
        thing, expected = _asked(field, rival.thing, tick)
        if expected > significance and rivals + swept < RIVALS:
            # Of what is small, many poses are evident that few are not.
            swept += 1
            more = full_grown(field, rival.thing, seeds, taken, price=EAGER, rounds=SWEEPS, pairs=pairs, tick=tick)
            thing, expected = _asked(field, with_empty_cells(field, more, more.orbit, taken), tick)
        if expected <= significance:
            thing, expected = _cells_put_right(field, thing, expected, seeds, taken, pairs, significance, tick)
        log(f"thing: {len(thing)} poses, {len(thing.points)} points, gain {thing.gain:.0f}, E {expected:.2g}")
        tick()
        saves = saving(appraised(field, thing, taken))
        if expected > significance or len(thing) < 2:
            growths[s].remove(rival)
            continue
        rivals += 1
        if saves > most:
            best, key, most = replace(thing, expected=expected), s, saves
    return best, key


def _asked(field, thing, tick):
    """The thing with its evident poses, and its E-value."""
    thing = evident(field, thing)
    tick()
    return thing, expected_by_chance(field, thing)


def _same(field, thing, other):
    """Whether two things explain mostly the same samples at as many poses."""
    a, b = explained(field, thing), explained(field, other)
    return len(thing) == len(other) and 2 * (a & b).sum() > SAME * (a.sum() + b.sum())


def _cells_put_right(field, thing, expected, seeds, taken, pairs, significance, tick):
    """The thing and its E-value, or those of what it is two of, and of what it is a half, or a quarter, of; with poses
    that no seed led to, and cut where it reaches over its neighbours."""

    def tried(step, thing, expected):
        other = step(thing)
        tick()
        if other is not thing:
            other, chance = _asked(field, other, tick)
            if len(other) >= 2 and chance <= significance:
                return other, chance
        return thing, expected

    for step in [lambda t: split(field, t, seeds, taken, tick)] + [lambda t: merged(field, t, taken)] * HALVES:
        thing, expected = tried(step, thing, expected)
    cut = lambda t: parted(field, t, seeds, taken, pairs, tick)  # noqa: E731
    thing, expected = tried(cut, thing, expected)
    thing, expected = _swept(field, thing, expected, seeds, taken, pairs, significance, tick)
    return tried(cut, thing, expected)


def _swept(field, thing, expected, seeds, taken, pairs, significance, tick):
    """The thing with poses of it that no seed led to, each turned as all say, and its E-value."""
    more = full_grown(field, thing, seeds, taken, price=EAGER, rounds=SWEEPS, pairs=pairs, tick=tick)
    more = evident(field, more)
    chance = expected_by_chance(field, more)
    if chance > significance or len(more) < 2 or (len(more) <= len(thing) and chance > expected):
        return thing, expected
    return more, chance


def _by_saving(growths, tick):
    """Seeds and their growths, that which saves most first."""
    heap = [(-g.most, s, k, False) for s in growths for k, g in enumerate(growths[s])]
    rivals = {(s, k): g for s in growths for k, g in enumerate(growths[s])}
    heapify(heap)
    while heap:
        _, s, k, known = heappop(heap)
        if known:
            yield s, rivals[s, k]
        else:
            heappush(heap, (-rivals[s, k].saves, s, k, True))
            tick()
