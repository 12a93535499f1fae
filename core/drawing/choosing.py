# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of the candidate curves belong to a thing, and at which of its poses.

Candidates come from an overlay with wide margins, so that in a row of windows the neighbours' curves are among them.
Those that most poses show come first, and each sample of the network is explained once: of curves that are each
other's images under the poses one is left. A curve belongs to all poses or, if that pays, to some of them: to a set that
other curves have, or to one of its own, at the price of naming it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.special import gammaln

from .evidence import RIVAL, Sightings, chances, kept_stretches, log_odds, point_scores, seen_by, sightings
from .overlay import Overlay

GAP, SHORTEST, NEAR = 8, 5, 0.5
"""Tolerances: points of the shortest gap that is cut into a curve, points of the shortest curve, and the poses that a
candidate may be seen at less to be preferred for lying one size of the thing nearer to its core."""


@dataclass(frozen=True)
class Chosen:
    """Curves of a thing. curves : list of (k, 3); closed : list of bool; sets : (c, k) bool, the poses of each;
    scores : (c,) float64, nats."""

    curves: list
    closed: list
    sets: np.ndarray
    scores: np.ndarray

    def part(self, use) -> Chosen:
        """Some of the curves (indices)."""
        return Chosen(
            [self.curves[i] for i in use], [self.closed[i] for i in use], self.sets[use], self.scores[use]
        )  # fmt: skip


def choose(curves, closed, overlay: Overlay, core, *, p, least, radius, taken=None, sets=()) -> Chosen:
    """Of candidate curves those that the evidence is for.

    Parameters
    ----------
    curves, closed : candidates in the thing's frame; core : (m, 3) float64, points that surely belong to it
    p : share of a curve that a pose shows; least : nats that a curve must have
    taken : (n,) float64, distance of each sample of the network to a curve that explains it already, inf for none
    sets : (k,) bool arrays, sets of poses that other curves have
    """
    found = sightings(curves, overlay, radius=radius)
    q = np.minimum(chances(curves, overlay, radius=radius), 0.9 * p)
    samples = int(overlay.sample.max(initial=-1)) + 1
    taken = np.full(samples, np.inf) if taken is None else taken[:samples].copy()
    sets, out = list(sets), []
    for c in _order(found, overlay, curves, core, p):
        here = found.of_curve(c)
        item = found.item[here]
        fresh = taken[overlay.sample[item]] - found.distance[here] > RIVAL
        seen = np.zeros((overlay.cells, len(curves[c])), bool)
        seen[overlay.cell[item[fresh]], found.point[here][fresh] - found.offsets[c]] = True
        mine, parts, score = _best_set(seen, closed[c], p, q[c], sets, least)
        if mine is None:
            continue
        if not any((mine == known).all() for known in sets):
            sets.append(mine)
        whole = len(parts) == 1 and len(parts[0]) == len(curves[c])
        out += [(curves[c][part], closed[c] and whole, mine, score) for part in parts]
        inside = np.isin(found.point[here] - found.offsets[c], np.concatenate(parts)) & mine[overlay.cell[item]]
        np.minimum.at(taken, overlay.sample[item[inside]], found.distance[here][inside])
    return _chosen(out, overlay.cells)


def _chosen(rows, cells) -> Chosen:
    curves, closed, sets, scores = (list(x) for x in zip(*rows)) if rows else ([], [], [], [])
    return Chosen(curves, closed, np.array(sets, bool).reshape(-1, cells), np.array(scores, float))


def _order(found: Sightings, overlay, curves, core, p):
    """Candidates in the order in which they are asked: those that most poses show, then those close to the core."""
    seen = seen_by(found, overlay)
    share = np.add.reduceat(seen, found.offsets[:-1], axis=1, dtype=float) / np.diff(found.offsets)
    tree = cKDTree(core)
    away = np.array([np.median(tree.query(c)[0]) for c in curves])
    size = max(np.linalg.norm(core.std(axis=0)), 10.0)
    return np.argsort(-(np.clip(share / p, 0, 1).sum(axis=0) - NEAR * away / size), kind="stable")


def _best_set(seen, ring, p, q, sets, least):
    """The poses (k,) bool at which a curve is best said to be, the stretches of it that are left, and its nats.

    seen : (k, n) bool. None where nothing pays.
    """
    k = len(seen)
    each = log_odds(seen, p, q).sum(axis=1)
    own = each > 0
    m = int(own.sum())
    options = [(np.ones(k, bool), 0.0)]
    options += [(known, np.log(1 + len(sets))) for known in sets if not known.all()]
    if 2 <= m < k:
        options.append((own, gammaln(k + 1) - gammaln(m + 1) - gammaln(k - m + 1) + np.log(k)))
    best = None, [], 0.0
    for mine, cost in options:
        score = point_scores(seen[mine], p, q)
        parts = kept_stretches(score, ring, least, GAP)
        parts = [part for part in parts if len(part) >= SHORTEST and score[part].sum() > 0]
        total = sum(score[part].sum() for part in parts) - cost
        if parts and total > max(best[2], least):
            best = mine, parts, total
    return best


def connected(chosen: Chosen, core, join) -> Chosen:
    """The curves that hang together with the core over gaps of at most `join` edge lengths."""
    if not chosen.curves:
        return chosen
    trees = [cKDTree(c) for c in [*chosen.curves, core]]
    low, high = (np.array([f(t.data, axis=0) for t in trees]) for f in (np.min, np.max))
    n = len(trees)
    near = ((low[:, None] - high[None] < join) & (low[None] - high[:, None] < join)).all(axis=2)
    pair = [(a, b) for a, b in np.argwhere(np.triu(near, 1)) if _meet(trees[a], trees[b], join)]
    i, j = np.array(pair, np.int64).reshape(-1, 2).T
    label = connected_components(coo_matrix((np.ones(len(i)), (i, j)), shape=(n, n)), directed=False)[1]
    return chosen.part(np.flatnonzero(label[:-1] == label[-1]))


def _meet(a, b, join):
    return np.isfinite(a.query(b.data, distance_upper_bound=join)[0]).any()


def merged(a: Chosen, b: Chosen) -> Chosen:
    """The curves of both."""
    return replace(
        a, curves=a.curves + b.curves, closed=a.closed + b.closed, sets=np.concatenate([a.sets, b.sets]),
        scores=np.concatenate([a.scores, b.scores]),
    )  # fmt: skip
