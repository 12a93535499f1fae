# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of the candidate curves belong to a thing, and at which of its poses.

Candidates come from an overlay with wide margins, so that in a row of windows the neighbours' curves are among them.
Those that most poses show come first, and each sample of the network is explained once: of curves that are each
other's images under the poses one is left. A curve belongs to all poses or, if that pays, to some of them: to a set
that other curves have, or to one of its own, at the price of naming it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.special import gammaln

from ..geometry.motions import apply
from .evidence import (
    APART,
    LEAST_CHANCE,
    LEAST_SHOWN,
    RIVAL,
    Sightings,
    chances,
    kept_stretches,
    log_odds,
    point_scores,
    seen_by,
    sightings,
)
from .homing import at_home
from .overlay import Overlay

GAP, SHORTEST, NEAR = 5, 5, 0.5
"""Tolerances: points of the shortest gap that is cut into a curve, points of the shortest curve, and the poses that a
candidate may be seen at less to be preferred for lying one size of the thing nearer to its core."""


WELL = 25
"""Points of the stretch of a curve that is seen best, by which the rest of it is judged (two observations)."""

PLACES = 6.0
"""Nats for where, in the margin of a thing, a curve of a set of poses of its own may lie: some hundred places at which
long straight lines can meet by chance."""

HIDDEN = 2.3
"""Nats that a pose may say against a curve: at one place of ten a whole curve is hidden, or not detected at all. One of
six windows that lacks its sill has a sill; what half of them lack is another kind."""

RARE = 2.3
"""Nats against a curve of a set of poses of its own: of ten curves nine are wherever the thing is."""

SPREAD = 5.0
"""Edge lengths by which poses must spread in a direction to lie on sides of it (tolerance)."""


STUB = 1.0
"""Nats that a curve must have that is a single observation in each pose, wherever it is."""


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


def choose(curves, closed, overlay: Overlay, core, *, p, least, join, radius, motions, halves, sets=()) -> Chosen:
    """Of candidate curves those that the evidence is for.

    Parameters
    ----------
    curves, closed : candidates in the thing's frame; core : (m, 3) float64, points that surely belong to it
    p : share of a curve that a pose shows
    least : nats that a curve must have at `join` edge lengths from what is known of the thing; the less, the closer
    motions : (m, 4, 4) float64, from poses to their neighbours, in the thing's frame
    halves : (h, k) bool, sets of poses that lie together, see `halves_of`
    sets : (k,) bool arrays, sets of poses that other curves have
    """
    q = np.minimum(chances(curves, overlay, radius=radius), 0.9 * p)
    curves = at_home(
        curves, motions, overlay, core, q, p=p, least=least, reach=join, near=NEAR, radius=radius
    )  # fmt: skip
    q = np.minimum(chances(curves, overlay, radius=radius), 0.9 * p)
    found = sightings(curves, overlay, radius=radius)
    taken = np.full(int(overlay.sample.max(initial=-1)) + 1, np.inf)
    sets, out, known = list(sets), [], _Near(core)
    left = list(_order(found, overlay, curves, core, p))
    while left:
        again = []
        for c in left:
            price = known.price(curves[c], least, join)
            here = found.of_curve(c)
            point, item = found.point[here] - found.offsets[c], found.item[here]
            fresh = taken[overlay.sample[item]] - found.distance[here] > RIVAL
            seen = np.zeros((overlay.cells, len(curves[c])), bool)
            seen[overlay.cell[item[fresh]], point[fresh]] = True
            mine, parts, score = _best_set(seen, closed[c], p, q[c], sets, halves, least, price)
            if mine is None:
                again.append(c)
                continue
            if not any((mine == s).all() for s in sets):
                sets.append(mine)
            whole = len(parts) == 1 and len(parts[0]) == len(curves[c])
            out += [(curves[c][part], closed[c] and whole, mine, score) for part in parts]
            inside = np.isin(point, np.concatenate(parts)) & mine[overlay.cell[item]]
            np.minimum.at(taken, overlay.sample[item[inside]], found.distance[here][inside])
            known.add([curves[c][part] for part in parts])
        if len(again) == len(left) or not known.grown():
            break
        left = again
    return _chosen(out, overlay.cells)


class _Near:
    """How far a curve is from what is known of the thing, which grows."""

    def __init__(self, core):
        self.points, self.more = core, []
        self.tree = cKDTree(core)

    def price(self, curve, least, join):
        """Nats that a curve must have: none where it touches what is known, `least` at `join`, more beyond."""
        gap = self.tree.query(curve)[0].min()
        return max(STUB if len(curve) < APART else 0.0, least * gap / join)

    def add(self, curves):
        self.more += curves

    def grown(self):
        """Take up what was added; whether there was something."""
        if not self.more:
            return False
        self.points, self.more = np.concatenate([self.points, *self.more]), []
        self.tree = cKDTree(self.points)
        return True


def _chosen(rows, cells) -> Chosen:
    curves, closed, sets, scores = (list(x) for x in zip(*rows)) if rows else ([], [], [], [])
    return Chosen(curves, closed, np.array(sets, bool).reshape(-1, cells), np.array(scores, float))


