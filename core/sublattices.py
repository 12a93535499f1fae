# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-lattices: what recurs in some cells of an orbit only, under powers of its generators.

The paper names it as a limit: a blade that is the same on two sides, on a tool whose handle repeats every 60 degrees,
would be put at every 60 degrees. Here the generator belongs to the component: what the cells of an orbit do not
explain is looked at under each power of its generators.
"""

from __future__ import annotations

from math import gcd

import numpy as np

from .clustering import perturbed
from .orbits import Orbit
from .support import Screen, in_long_stretches, slips

FARTHEST, CLEARLY, OVER_CHANCE = 6, 0.6, 2.0
"""Highest power that is looked at, share of the best power's support that a generator must keep to be one, and by
what factor support must exceed that of motions beside."""


def sublattice(orbit: Orbit, screen: Screen, free, *, shortest) -> Orbit | None:
    """The orbit of powers of an orbit's generators under which the free samples recur, or None.

    Parameters
    ----------
    free : (n,) bool, samples that nothing explains yet
    shortest : edge lengths that must recur

    Returns
    -------
    Orbit whose generators are powers of the given ones, and not just those themselves
    """
    keys = _powers(orbit)
    motions = orbit.power(keys)
    support = recurring_length(screen, motions, free)
    beside = perturbed(np.repeat(motions, 3, axis=0), screen.points.std(axis=0))
    chance = np.quantile(recurring_length(screen, beside, free), 0.8)
    best = int(np.argmax(support))
    if support[best] < max(OVER_CHANCE * chance, shortest):
        return None
    strong = np.flatnonzero(support >= CLEARLY * support[best])
    # Of powers that show about the same the lowest is the generator.
    size = np.abs(keys).sum(axis=1)
    first = strong[np.lexsort((-support[strong], size[strong]))[0]]
    chosen = [keys[first]]
    if keys.shape[1] == 2:
        across = [k for k in strong if keys[k, 0] * keys[first, 1] != keys[k, 1] * keys[first, 0]]
        if across:
            chosen.append(keys[min(across, key=lambda k: (size[k], -support[k]))])
    chosen = np.array(chosen)
    if abs(_determinant(chosen)) == 1:
        return None
    return _orbit_of(orbit, chosen, float(support[best]))


def recurring_length(screen: Screen, motions, free):
    """(h,) float64, length of the free samples that each motion takes onto free samples, without what slips."""
    out = np.zeros(len(motions))
    size = max(1, 400_000 // len(screen.points))
    for begin in range(0, len(motions), size):
        part = motions[begin : begin + size]
        i, k, j = screen.hits(part)
        good = free[k] & free[j]
        i, k = i[good], k[good]
        good = in_long_stretches(i, k, screen.curve, screen.least)
        i, k = i[good], k[good]
        good = ~slips(part, i, screen.points[k], screen.tangents[k])
        out[begin : begin + size] = np.bincount(i[good], screen.weight[k[good]], minlength=len(part))
        screen.tick()
    return out


def _powers(orbit):
    """Powers (k, g) that are looked at, one of each pair of inverses."""
    if orbit.closed:
        return np.arange(1, (orbit.count[0] + 1) // 2 + 1)[:, None]
    axes = [np.arange(-min(c, FARTHEST), min(c, FARTHEST) + 1) for c in orbit.count]
    keys = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
    first = keys[np.arange(len(keys)), np.argmax(keys != 0, axis=1)]
    return keys[first > 0]


def _determinant(chosen):
    """Index of the sub-lattice; of one generator in two its greatest step counts, if it is none of the two."""
    if chosen.shape[0] == chosen.shape[1]:
        return int(round(np.linalg.det(chosen)))
    return int(np.abs(chosen).max())


def _orbit_of(orbit, chosen, support):
    """The orbit with powers (h, g) of another's generators as its own."""
    twists = chosen @ orbit.twists
    if orbit.closed:
        order = int(orbit.count[0]) + 1
        step = gcd(int(chosen[0, 0]), order)
        return Orbit("rotation", step * orbit.twists, np.array([order // step - 1]), True, support)
    # As far as the orbit reaches in every generator that a power moves along.
    reach = [int((orbit.count[row != 0] // np.abs(row[row != 0])).min()) for row in chosen]
    kind = "grid" if len(chosen) == 2 else "translation" if orbit.kind == "grid" else orbit.kind
    return Orbit(kind, twists, np.maximum(reach, 1), False, support)
