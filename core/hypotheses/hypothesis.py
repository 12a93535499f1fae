# SPDX-License-Identifier: GPL-3.0-or-later
"""A thing: points of curves in a frame of their own, and the poses at which the network shows them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..evidence.field import Field, Probe
from ..evidence.odds import UNIT, between, log_odds, sliding
from ..geometry.motions import inverse
from ..transformations.description import describe

SPACING = 2.0
"""Edge lengths from one point of a thing to the next (count that bounds the work)."""

SHARES = 0.45, 0.6, 0.75, 0.9
"""Shares of a thing that an occurrence may show: what was seen on damaged scenes, from many holes to next to none."""

CERTAIN = 0.99
"""Chance from which on a point tells nothing (numerical)."""


@dataclass(frozen=True)
class Hypothesis:
    """What may recur, and where.

    probe : its points (m, 3) and their directions, in a frame of its own, about SPACING apart
    chance : (m,) float64, how often a decoy hits near each point
    poses : (k, 4, 4) float64, frame to network; the first defines the thing
    scores : (k,) float64, log odds of each pose on samples that no earlier pose explains; cost : (k,), what each must
        exceed
    shown : float, the share of the thing that an occurrence shows
    expected : float, how many things as good a scene without recurrence would give (E-value)
    """

    probe: Probe
    chance: np.ndarray
    poses: np.ndarray
    scores: np.ndarray
    cost: np.ndarray
    shown: float = 0.5
    expected: float = np.inf

    def __len__(self):
        return len(self.poses)

    @property
    def points(self):
        """(m, 3) float64, the points in the frame."""
        return self.probe.points

    @property
    def tangents(self):
        """(m, 3) float64, unit."""
        return self.probe.tangents

    @property
    def gain(self) -> float:
        """Log odds of all poses but the first, less what they cost."""
        return float(self.scores[1:].sum() - self.cost[1:].sum())

    def at(self, which) -> Hypothesis:
        """The hypothesis with some of its poses."""
        return replace(self, poses=self.poses[which], scores=self.scores[which], cost=self.cost[which])

    def centres(self, poses=None):
        """(k, 3) float64, where the middle of the thing is at each pose."""
        poses = self.poses if poses is None else poses
        return poses[:, :3, :3] @ self.points.mean(axis=0) + poses[:, :3, 3]

    def differences(self, poses, others):
        """(k, l) float64, RMS distance on the thing between poses (k, 4, 4) and others (l, 4, 4)."""
        a, b = self.embedded(poses), self.embedded(others)
        return np.sqrt(np.maximum((a**2).sum(1)[:, None] + (b**2).sum(1)[None] - 2 * a @ b.T, 0))

    def embedded(self, poses):
        """(k, 12) float64, vectors whose distances are the RMS distances of the poses on the thing."""
        centre, axes = self._extent
        turned = poses[:, :3, :3] @ axes
        return np.concatenate([turned.reshape(-1, 9), poses[:, :3, :3] @ centre + poses[:, :3, 3]], axis=1)

    @cached_property
    def orbit(self):
        """Orbit, the cheapest description of the poses."""
        return describe(self)

    @cached_property
    def _extent(self):
        """Middle (3,) of the points, and their main axes (3, 3) as columns, as long as their standard deviations."""
        centre = self.points.mean(axis=0)
        off = self.points - centre
        values, axes = np.linalg.eigh(off.T @ off / len(off))
        return centre, axes * np.sqrt(np.maximum(values, 0))


def pose_scores(field: Field, thing: Hypothesis, poses, owned, *, beside=None):
    """Log odds (k,) of poses (k, 4, 4), their terms (k, m), and targets (k, m) int32.

    Parameters
    ----------
    owned : (n,) bool, samples that are explained already: they count nothing
    beside : (j, 4, 4), poses that are known; what slides from the nearest of them counts nothing

    Notes
    -----
    How much an occurrence shows differs from one to the next, and those that were found first show the most. So each
    is asked with several shares, and the one that it fits best is taken, at the price of the choice.
    """
    near = field.targets(poses, thing.probe)
    hit = near >= 0
    tells = ~(hit & owned[near]) & (thing.chance < CERTAIN)
    if beside is not None and len(beside):
        base = beside[
            np.linalg.norm(thing.centres(poses)[:, None] - thing.centres(beside)[None], axis=2).argmin(axis=1)
        ]
        tells &= ~sliding(field, between(poses, base), thing.probe.moved(base))
    odds = np.array([[log_odds(h, p, np.minimum(thing.chance, p - 0.05)) for h in (False, True)] for p in SHARES])
    odds *= SPACING / UNIT
    missed = tells & ~hit
    total = missed.astype(float) @ odds[:, 0].T + (tells & hit).astype(float) @ odds[:, 1].T
    best = total.argmax(axis=1)
    terms = np.where(hit, odds[best, 1], odds[best, 0]) * tells
    return terms.sum(axis=1) - np.log(len(SHARES)), terms, near


def beside(centres):
    """(k,) int64, of each of the centres (k, 3) of poses the nearest other one, which may be at the same place."""
    gap = np.linalg.norm(centres[:, None] - centres[None], axis=2)
    np.fill_diagonal(gap, np.inf)
    return gap.argmin(axis=1)


def explained(field: Field, thing: Hypothesis, poses=None):
    """(n,) bool, samples that show the thing at its poses, and those beside them."""
    near = field.targets(thing.poses if poses is None else poses, thing.probe)
    flags = np.zeros(len(field), bool)
    flags[near[near >= 0]] = True
    return field.widened(flags)


def distinct(thing: Hypothesis, poses, key, *, gap):
    """Indices of poses (k, 4, 4), the greatest key first, none within `gap` edge lengths (RMS) of an earlier one."""
    order = np.argsort(-key, kind="stable")
    vectors = thing.embedded(poses)[order]
    alive = np.ones(len(order), bool)
    kept = []
    for i in range(len(order)):
        if alive[i]:
            kept.append(order[i])
            alive[i:] &= ((vectors[i:] - vectors[i]) ** 2).sum(axis=1) >= gap * gap
    return np.array(kept, np.int64)


def relative(poses):
    """(k * k, 4, 4), motions of the frame from each pose to each, and of the network."""
    return (inverse(poses)[:, None] @ poses[None]).reshape(-1, 4, 4)
