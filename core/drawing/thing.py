# SPDX-License-Identifier: GPL-3.0-or-later
"""The drawing of one thing: overlay, consensus, choice by evidence, fit; and again over what is left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..network.network import CurveNetwork
from .choosing import Chosen, choose, connected, halves_of, merged, trimmed
from .consensus import candidate_curves
from .continuing import closed_up, continued, drawn_once, explained_items, free_runs
from .evidence import LEAST_SHOWN, MOST_SHOWN, chances, seen_by, sightings
from .fitting import fitted_curves, own_evidence, refined_poses
from .overlay import gather
from .sliding import Ways, relative_motions

LENIENT = 0.4
"""Tolerance: share of chance up to which candidates are proposed in what is left; evidence decides about them."""

SINGLE, ANOTHER = 150, 1.4
"""Bound on the work: curves of single poses that are looked at; and poses that must show one, its own included."""

PREDICTED = 2.3
"""Nats that speak for a pose that an orbit predicts: at one cell of ten the thing is not there."""

CORE = 4.0
"""Tolerance: edge lengths from the core within which a candidate tells how much a pose shows."""


@dataclass(frozen=True)
class Drawing:
    """Clean curves of a thing and its poses. chosen : curves and the poses of each; poses : (k, 4, 4) float64;
    kept : (k,) int64, the given poses that are left."""

    chosen: Chosen
    poses: np.ndarray
    kept: np.ndarray


class Drawer:
    """What the steps of a drawing share: the network, the free samples and the parameters."""

    def __init__(self, network: CurveNetwork, free, parameters, tick=None):
        self.network, self.free, self.tick = network, free, tick or (lambda: None)
        self.epsilon, self.radius = parameters.epsilon, 1.25 * parameters.epsilon
        self.margin, self.join = parameters.thing_margin, parameters.thing_gap
        self.least = -np.log(parameters.significance)
        self.how = {"least": self.least, "join": self.join, "radius": self.radius}

    def draw(self, points, poses, predicted=None, rounds=2, passes=2) -> Drawing | None:
        """The curves of a thing, given points (m, 3) of it and poses (k, 4, 4); None where nothing is left of it.

        predicted : (k,) bool, poses that an orbit predicts; None for none
        """
        predicted = np.zeros(len(poses), bool) if predicted is None else predicted
        region, kept = points, np.arange(len(poses))
        poses = poses.copy()
        chosen = None
        for _ in range(rounds):
            chosen = self._chosen(region, points, poses)
            if not chosen.curves:
                return None
            poses = refined_poses(
                self.network, chosen.curves, poses, self.free, radius=2 * self.epsilon, sets=chosen.sets
            )
            chosen, good = self._paying(chosen, poses, predicted[kept])
            kept, poses = kept[good], poses[good]
            if not chosen.curves or len(poses) < 2:
                return None
            region = np.concatenate(chosen.curves)
        chosen, poses = self._fitted(chosen, poses)
        for _ in range(passes):
            more = self._rest(chosen, poses, self._agreed)
            if not more.curves:
                break
            chosen = merged(chosen, more)
        more = self._rest(chosen, poses, self._single)
        if more.curves:
            chosen, poses = self._fitted(merged(chosen, more), poses)
        overlay = self._around(chosen, poses)
        chosen = continued(chosen, sightings(chosen.curves, overlay, radius=self.radius), overlay)
        ways = Ways(self.network, poses, self.radius)
        chosen = chosen.part([i for i, c in enumerate(chosen.curves) if not ways.slides(c)])
        if not chosen.curves:
            return None
        chosen = closed_up(self._trimmed(chosen, poses))
        if not chosen.curves:
            return None
        chosen = drawn_once(chosen, poses, self._shares(chosen, poses))
        return Drawing(*self._fitted(chosen, poses), kept)

    def _around(self, chosen: Chosen, poses):
        """Overlay of all that lies around the curves."""
        return gather(self.network, poses, np.concatenate(chosen.curves), self.free, self.margin)

    def _trimmed(self, chosen: Chosen, poses) -> Chosen:
        """The curves without stretches that their poses surely do not show."""
        overlay = self._around(chosen, poses)
        found = sightings(chosen.curves, overlay, radius=self.radius)
        p = self._typical(chosen, found, overlay)
        q = np.minimum(chances(chosen.curves, overlay, radius=self.radius), 0.9 * p)
        return trimmed(chosen, seen_by(found, overlay), found.offsets, p, q, self.least)

    def _shares(self, chosen: Chosen, poses):
        """(k, c) float64, share of each curve that each pose shows."""
        overlay = self._around(chosen, poses)
        found = sightings(chosen.curves, overlay, radius=self.radius)
        seen = np.add.reduceat(seen_by(found, overlay), found.offsets[:-1], axis=1, dtype=float)
        return seen / np.diff(found.offsets)

    def _chosen(self, region, core, poses) -> Chosen:
        overlay = gather(self.network, poses, region, self.free, self.margin)
        self.tick()
        curves, closed = candidate_curves(overlay, epsilon=self.epsilon, tick=self.tick)
        motions = relative_motions(poses, core)
        curves, closed = self._staying(curves, closed, poses)
        if not curves:
            return Chosen([], [], np.zeros((0, len(poses)), bool), np.zeros(0))
        p = self._shown(curves, overlay, core)
        how = {"p": p, "motions": motions, "halves": halves_of(poses, core), **self.how}
        return connected(choose(curves, closed, overlay, core, **how), core, self.join)

    def _staying(self, curves, closed, poses):
        """The curves that do not run on from pose to pose."""
        ways = Ways(self.network, poses, self.radius)
        stays = [not ways.slides(c) for c in curves]
        return [c for c, s in zip(curves, stays) if s], [c for c, s in zip(closed, stays) if s]

    def _shown(self, curves, overlay, core):
        """Share of the curves at the core that a pose shows."""
        tree = cKDTree(core)
        mine = [c for c in curves if np.median(tree.query(c)[0]) < CORE] or curves
        seen = seen_by(sightings(mine, overlay, radius=self.radius), overlay)
        return float(np.clip(seen.mean(), LEAST_SHOWN, MOST_SHOWN))

    def _paying(self, chosen: Chosen, poses, predicted):
        """The curves at the poses that show enough of their own, and which poses (k,) bool these are."""
        overlay = self._around(chosen, poses)
        found = sightings(chosen.curves, overlay, radius=self.radius)
        p = self._typical(chosen, found, overlay)
        q = np.minimum(chances(chosen.curves, overlay, radius=self.radius), 0.9 * p)
        # The more of the thing a pose lacks, the more must what it has speak for it.
        size = np.diff(found.offsets)
        price = self.least * (1 - 1.5 * (size @ chosen.sets) / size.sum()) - PREDICTED * predicted
        good = own_evidence(found, overlay, chosen.sets, p, q, predicted) > price
        sets = chosen.sets[:, good]
        use = np.flatnonzero(sets.sum(axis=1) >= 2)
        return Chosen(chosen.curves, chosen.closed, sets, chosen.scores).part(use), good

    def _fitted(self, chosen: Chosen, poses, rounds=2):
        """Curves and poses fitted to the samples in turn."""
        for _ in range(rounds):
            poses = refined_poses(self.network, chosen.curves, poses, self.free, radius=self.radius, sets=chosen.sets)
            overlay = gather(self.network, poses, np.concatenate(chosen.curves), self.free, 2 * self.radius)
            curves = fitted_curves(
                chosen.curves, chosen.closed, chosen.sets, overlay, radius=self.radius, tick=self.tick
            )
            chosen = Chosen(curves, chosen.closed, chosen.sets, chosen.scores)
        return chosen, poses

    def _agreed(self, overlay):
        """Candidates where the poses agree."""
        return candidate_curves(overlay, epsilon=self.epsilon, chance=LENIENT, tick=self.tick)

    def _single(self, overlay):
        """Candidates as single poses show them, those that others show best; where holes leave little to agree on."""
        runs = free_runs(overlay, np.ones(len(overlay.points), bool))
        if not runs:
            return [], []
        found = sightings(runs, overlay, radius=self.radius)
        seen = seen_by(found, overlay)
        poses = np.add.reduceat(seen, found.offsets[:-1], axis=1, dtype=float).sum(axis=0) / np.diff(found.offsets)
        best = np.argsort(-poses, kind="stable")[:SINGLE]
        return [runs[c] for c in best if poses[c] > ANOTHER], [False] * int((poses[best] > ANOTHER).sum())

    def _rest(self, chosen: Chosen, poses, candidates) -> Chosen:
        """Of the candidates in what the chosen curves leave, those that the evidence is for."""
        drawn = np.concatenate(chosen.curves)
        around = self._around(chosen, poses)
        found = sightings(chosen.curves, around, radius=self.radius)
        overlay = around.part(~explained_items(chosen, found, around))
        nothing = Chosen([], [], np.zeros((0, len(poses)), bool), np.zeros(0))
        if not len(overlay.points):
            return nothing
        curves, closed = candidates(overlay)
        motions = relative_motions(poses, drawn)
        curves, closed = self._staying(curves, closed, poses)
        if not curves:
            return nothing
        p = self._typical(chosen, found, around)
        how = {"p": p, "motions": motions, "halves": halves_of(poses, drawn), **self.how}
        more = choose(curves, closed, overlay, drawn, sets=list(np.unique(chosen.sets, axis=0)), **how)
        return connected(more, drawn, self.join)

    def _typical(self, chosen: Chosen, found, overlay):
        """Share of the curves that their poses show."""
        has = np.repeat(chosen.sets.T, np.diff(found.offsets), axis=1)
        return float(np.clip(seen_by(found, overlay)[has].mean(), LEAST_SHOWN, MOST_SHOWN))
