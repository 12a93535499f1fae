# SPDX-License-Identifier: GPL-3.0-or-later
"""Sub-lattices: what recurs in some cells of an orbit only, under powers of its generators.

The paper names it as a limit: a blade that is the same on two sides, on a tool whose handle repeats every 60 degrees,
would be put at every 60 degrees. Here the generator belongs to the component. Round a closed rotation each region is
asked which powers it recurs under before cells are laid over each other; in any orbit, what its cells do not explain is
looked at under each power of its generators.
"""

from __future__ import annotations

from math import gcd

import numpy as np
from scipy.ndimage import gaussian_filter

from .clustering import perturbed
from .orbits import Orbit
from .support import Screen, in_long_stretches, slips

FARTHEST, CLEARLY, OVER_CHANCE = 6, 0.6, 2.0
"""Highest power that is looked at, share of the best power's support that a generator must keep to be one, and by
what factor support must exceed that of motions beside."""


REGION, FINER, SEEN, AS_GOOD = 8.0, 0.5, 0.15, 0.75
"""Size of a region (standard deviation, edge lengths); the share of what recurs under the multiples of a power that
the other powers show too, below which the region has a sub-lattice; the least share of a region that must recur; and of
several powers the lowest is taken whose multiples show this share of what those of the best one show."""


def steps_of(orbit: Orbit, screen: Screen):
    """(n,) int64, for each sample the power of the generator of a closed rotation under which its region recurs.

    1 where the region recurs under all powers, or where nothing is known; 1 everywhere for other orbits.

    Notes
    -----
    A region is what lies at one height along the axis and one distance from it, in all cells. Its samples say together
    how much of it each power takes onto the network: under all powers much the same where it recurs in every cell,
    under the multiples of d alone where it recurs in every d-th. Single curves cannot tell, they have holes.
    """
    steps = np.ones(len(screen.points), np.int64)
    order = int(orbit.count[0]) + 1
    divisors = [d for d in range(2, order) if order % d == 0]
    if not orbit.closed or not divisors:
        return steps
    hit, slipping = _hits_of_powers(orbit, screen, order)
    region = _Regions(orbit, screen.points)
    size = region.mean(screen.weight)
    share = np.stack([region.mean(screen.weight * hit[p]) for p in range(1, order)]) / size
    powers = np.arange(1, order)
    best = np.zeros(len(steps))
    for d in reversed(divisors):
        among, rest = share[powers % d == 0].mean(axis=0), share[powers % d != 0].mean(axis=0)
        better = (rest < FINER * among) & (among > SEEN) & (among >= AS_GOOD * best)
        steps[better] = d
        best = np.maximum(best, np.where(better, among, 0))
    return np.where(slipping, 1, steps)


def _hits_of_powers(orbit, screen, order):
    """(order, n) bool, the samples that each power takes onto the network, and (n,) bool, those that slip along it."""
    hit = np.zeros((order, len(screen.points)), bool)
    for p in range(1, order):
        motion = orbit.power([[p]])
        row, k, _ = screen.hits(motion)
        hit[p, k[in_long_stretches(row, k, screen.curve, screen.least)]] = True
        screen.tick()
    every = np.arange(len(screen.points))
    slipping = slips(orbit.generators, np.zeros_like(every), screen.points, screen.tangents)
    return hit & ~slipping, slipping


class _Regions:
    """Means over all points at about the same height along an axis and distance from it."""

    def __init__(self, orbit, points, bin_size=2.0):
        turn, slide = orbit.twists[0, :3], orbit.twists[0, 3:]
        axis = turn / np.linalg.norm(turn)
        local = points - np.cross(turn, slide) / (turn @ turn)
        height = local @ axis
        distance = np.linalg.norm(local - height[:, None] * axis, axis=1)
        self.key = tuple(np.floor(np.stack([height - height.min(), distance]) / bin_size).astype(np.int64))
        self.shape = [k.max() + 1 for k in self.key]
        self.width = REGION / bin_size

    def mean(self, value):
        """(n,) float64, the sum of values (n,) around each point, by a Gaussian of width REGION."""
        grid = np.zeros(self.shape)
        np.add.at(grid, self.key, value)
        return gaussian_filter(grid, self.width, mode="constant")[self.key]


def coarser(orbit: Orbit, step, support) -> Orbit:
    """The closed rotation by so many steps of another one."""
    return _orbit_of(orbit, np.array([[step]]), support)


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