def _order(found: Sightings, overlay, curves, core, p):
    """Candidates in the order in which they are asked: those that most poses show, then those close to the core."""
    seen = seen_by(found, overlay)
    share = np.add.reduceat(seen, found.offsets[:-1], axis=1, dtype=float) / np.diff(found.offsets)
    tree, size = cKDTree(core), max(np.linalg.norm(core.std(axis=0)), 10.0)
    away = np.array([np.median(tree.query(c)[0]) for c in curves])
    return np.argsort(-(np.clip(share / p, 0, 1).sum(axis=0) - NEAR * away / size), kind="stable")


def _best_set(seen, ring, p, q, sets, halves, least, price):
    """The poses (k,) bool at which a curve is best said to be, the stretches of it that are left, and its nats.

    seen : (k, n) bool; halves : (h, k) bool, sets that are cheap to name; least : nats against a stretch that cut it
    out; price : nats that a curve must have. None where nothing pays.
    """
    k = len(seen)
    each = log_odds(seen, _rate(seen, p, q), q).sum(axis=1)
    if (each > 0).any():
        each = log_odds(seen, _rate(seen[each > 0], p, q), q).sum(axis=1)
    own = each > 0
    m = int(own.sum())
    options = [(np.ones(k, bool), 0.0, price)]
    options += [(known, np.log(1 + len(sets)), price) for known in sets if not known.all()]
    if len(halves):
        half = halves[np.argmax(halves @ each)]
        options.append((half, RARE + np.log(len(halves)), price + PLACES))
    if 2 <= m < k:
        which = gammaln(k + 1) - gammaln(m + 1) - gammaln(k - m + 1) + np.log(k)
        options.append((own, RARE + which, price + PLACES))
    best = None, [], 0.0
    enough = price
    for mine, cost, asked in options:
        # A pose that lacks the whole curve says nothing of how well it is seen where it is.
        rate = _rate(seen[mine & own] if (mine & own).any() else seen[mine], p, q)
        score = point_scores(seen[mine], rate, q)
        parts = kept_stretches(score, ring, least, GAP)
        parts = [part for part in parts if len(part) >= SHORTEST and score[part].sum() > 0]
        away = log_odds(seen[mine], rate, q).sum(axis=1)
        total = sum(score[part].sum() for part in parts) - cost + np.maximum(-HIDDEN - away, 0).sum()
        if parts and total > best[2]:
            best, enough = (mine, parts, total), asked
    return best if best[2] > enough else (None, [], 0.0)


def halves_of(poses, points):
    """(h, k) bool, the sets of two poses or more that lie on one side of a plane across a main direction of all: the
    upper row, all bays but the last. They are cheap to name.

    points : (n, 3) float64, of the thing
    """
    k = len(poses)
    if k < 3:
        return np.zeros((0, k), bool)
    at = apply(poses, points.mean(axis=0)[None])[:, 0]
    at = at - at.mean(axis=0)
    values, axes = np.linalg.eigh(at.T @ at / k)
    # Across a row all sides are chance.
    axes = axes[:, values > SPREAD**2]
    rank = np.argsort(np.argsort(at @ axes, axis=0, kind="stable"), axis=0, kind="stable")
    cut = np.arange(2, k)
    low = rank.T[:, None] < cut[:, None]
    high = rank.T[:, None] >= (k - cut)[:, None]
    return np.concatenate([low.reshape(-1, k), high.reshape(-1, k)])


def _rate(seen, p, q):
    """How likely a point of one curve is seen where it is: short curves are hidden more than long ones, so each says
    for itself, between the least that is more than chance and what the thing as a whole shows."""
    low = min(max(LEAST_SHOWN, 1.5 * q), 0.9)
    return float(np.clip(seen.mean(), low, max(p, low)))


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


def trimmed(chosen: Chosen, seen, offsets, p, q, least) -> Chosen:
    """The curves without the stretches that have at least `least` nats against them.

    seen : (k, n) bool, which points of all curves the poses show; offsets : (c + 1,) where the points of each begin
    p : share of a curve that a pose shows; q : (c,) float64, chance
    """
    out = []
    for c, (curve, ring, mine) in enumerate(zip(chosen.curves, chosen.closed, chosen.sets)):
        here = seen[mine, offsets[c] : offsets[c + 1]]
        # Other curves of the thing, which the decoys hit, explain their samples already.
        chance = min(q[c], 0.5 * max(here.mean(), 2 * LEAST_CHANCE))
        # What is seen well somewhere would be everywhere, or it is another curve that goes on from there.
        best = int(uniform_filter1d(here.mean(axis=0), WELL, mode="nearest").argmax())
        well = here[:, max(0, best - WELL // 2) : best + WELL // 2 + 1]
        score = point_scores(here, _rate(well, p, chance), chance)
        for part in kept_stretches(score, ring, least, GAP):
            if len(part) >= SHORTEST:
                out.append((curve[part], ring and len(part) == len(curve), mine, score[part].sum()))
    return _chosen(out, chosen.sets.shape[1])
