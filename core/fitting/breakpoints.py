# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a curve changes from one primitive to the next: the shortest description, by dynamic programming.

A piece costs what it leaves unexplained, as a multiple of the variance, and log(samples) for each of its numbers: the
Bayesian information criterion of the whole curve (Schwarz 1978).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .costs import LEAST, Moments, arc_cost, cubic_cost, line_cost

NUMBERS = {2: np.array([4, 5, 8]), 3: np.array([5, 7, 11])}
"""Numbers of a line, an arc and a Bezier segment with the knot where it begins: in a plane, and in space. The place of
a knot along the curve counts for three: it is the best of all samples, so noise gains by it (Yao 1988)."""

COARSE, MOST, FINER, WIDEST = 4, 700, 4, 96
"""Samples between the knots that are tried first, most knots that are tried, the factor between one round and the
next, and the most steps that one Bezier segment spans in a round."""


@dataclass(frozen=True)
class Pieces:
    """knots : (k + 1,) int64, piece i is made of samples knots[i] to knots[i + 1], exclusive; kinds : (k,) int64, index
    into `costs.KINDS`; cost : float, of the whole description."""

    knots: np.ndarray
    kinds: np.ndarray
    cost: float


def find_pieces(points, *, variance, dimension) -> Pieces:
    """The pieces of one polyline.

    Parameters
    ----------
    points : (n, 3) float64, n >= 2, in even steps
    variance : of a sample along one axis, times the number of samples that err alike
    dimension : 2 for a plane curve, 3 for one in space

    Notes
    -----
    Knots are tried on a coarse row first, then around those found, `FINER` times as fine a round, down to every
    sample. A curve of up to `COARSE` * 12 samples is solved exactly at once. O(knots^2) a round.
    """
    n = len(points)
    moments = Moments.of(points)
    step = 1 if n <= 12 * COARSE else max(COARSE, -(-n // MOST))
    candidates = np.unique(np.r_[np.arange(0, n - 1, step), n])
    while True:
        pieces = _best(moments, candidates, variance, NUMBERS[dimension])
        if step == 1:
            return pieces
        finer = max(1, step // FINER)
        near = np.arange(-step, step + 1, finer)
        candidates = np.unique(np.r_[0, n, (pieces.knots[1:-1, None] + near).ravel()])
        candidates = candidates[(candidates == 0) | (candidates == n) | ((candidates > 1) & (candidates < n - 1))]
        step = finer


def _best(moments: Moments, candidates, variance, numbers) -> Pieces:
    """The cheapest pieces whose knots are among the candidates (c,), increasing."""
    c = len(candidates)
    i, j = np.triu_indices(c, 1)
    cost, kind = _piece_costs(moments, candidates[i], candidates[j], j - i, variance, numbers)
    table, kinds = np.full((c, c), np.inf), np.zeros((c, c), np.int64)
    table[i, j], kinds[i, j] = cost, kind
    best, before = np.zeros(c), np.zeros(c, np.int64)
    for k in range(1, c):
        total = best[:k] + table[:k, k]
        before[k] = total.argmin()
        best[k] = total[before[k]]
    path = [c - 1]
    while path[-1]:
        path.append(int(before[path[-1]]))
    path = np.array(path[::-1])
    return Pieces(candidates[path], kinds[path[:-1], path[1:]], float(best[-1]))


def _piece_costs(moments, a, b, steps, variance, numbers):
    """Cost of the best kind for samples a to b (k,), and which it is. A kind is tried where it can still win."""
    price = numbers * np.log(len(moments.points))
    unexplained, mean, spread = line_cost(moments, a, b)
    cost = np.where(b - a >= LEAST[0], unexplained / variance + price[0], np.inf)
    kind = np.zeros(len(a), np.int64)
    use = np.flatnonzero((cost > price[1]) & (b - a >= LEAST[1]))
    _improve(cost, kind, use, arc_cost(moments, a[use], b[use], mean[use], spread[use]) / variance + price[1], 1)
    use = np.flatnonzero((cost > price[2]) & (b - a >= LEAST[2]) & (steps <= WIDEST))
    _improve(cost, kind, use, cubic_cost(moments, a[use], b[use]) / variance + price[2], 2)
    return cost, kind


def _improve(cost, kind, rows, other, which):
    better = rows[other < cost[rows]]
    cost[better] = other[other < cost[rows]]
    kind[better] = which
