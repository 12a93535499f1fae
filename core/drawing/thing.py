# SPDX-License-Identifier: GPL-3.0-or-later
"""The drawing of one thing: overlay, consensus, choice by evidence, fit; and again over what is left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..network.network import CurveNetwork
from .choosing import Chosen, choose, connected, merged
from .consensus import candidate_curves
from .evidence import chances, seen_by, sightings
from .fitting import fitted_curves, own_evidence, refined_poses
from .overlay import gather
from .sliding import relative_motions, slides

CORE = 4.0
"""Tolerance: edge lengths from the core within which a candidate tells how much a pose shows."""

LEAST_SHOWN, MOST_SHOWN = 0.35, 0.9
"""Bounds of the share of a curve that a pose shows."""


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
        self.margin, self.join = parameters.margin, parameters.join
        self.least = -np.log(parameters.significance)

    def draw(self, points, poses, rounds=2, passes=2) -> Drawing | None:
        """The curves of a thing, given points (m, 3) of it and poses (k, 4, 4); None where nothing is left of it."""
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
            chosen, good = self._paying(chosen, poses)
            kept, poses = kept[good], poses[good]
            if not chosen.curves or len(poses) < 2:
                return None
            region = np.concatenate(chosen.curves)
        chosen, poses = self._fitted(chosen, poses)
        for _ in range(passes):
            more = self._rest(chosen, poses)
            if not more.curves:
                break
            chosen = merged(chosen, more)
        chosen, poses = self._fitted(chosen, poses)
        return Drawing(chosen, poses, kept)

    def _chosen(self, region, core, poses) -> Chosen:
        overlay = gather(self.network, poses, region, self.free, self.margin)
        self.tick()
        curves, closed = candidate_curves(overlay, epsilon=self.epsilon, tick=self.tick)
        curves, closed = self._staying(curves, closed, poses, core)
        if not curves:
            return Chosen([], [], np.zeros((0, len(poses)), bool), np.zeros(0))
        p = self._shown(curves, overlay, core)
        chosen = choose(curves, closed, overlay, core, p=p, least=self.least, radius=self.radius)
        return connected(chosen, core, self.join)

    def _staying(self, curves, closed, poses, core):
        """The curves that do not slide along themselves."""
        stays = ~slides(curves, relative_motions(poses, core), radius=self.radius)
        return [c for c, s in zip(curves, stays) if s], [c for c, s in zip(closed, stays) if s]

    def _shown(self, curves, overlay, core):
        """Share of the curves at the core that a pose shows."""
        tree = cKDTree(core)
        mine = [c for c in curves if np.median(tree.query(c)[0]) < CORE] or curves
        seen = seen_by(sightings(mine, overlay, radius=self.radius), overlay)
        return float(np.clip(seen.mean(), LEAST_SHOWN, MOST_SHOWN))

    def _paying(self, chosen: Chosen, poses):
        """The curves at the poses that show enough of their own, and which poses (k,) bool these are."""
        overlay = gather(self.network, poses, np.concatenate(chosen.curves), self.free, self.margin)
        found = sightings(chosen.curves, overlay, radius=self.radius)
        seen = seen_by(found, overlay)
        has = np.repeat(chosen.sets.T, np.diff(found.offsets), axis=1)
        p = float(np.clip(seen[has].mean(), LEAST_SHOWN, MOST_SHOWN))
        q = np.minimum(chances(chosen.curves, overlay, radius=self.radius), 0.9 * p)
        good = own_evidence(found, overlay, chosen.curves, chosen.sets, p, q) > self.least
        sets = chosen.sets[:, good]
        use = np.flatnonzero(sets.sum(axis=1) >= 2)
        return Chosen(chosen.curves, chosen.closed, sets, chosen.scores).part(use), good

    def _fitted(self, chosen: Chosen, poses, rounds=2):
        """Curves and poses fitted to the samples in turn."""
        for _ in range(rounds):
            poses = refined_poses(
                self.network, chosen.curves, poses, self.free, radius=self.radius, sets=chosen.sets
            )
            overlay = gather(self.network, poses, np.concatenate(chosen.curves), self.free, 2 * self.radius)
            curves = fitted_curves(
                chosen.curves, chosen.closed, chosen.sets, overlay, radius=self.radius, tick=self.tick
            )
            chosen = Chosen(curves, chosen.closed, chosen.sets, chosen.scores)
        return chosen, poses

    def _rest(self, chosen: Chosen, poses) -> Chosen:
        """Curves that the poses agree on in what the chosen ones leave."""
        drawn = np.concatenate(chosen.curves)
        overlay = gather(self.network, poses, drawn, self.free, self.margin)
        found = sightings(chosen.curves, overlay, radius=self.radius)
        curve = np.repeat(np.arange(len(chosen.curves)), np.diff(found.offsets))
        at = chosen.sets[curve[found.point], overlay.cell[found.item]]
        explained = np.zeros(len(self.free), bool)
        explained[overlay.sample[found.item[at]]] = True
        free = self.free & ~explained
        nothing = Chosen([], [], np.zeros((0, len(poses)), bool), np.zeros(0))
        overlay = gather(self.network, poses, drawn, free, self.margin)
        if not len(overlay.points):
            return nothing
        curves, closed = candidate_curves(overlay, epsilon=self.epsilon, tick=self.tick)
        curves, closed = self._staying(curves, closed, poses, drawn)
        if not curves:
            return nothing
        seen = seen_by(found, gather(self.network, poses, drawn, self.free, self.margin))
        has = np.repeat(chosen.sets.T, np.diff(found.offsets), axis=1)
        p = float(np.clip(seen[has].mean(), LEAST_SHOWN, MOST_SHOWN))
        sets = [s for s in np.unique(chosen.sets, axis=0)]
        more = choose(curves, closed, overlay, drawn, p=p, least=self.least, radius=self.radius, sets=sets)
        return connected(more, drawn, self.join)
