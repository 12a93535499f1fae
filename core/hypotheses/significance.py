# SPDX-License-Identifier: GPL-3.0-or-later
"""How many things as good as one a scene without recurrence would give (E-value; Karlin and Altschul 1990).

Growth chooses its points by the score, which therefore says nothing. What tells is everything else about the poses: all
samples near the thing, moved from one pose to the next, chosen or not, against decoys of that motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.decoys import OTHERS, SHIFTS, decoys, slipped
from ..evidence.field import Field, Probe
from ..evidence.lines import lines_once
from ..evidence.odds import LEAST_CHANCE, UNIT, between, log_odds, sliding
from ..geometry.motions import inverse
from ..transformations.description import description_length
from .extent import spread
from .hypothesis import SPACING, Hypothesis, beside
from .symmetry import replace_frame

ABOUT = 8.0
"""Edge lengths about the points within which samples tell."""

NOISE = (0.5, 0.5), (0.7, 0.7), (0.9, 0.9)
"""What a scene may be like: the share of a thing that an occurrence shows, and the share of what is about it that is
its own. The likeliest is taken."""

SELECTED = 7.3
"""Log odds that a pose must exceed to tell anything: it was the best of 1500 that were looked at, and the poses of a
false thing are many, each a little better than chance."""

EXPECTED = 1.0
"""Log odds that a pose of an orbit must exceed, which was expected where it is."""

BLOCK, SURE, LIKELY = 12, 2.0, 1.0
"""Samples of a curve that lead together, and standard errors by which poses must lead their decoys, which were not
aligned: all poses of a thing together, and each alone."""

CHOSEN = 50.0
"""Edge lengths of the best fragment that count nothing: a match of l0 was chosen there, and chance hits run on for up
to as much again. A longer fragment that recurs, such as one closed outline, is evidence of its own."""

RATE, SCALE = 0.5, 8.0
"""Things per scene without recurrence whose evidence is above 0, and the scale of its exponential tail, nats; fitted on
scenes without recurrence (see benchmarks)."""


def expected_by_chance(field: Field, thing: Hypothesis) -> float:
    """The E-value of a thing."""
    return float(RATE * np.exp(-min(independent_evidence(field, thing), 600.0) / SCALE))


def independent_evidence(field: Field, thing: Hypothesis) -> float:
    """Log odds of the poses but the first, without what was chosen: the fragment of each that may have made the seed,
    and the best of many poses. A pose that an orbit predicts was not chosen; of an orbit its numbers were."""
    if len(thing) < 2:
        return 0.0
    e = pose_evidence(field, thing)
    lead = e.worth(slice(1, None), SURE)
    free = min(e.total[1:].sum() - e.chosen[1:].sum(), lead) - SELECTED * (len(thing) - 1)
    orbit = thing.orbit
    if orbit.kind != "single":
        said = description_length(orbit, len(thing), pose=SELECTED) - SELECTED
        chosen = np.sort(e.chosen)[::-1][: int(round((said + SELECTED) / SELECTED))]
        free = max(free, min(e.total.sum() - e.total[0] - chosen.sum(), lead) - said)
    return max(0.0, float(free))


def evident(field: Field, thing: Hypothesis) -> Hypothesis:
    """The thing with the poses that the other poses speak for: that it is real does not say that each pose is."""
    if len(thing) < 2:
        return thing
    e = pose_evidence(field, thing)
    worth = e.of_each()
    orbit = thing.orbit
    predicted = orbit.fits & (orbit.kind != "single")
    kept = np.flatnonzero(worth > np.where(predicted, EXPECTED, SELECTED))
    if not len(kept):
        return thing.at(np.zeros(1, int))
    return thing if len(kept) == len(thing) else thing.at(kept)


@dataclass(frozen=True)
class PoseEvidence:
    """What the others say of each pose of a thing.

    total : (k,) float64, log odds of each pose; chosen : (k,), those of its best fragment, which may have made the seed
    over : (k, d), by how much each beats its decoys; square : (k, d), the square of the error of that
    """

    total: np.ndarray
    chosen: np.ndarray
    over: np.ndarray
    square: np.ndarray

    def worth(self, poses, sure):
        """Twice the lead of some poses together over their decoys, less some standard errors."""
        return 2 * float((self.over[poses].sum(axis=0) - sure * np.sqrt(self.square[poses].sum(axis=0))).min())

    def of_each(self):
        """(k,) float64, what each pose is worth for itself."""
        return np.array([min(self.total[k], self.worth(slice(k, k + 1), LIKELY)) for k in range(len(self.total))])


def pose_evidence(field: Field, thing: Hypothesis) -> PoseEvidence:
    """Evidence for each pose of a thing, with the share that its occurrences show estimated.

    Notes
    -----
    All samples within `ABOUT` of the thing at any pose tell, whether growth chose them or not. How often a point is
    shown is counted at the other poses only, so that no pose speaks for itself.
    """
    about = _About.of(field, thing)
    tested = about.tested(field, thing.poses, beside(thing.centres()), np.ones(len(thing), int))
    return max((_evidence(tested, *noise) for noise in NOISE), key=lambda e: e.total.sum())


def evidence_for(field: Field, thing: Hypothesis, poses) -> PoseEvidence:
    """Evidence for other poses (k, 4, 4), each for itself, by what the poses of a thing show."""
    about = _About.of(field, thing)
    own = about.tested(field, thing.poses, beside(thing.centres()), np.ones(len(thing), int))
    noise = max(NOISE, key=lambda noise: _evidence(own, *noise).total.sum())
    gap = np.linalg.norm(thing.centres(poses)[:, None] - thing.centres()[None], axis=2)
    return _evidence(about.tested(field, poses, gap.argmin(axis=1), np.zeros(len(poses), int)), *noise)


@dataclass(frozen=True)
class _About:
    """Points about a thing. near : (k, m) int32, samples that show them at its poses; weight : (m,), how much each
    tells; block : (m,) int64, the block of curve that each stands in"""

    poses: np.ndarray
    points: Probe
    block: np.ndarray
    near: np.ndarray
    weight: np.ndarray

    @classmethod
    def of(cls, field, thing):
        """The points about a thing at all its poses."""
        points, block = _overlay(field, thing)
        near = field.targets(thing.poses, points)
        weight = lines_once(points.points, points.tangents, (near >= 0).sum(axis=0) > 1) * (SPACING / UNIT)
        return cls(thing.poses, points, block, near, weight)

    def tested(self, field, poses, beside, own):
        """Poses (k, 4, 4) with what is near each (list); beside : (k,), pose of the thing from which what slides counts
        nothing; own : (k,), 1 where it is a pose of the thing itself, by which no point is counted."""
        near = self.near if own.all() else field.targets(poses, self.points)
        others = (self.near >= 0).sum(axis=0) - own[:, None] * (near >= 0)
        base = self.poses[beside]
        tells = (others > 0) & ~sliding(field, between(poses, base), self.points.moved(base))
        return [
            _Tested(
                field, pose, self.points.take(t), self.block[t], self.weight[t], near[k, t], others[k, t],
                len(self.poses) - own[k],
            )
            for k, (pose, t) in enumerate(zip(poses, tells))
        ]  # fmt: skip


def _evidence(tested, shown, belongs):
    return PoseEvidence(*(np.array(x) for x in zip(*(t.evidence(shown, belongs) for t in tested))))


def _overlay(field, thing):
    """Points about SPACING apart in the frame of the thing, of all samples near it at any pose, as a probe; and the
    block of curve (m,) that each stands in."""
    n = field.network
    parts, samples = [], []
    for pose in thing.poses:
        at = thing.points @ pose[:3, :3].T + pose[:3, 3]
        near = np.flatnonzero(np.isfinite(cKDTree(at).query(field.points, distance_upper_bound=ABOUT)[0]))
        parts.append(replace_frame(field.probe(near), inverse(pose)))
        samples.append(near)
    columns = zip(*((p.points, p.tangents, p.normals, p.kind) for p in parts))
    points, tangents, normals, kind = (None if x[0] is None else np.concatenate(x) for x in columns)
    pose = np.repeat(np.arange(len(parts)), [len(s) for s in samples])
    samples = np.concatenate(samples)
    at = samples - n.offsets[n.curve_of[samples]]
    _, block = np.unique(np.stack([pose, n.curve_of[samples], at // BLOCK]), axis=1, return_inverse=True)
    # Samples are one edge apart: a little less than SPACING takes every other one.
    chosen = spread(points, np.zeros(len(points)), 0.95 * SPACING)
    return Probe(points, tangents, normals, kind).take(chosen), block.ravel()[chosen]


class _Tested:
    """A pose and what is near it: which points it shows, and which its decoys do."""

    def __init__(self, field, pose, points, block, weight, near, shown, others):
        self.field, self.pose, self.points = field, pose, points
        self.weight, self.near, self.shown, self.others = weight, near, shown, others
        _, self.block = np.unique(block, return_inverse=True)
        self.q = np.zeros(0)
        if len(points):
            wrong = decoys(pose[None], points.points.mean(axis=0), points.tangents)[0]
            self.missed = field.targets(wrong, points) >= 0
            prior = 6.0
            q = (self.missed.sum(axis=0) + prior * max(self.missed.mean(), LEAST_CHANCE)) / (len(wrong) + prior)
            self.q = np.clip(q, 0.02, NOISE[0][0] - 0.05)

    def evidence(self, shown, belongs):
        """Log odds, those of the best fragment, the lead over each decoy (d,) and the square of its error (d,).

        shown : share of a thing that an occurrence shows; belongs : share of the points that are the thing's
        """
        q, weight = self.q, self.weight
        if not len(q):
            return 0.0, 0.0, np.zeros(SHIFTS + OTHERS + 2), np.zeros(SHIFTS + OTHERS + 2)
        # A point is the thing's or not; the occurrence that it was taken from says nothing of that.
        odds = np.log(belongs / (1 - belongs)) + (self.shown - 1) * np.log(shown / q)
        odds += (self.others - self.shown) * np.log((1 - shown) / (1 - q))
        p = q + (shown - q) / (1 + np.exp(-np.clip(odds, -50, 50)))
        terms = log_odds(np.concatenate([self.near[None] >= 0, self.missed]), p, q) * weight
        # What speaks for the pose may slip along itself, whatever is around it.
        slips = slipped(self.pose[None], self.points.points, self.points.tangents, np.maximum(terms[:1], 0))[0]
        terms = np.concatenate([terms, log_odds(self.field.targets(slips, self.points) >= 0, p, q) * weight])
        leads = np.array([np.bincount(self.block, terms[0] - x) for x in terms[1:]])
        hit = self.near >= 0
        own = np.bincount(self.field.network.curve_of[self.near[hit]], terms[0][hit], minlength=1)
        chosen = min(max(own.max(), 0.0), CHOSEN / UNIT * np.log(shown / LEAST_CHANCE))
        return terms[0].sum(), chosen, leads.sum(axis=1), (leads**2).sum(axis=1)
