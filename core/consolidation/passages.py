# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pieces continue each other, by the curves that run over both.

Where curves cross at a flat angle, meet or turn a corner, geometry alone does not say which arm goes on as which.
The input does: each of its curves that passes the place runs from one arm to the other, in every occurrence that
shows it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.rows import distinct_rows

STEADY, PASSAGE, NEAR_END, ARRIVED, OFTEN, FEW = 4, 16, 8.0, 3.0, 3, 0.1
"""Samples in a row that put a run on a piece, most samples between two pieces, edge lengths from the end of a piece
within which a run must leave it, and within which it has come to the end, runs that make it known that it ends, and the
share of those that may go on all the same."""


@dataclass(frozen=True)
class Passages:
    """What runs over pieces tell of their ends; the ends of piece i are 2 i (its first sample) and 2 i + 1.

    pairs : (2 p, 2 p) int64, symmetric, runs that lead from one end to another
    routes : (k, 3) int64, (a, b, runs): runs that come from end a, pass one piece and go on at end b, a < b
    through : (k,) int64, the piece that each route passes
    arrivals : (2 p,) int64, runs that follow a piece right up to its end, whether they go on or not
    """

    pairs: np.ndarray
    routes: np.ndarray
    through: np.ndarray
    arrivals: np.ndarray

    @property
    def parted(self) -> np.ndarray:
        """(2 p, 2 p) bool, ends that many runs come to and none leads between: curves that end at one place."""
        often = self.arrivals >= OFTEN
        return (self.pairs == 0) & often[:, None] & often[None, :]


def find_passages(pieces, points, tangents, run, *, radius=1.8, cosine=0.7) -> Passages:
    """How runs lead from piece to piece.

    Parameters
    ----------
    pieces : list of (k, 3) float64, samples about one edge length apart
    points, tangents : (n, 3) float64; run : (n,) int64, the same for samples that follow each other on one curve
    """
    count = 2 * len(pieces)
    if not pieces or not len(points):
        none = np.zeros(0, np.int64)
        return Passages(np.zeros((count, count), np.int64), np.zeros((0, 3), np.int64), none, np.zeros(count, np.int64))
    out, into, connected, arrivals = _steps(pieces, points, tangents, run, radius, cosine)
    pairs = np.zeros((count, count), np.int64)
    good = (out >= 0) & (into >= 0)
    np.add.at(pairs, (out[good], into[good]), 1)
    # Two steps in a row make a route where the first enters a piece at one end and the second leaves it at the other.
    first = np.flatnonzero(good[:-1] & good[1:] & connected & (into[:-1] ^ 1 == out[1:]))
    a, b, piece = out[first], into[first + 1], into[first] // 2
    keys, _, key = distinct_rows(np.stack([piece, np.minimum(a, b), np.maximum(a, b)], axis=1))
    runs = np.bincount(key, minlength=len(keys))
    return Passages(pairs + pairs.T, np.concatenate([keys[:, 1:], runs[:, None]], axis=1), keys[:, 0], arrivals)


def _steps(pieces, points, tangents, run, radius, cosine):
    """Steps of runs from piece to piece: the ends left and entered, or -1, and whether the next step goes on; and how
    many runs reach each end."""
    piece, at, run, sample, size, first, last = _stretches(pieces, points, tangents, run, radius, cosine)
    a, b = np.arange(len(first) - 1), np.arange(1, len(first))
    goes_on = run[last[a]] == run[first[b]]
    goes_on &= sample[first[b]] - sample[last[a]] <= PASSAGE
    goes_on &= (piece[first[a]] != piece[first[b]]) | (np.abs(at[first[b]] - at[last[a]]) > PASSAGE)
    a, b = a[goes_on], b[goes_on]
    out = _end_towards(at, piece, size, first[a], last[a])
    into = _end_towards(at, piece, size, last[b], first[b])
    reached = [_end_towards(at, piece, size, *way, close=ARRIVED) for way in ((first, last), (last, first))]
    reached = np.concatenate(reached)
    return out, into, b[:-1] == a[1:], np.bincount(reached[reached >= 0], minlength=2 * len(pieces))


