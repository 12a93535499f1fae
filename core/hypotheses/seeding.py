# SPDX-License-Identifier: GPL-3.0-or-later
"""Seeds: matches of Feature BLAST, each refined on its own neighbourhood, and what tells for each.

No pair is ranked away by the whole scene: a match is asked on the curves around it alone. A seed is evidence for
growth, not a decision.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align
from ..evidence.decoys import SHIFTS, decoys, slipped
from ..evidence.field import Field
from ..evidence.odds import LEAST_CHANCE, UNIT, log_odds, sliding
from ..geometry.motions import inverse

POINTS = 64
"""Points that stand for the neighbourhood of a seed; count that bounds the work."""

STRETCH = 9
"""Samples that stand for a stretch, its middle among them; count that bounds the work."""

EVERY = 6
"""Samples of a curve from one place of seeds to the next (count that bounds the work)."""


@dataclass(frozen=True)
class Seeds:
    """Motions that may recur, each known about one place. Both directions of a match are seeds.

    motions : (k, 4, 4); source, target : (k,) int64, samples at the middle of the two stretches
    stretch : (k, STRETCH) int64, samples along the stretch that is moved
    score : (k,) float64, log odds of the best region about the source; extent : (k,) float64, how far it reaches
    """

    motions: np.ndarray
    source: np.ndarray
    target: np.ndarray
    stretch: np.ndarray
    score: np.ndarray
    extent: np.ndarray

    def __len__(self):
        return len(self.source)

    def take(self, which) -> Seeds:
        return Seeds(*(getattr(self, f.name)[which] for f in fields(self)))


class Places:
    """Every sixth sample of each curve, with points that stand for the balls around it."""

    def __init__(self, field: Field, radii):
        n = field.network
        at = np.arange(len(field)) - n.offsets[:-1][n.curve_of]
        self.sample = np.flatnonzero(
            (at % EVERY == EVERY // 2) | ((at == 0) & (np.diff(n.offsets)[n.curve_of] <= EVERY // 2))
        )
        self.of = cKDTree(field.points[self.sample]).query(field.points)[1]
        self.radii = radii
        self._balls = {}
        self.field = field

    def __len__(self):
        return len(self.sample)

    def balls(self, places, radius):
        """(k, POINTS) int64 samples in balls about places (k,), evenly chosen, nearest first; -1 where fewer are."""
        if radius not in self._balls:
            lists = self.field.tree.query_ball_point(self.field.points[self.sample], radius)
            table = np.full((len(lists), POINTS), -1)
            for i, found in enumerate(lists):
                found = np.array(found)
                if len(found) > POINTS:
                    found = np.sort(found)[(np.arange(POINTS) + 0.5).astype(int) * len(found) // POINTS]
                gap = ((self.field.points[found] - self.field.points[self.sample[i]]) ** 2).sum(axis=1)
                table[i, : len(found)] = found[np.argsort(gap, kind="stable")]
            self._balls[radius] = table
        return self._balls[radius][places]


def find_seeds(field: Field, matches, *, epsilon, tick=lambda: None):
    """Seeds of matches (list of Matches), best first, and the number of matches that the budget left out.

    Each place has a budget of its own, so that a part with very many matches, such as a comb, leaves the others theirs.
    """
    motions, source_along, target_along, weight = _stretches(field, matches)
    source, target = source_along[:, STRETCH // 2], target_along[:, STRETCH // 2]
    places = Places(field, (25.0, 50.0))
    order = np.argsort(-weight, kind="stable")
    # Equal votes once: the same motion at the same place.
    order = order[_first_of_each(field, motions[order], source[order], places)]
    kept = order[best_of_places(places, source[order], target[order], budget(REFINED, len(places)))]
    left_out = len(order) - len(kept)
    motions, source, target = motions[kept], source[kept], target[kept]
    source_along, target_along = source_along[kept], target_along[kept]
    tick()
    motions = _refined(field, motions, source, places, 12.0, (3 * epsilon, 1.75 * epsilon, epsilon))
    tick()
    motions = _refined(field, motions, source, places, 25.0, (1.75 * epsilon, epsilon))
    raw = _raw_score(field, motions, source, places)
    order = np.argsort(-raw, kind="stable")
    order = order[_first_of_each(field, motions[order], source[order], places)]
    order = order[best_of_places(places, source[order], target[order], budget(SCORED, len(places)))]
    motions, source, target = motions[order], source[order], target[order]
    stretch = np.concatenate([source_along[order], target_along[order]])
    tick()
    motions, source, target = np.concatenate([motions, inverse(motions)]), np.r_[source, target], np.r_[target, source]
    score, extent = seed_scores(field, motions, source, places, places.radii)
    half = len(order)
    order = np.argsort(-(score[:half] + score[half:]), kind="stable")
    both = np.stack([order, order + half], axis=1).ravel()
    return Seeds(motions, source, target, stretch, score, extent).take(both), left_out


REFINED, SCORED = (12_000, 4), (3_000, 2)
"""Matches that are refined, and seeds that are scored: in all, and at least at each place; counts bounding the work."""


def budget(bound, places):
    return max(bound[1], bound[0] // max(places, 1))


def best_of_places(places, source, target, most):
    """Indices of motions, best first, of which either end is among the first `most` of its place."""
    keep = np.zeros(len(source), bool)
    for end in (source, target):
        at = places.of[end]
        order = np.argsort(at, kind="stable")
        first = np.r_[True, np.diff(at[order]) != 0]
        rank = np.arange(len(at)) - np.maximum.accumulate(np.where(first, np.arange(len(at)), 0))
        keep[order[rank < most]] = True
    return np.flatnonzero(keep)


def _stretches(field, matches):
    """Motions, samples along both stretches (k, STRETCH) and weights of all matches, one after the other."""
    n = field.network
    out = []
    for m in matches:
        step = np.round(np.linspace(0, 1, STRETCH) * (m.count - 1)[:, None]).astype(np.int64)
        sides = []
        for side, direction in ((0, 1), (1, m.direction)):
            at = m.start[:, side, None] + np.reshape(direction, (-1, 1)) * step
            size = np.diff(n.offsets)[m.curve[:, side]][:, None]
            at = np.where(n.closed[m.curve[:, side]][:, None], at % size, np.clip(at, 0, size - 1))
            sides.append(n.offsets[m.curve[:, side]][:, None] + at)
        out.append((m.motions, *sides, m.affinity * (0.05 + m.stiffness)))
    return tuple(np.concatenate(x) for x in zip(*out))


def _first_of_each(field, motions, source, places, *, shift=3.0, turn=0.1):
    """Indices of the first of the motions of each place that take it to the same place with the same turn."""
    at = field.points[places.sample[places.of[source]]]
    image = np.einsum("kij,kj->ki", motions[:, :3, :3], at) + motions[:, :3, 3]
    key = np.concatenate(
        [places.of[source][:, None], np.round(image / shift), np.round(motions[:, :3, :3].reshape(-1, 9) / turn)],
        axis=1,
    )
    _, first = np.unique(key, axis=0, return_index=True)
    return np.sort(first)


def _refined(field, motions, source, places, radius, radii):
    balls = places.balls(places.of[source], radius)
    probe = field.probe(np.maximum(balls, 0))
    far = np.where(balls < 0, 1e6, 0.0)[..., None]
    probe = type(probe)(probe.points + far, probe.tangents, probe.normals, probe.kind)
    return align(field, motions, probe, radii=radii)


def _raw_score(field, motions, source, places, size=1500):
    """(k,) float64, points about the source that the motions show, less what they miss."""
    out = np.zeros(len(motions))
    for i in range(0, len(motions), size):
        part = slice(i, i + size)
        balls = places.balls(places.of[source[part]], 25.0)
        probe = field.probe(np.maximum(balls, 0))
        hit = field.shown_by(probe.moved(motions[part])) >= 0
        tells = (balls >= 0) & ~sliding(field, motions[part], probe)
        out[part] = (np.where(hit, 1.0, -0.4) * tells).sum(axis=1)
    return out


def seed_scores(field: Field, motions, source, places: Places, radii, *, p=0.5, size=500):
    """Log odds (k,) of the best ball about each source, and its radius (k,).

    The balls grow with the distance of their points; of all the best one counts, and of the different densities of
    points the best. A motion must also beat its own shifts.
    """
    score, extent = np.full(len(motions), -np.inf), np.zeros(len(motions))
    for radius in radii:
        for i in range(0, len(motions), size):
            part = slice(i, i + size)
            s, e = _ball_scores(
                field, motions[part], places.balls(places.of[source[part]], radius), places.of[source[part]], places, p
            )
            better = s > score[part]
            score[part], extent[part] = np.where(better, s, score[part]), np.where(better, e, extent[part])
    return score, extent


def _ball_scores(field, motions, balls, at, places, p):
    middle = field.points[places.sample[at]]
    distance = np.linalg.norm(field.points[np.maximum(balls, 0)] - middle[:, None], axis=-1)
    # Each point stands for an equal share of the curve in the ball.
    length = _length_of_points(field, balls, places, at, distance.max(axis=1, initial=0, where=balls >= 0))
    return region_scores(field, motions, balls, distance, length, middle, p)


def region_scores(field: Field, motions, samples, distance, length, middle, p=0.5, taken=None, telling=None):
    """Log odds (k,) of motions (k, 4, 4) on the best part of a region, and how far it reaches (k,).

    Parameters
    ----------
    samples : (k, m) int64, those of the region in the order in which it grows, -1 where there are fewer
    distance : (k, m), how far each is; length : (k,), edge lengths of curve that each stands for; middle : (k, 3)
    p : the share of a thing that an occurrence shows
    taken : (n,) bool, samples that tell nothing, at either end of the motion; None for none
    telling : (k, m), how much each sample tells; None for 1
    """
    probe = field.probe(np.maximum(samples, 0))
    there = samples >= 0
    shown = field.shown_by(probe.moved(motions))
    hit = shown >= 0
    if taken is not None:
        there = there & ~taken[samples] & ~(hit & taken[shown])
    wrong = decoys(motions, middle, probe.tangents)
    chance = np.stack([field.shown_by(probe.moved(wrong[:, d])) >= 0 for d in range(wrong.shape[1])])
    mean = (chance.mean(axis=0) * there).sum(axis=1) / np.maximum(there.sum(axis=1), 1)
    prior = 6.0
    q = (chance.sum(axis=0) + prior * np.maximum(mean, LEAST_CHANCE)[:, None]) / (len(chance) + prior)
    q = np.clip(q, 0.02, p - 0.05)
    tells = there & ~sliding(field, motions, probe)
    weight = tells * length[:, None] / UNIT
    if telling is not None:
        weight = weight * telling
    run = np.cumsum(log_odds(hit, p, q) * weight, axis=1)
    best = run.argmax(axis=1)
    rows = np.arange(len(motions))
    score = run[rows, best]
    beside = np.stack([np.cumsum(log_odds(c, p, q) * weight, axis=1)[rows, best] for c in chance[:SHIFTS]]).max(axis=0)
    part = there & (np.arange(samples.shape[1]) <= best[:, None])
    for slip in np.moveaxis(slipped(motions, probe.points, probe.tangents, part), 1, 0):
        c = field.shown_by(probe.moved(slip)) >= 0
        beside = np.maximum(beside, (log_odds(c, p, q) * weight * part).sum(axis=1))
    return np.minimum(score, 2 * (score - beside)), distance[rows, best]


def _length_of_points(field, balls, places, at, radius):
    """(k,) float64, edge lengths of curve that each point of a ball stands for."""
    count = (balls >= 0).sum(axis=1)
    full = count == POINTS
    out = np.ones(len(balls))
    if full.any():
        # Balls that are full were thinned; how far is known from the number of samples within them.
        inside = field.tree.query_ball_point(
            field.points[places.sample[at[full]]], np.maximum(radius[full], 1), return_length=True
        )
        out[full] = np.maximum(inside / POINTS, 1.0)
    return out