def _stretches(pieces, points, tangents, run, radius, cosine):
    """Stretches of runs that stay on one piece for at least `STEADY` samples.

    Returns, of the samples that lie on a piece, the piece, the place on it, the run and the index; the samples of
    each piece; and of each stretch its first and its last sample among those.
    """
    line = np.concatenate(pieces)
    way = np.concatenate([np.gradient(p, axis=0) for p in pieces])
    way /= np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]
    size = np.array([len(p) for p in pieces])
    owner = np.repeat(np.arange(len(pieces)), size)
    place = np.arange(len(line)) - np.repeat(np.cumsum(size) - size, size)
    distance, near = cKDTree(line).query(points, k=4, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    found &= np.abs((way[near] * tangents[:, None]).sum(-1)) > cosine
    sample = np.flatnonzero(found.any(axis=1))
    near = near[sample, found[sample].argmax(axis=1)]
    piece, at, run = owner[near], place[near], run[sample]
    # Stretches of samples on one piece, as long as the run stays on it.
    fresh = np.ones(len(sample), bool)
    fresh[1:] = (np.diff(piece) != 0) | (np.diff(run) != 0) | (np.diff(sample) > PASSAGE)
    # A run over the two ends of one piece, which belong together, jumps from one to the other.
    fresh[1:] |= np.abs(np.diff(at)) > PASSAGE
    first = np.flatnonzero(fresh)
    last = np.append(first[1:], len(sample)) - 1
    steady = last - first + 1 >= np.minimum(STEADY, size[piece[first]])
    return piece, at, run, sample, size, first[steady], last[steady]


def split_where_none_pass(pieces, points, tangents, run, *, radius=1.8, cosine=0.7):
    """Pieces cut where runs end from both sides and none goes through: two curves that end at one place."""
    if not pieces or not len(points):
        return list(pieces)
    piece, at, _, _, size, first, last = _stretches(pieces, points, tangents, run, radius, cosine)
    low, high = np.minimum(at[first], at[last]), np.maximum(at[first], at[last])
    out = []
    for k, line in enumerate(pieces):
        mine = piece[first] == k
        out += [line[a:b] for a, b in _parts(low[mine], high[mine], int(size[k]))]
    return out


def _parts(low, high, size, *, reach=4, least=6):
    """Bounds of the parts of a piece of `size` samples that stretches from `low` to `high` run over."""
    x = np.arange(size)[:, None]
    ends = np.minimum(
        ((high >= x - reach) & (high < x + reach)).sum(axis=1), ((low > x - reach) & (low <= x + reach)).sum(axis=1)
    )
    passing = ((low <= x - reach) & (high >= x + reach)).sum(axis=1)
    cuts = []
    for k in np.argsort(-ends, kind="stable"):
        if ends[k] < OFTEN:
            break
        if passing[k] <= FEW * ends[k] and all(abs(k - c) >= least for c in [0, *cuts, size - 1]):
            cuts.append(int(k))
    bounds = [0, *sorted(cuts), size]
    return list(zip(bounds[:-1], bounds[1:]))


def _end_towards(at, piece, size, begin, stop, close=None):
    """The end that a stretch from sample `begin` to sample `stop` runs to and is close to at its stop, or -1."""
    p = piece[stop]
    forward = at[stop] > at[begin]
    left = np.where(forward, size[p] - 1 - at[stop], at[stop])
    moved = (at[stop] != at[begin]) | (size[p] <= STEADY)
    return np.where(moved & (left <= (NEAR_END if close is None else close)), 2 * p + forward, -1)


def part_shared(pieces, passages: Passages, smooth, bend, *, least=2, most=3):
    """Pieces that several curves share, once for each of them.

    A piece with two or more arms at either end is the common stretch of curves that touch or cross at a flat angle.
    The arms are paired as most runs pass them; where no run shows it, as they bend least.

    Parameters
    ----------
    smooth : (k, 2) int64, ends that continue each other smoothly, and are arms even where no run leads over
    bend : called with two ends, gives how badly they continue each other
    least : runs that make an arm; most : arms at an end that are looked at

    Returns
    -------
    pieces : the given ones, those that are shared repeated at the end
    forced : (k, 2) int64, ends that belong together: each copy with the two arms of its route
    """
    pieces, forced, parted, taken = list(pieces), [], set(), set()
    arms = np.where(passages.pairs >= least, passages.pairs + 1, 0)
    for a, b in (smooth.T, smooth.T[::-1]):
        arms[a, b] = np.maximum(arms[a, b], passages.pairs[a, b] + 1)
    branches = (arms > 0).sum(axis=1).reshape(-1, 2)
    for piece in np.lexsort((-arms.sum(axis=1).reshape(-1, 2).sum(axis=1),)):
        if branches[piece].min() < 2:
            continue
        head, tail = ([e for e in np.argsort(-arms[end], kind="stable")[:most].tolist()
                       if arms[end, e] and e not in taken and e // 2 not in parted]
                      for end in (2 * piece, 2 * piece + 1))  # fmt: skip
        if min(len(head), len(tail)) < 2 or {e // 2 for e in head} & {e // 2 for e in tail}:
            continue
        parted.add(int(piece))
        for number, (a, b) in enumerate(_pairing(head, tail, passages, piece, bend)):
            copy = int(piece) if number == 0 else len(pieces)
            if number:
                pieces.append(pieces[piece])
            forced += [(a, 2 * copy), (b, 2 * copy + 1)]
            taken |= {a, b}
    return pieces, np.array(forced, np.int64).reshape(-1, 2)


def _pairing(head, tail, passages, piece, bend):
    """Pairs of arms at the two ends of a piece: those with the most runs through, then with the least bend."""
    runs = {(a, b): n for a, b, n in passages.routes[passages.through == piece].tolist()}
    if len(head) > len(tail):
        return [(a, b) for b, a in _pairing(tail, head, passages, piece, bend)]

    def badness(choice):
        pairs = list(zip(head, choice))
        return -sum(runs.get((min(p), max(p)), 0) for p in pairs), sum(bend(*p) for p in pairs)

    return list(zip(head, min(permutations(tail, len(head)), key=badness)))
