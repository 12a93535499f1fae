# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that run on from pose to pose: a cornice, a rail, a ring about the axis.

Such a curve recurs with itself only. In one pose it is a piece of no meaning, so it is no curve of a template.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.spatial import cKDTree
from scipy.stats import binom

from ..geometry.motions import apply, exponential, inverse, screw_velocity
from ..geometry.polylines import directions, resample_polyline
from .evidence import MOST_SHOWN

NEIGHBOURS, SAME, MOVED, MOSTLY, STRAIGHT = 6, 5.0, 4.0, 0.7, 0.97
"""Tolerances: poses around each to which motions are looked at, edge lengths (RMS) within which two motions are one,
those that a motion must move a point, share of a curve that slides, and cosine of its tangent and its way."""

RUNS_ON = 0.33
"""Share of what is shown of a curve that must be shown of the way to its image for both to be one: about where the odds
of seen against chance are even."""

AROUND, STEPS, UNLIKELY = 8, 64, 0.01
"""Edge lengths of the shortest gap that tells, places on the way that are asked (a count), and how unlikely it must be
that holes leave so few at one place."""

WELL = 0.5
"""Share of what the pose that shows a curve best shows of it that another must show to be asked (tolerance)."""


def relative_motions(poses, points):
    """(m, 4, 4) float64, motions in the thing's frame from poses to their neighbours, one of each kind.

    points : (n, 3) float64, of the thing; of a motion and its inverse one is left
    """
    middle = points.mean(axis=0)
    at = apply(poses, middle[None])[:, 0]
    near = cKDTree(at).query(at, k=min(NEIGHBOURS + 1, len(at)))[1].reshape(len(at), -1)[:, 1:]
    a = np.repeat(np.arange(len(at)), near.shape[1])
    motions = inverse(poses[a]) @ poses[near.ravel()]
    motions = motions[np.linalg.det(motions[:, :3, :3]) > 0]
    size = points.std(axis=0).max()
    probe = middle + size * np.concatenate([np.eye(3), -np.eye(3)])
    out, seen = [], np.zeros((0, 6, 3))
    for g in motions:
        image = apply(g, probe)
        if len(seen) and np.sqrt(((seen - image) ** 2).sum(-1).mean(-1)).min() < SAME:
            continue
        out.append(g)
        seen = np.concatenate([seen, image[None], apply(inverse(g), probe)[None]])
    return np.array(out).reshape(-1, 4, 4)


class Ways:
    """The network and the poses of a thing, asked what lies between the images of a curve."""

    def __init__(self, network, poses, radius):
        self.network, self.poses, self.radius = network, poses, radius
        self.tree = cKDTree(network.points)

    def slides(self, curve) -> bool:
        """Whether a curve (k, 3) of the frame runs on through most of the poses that show it.

        From each pose the motion to the nearest other one is asked. A curve that lies on its own image there runs on,
        as a ring about the axis does. One that lies along the way of the motion does where the network shows the way
        between it and its image about as well as the curve itself, and nowhere is a gap that all share: a cornice, not
        a row of sills.
        """
        way = directions(curve)
        here = self._shown(apply(self.poses, curve), way @ np.swapaxes(self.poses[:, :3, :3], 1, 2))
        mine = np.flatnonzero((here > 0) & (here >= WELL * here.max()))
        if len(mine) < 2:
            return False
        at = apply(self.poses[mine], curve[len(curve) // 2][None])[:, 0]
        other = mine[cKDTree(at).query(at, k=2)[1][:, 1]]
        motions = inverse(self.poses[mine]) @ self.poses[other]
        on, along = self._kinds(curve, way, motions)
        asked = along & ~on
        runs = on.copy()
        if asked.any():
            p = min(float(here[mine][asked].mean()), MOST_SHOWN)
            runs[asked] = self._runs_on(curve, [(self.poses[a], g) for a, g in zip(mine[asked], motions[asked])], p)
        return bool(2 * runs.sum() > len(mine))

    def _kinds(self, curve, way, motions):
        """(m,) bool each, motions that take a curve onto itself, and those that take it along itself."""
        image = apply(motions, curve)
        far = np.linalg.norm(image - curve, axis=2) > MOVED
        distance, near = cKDTree(curve).query(image, distance_upper_bound=self.radius)
        found = np.isfinite(distance)
        turned = way @ np.swapaxes(motions[:, :3, :3], 1, 2)
        on = found & far & (np.abs((way[np.where(found, near, 0)] * turned).sum(-1)) > 0.9)
        velocity, proper = np.zeros_like(image), np.linalg.det(motions[:, :3, :3]) > 0
        if proper.any():
            w, u = screw_velocity(motions[proper])
            velocity[proper] = np.cross(w[:, None], curve) + u[:, None]
        speed = np.maximum(np.linalg.norm(velocity, axis=2), 1e-12)
        along = far & (np.abs((velocity * way).sum(-1)) > STRAIGHT * speed)
        return on.mean(axis=1) > MOSTLY, along.mean(axis=1) > MOSTLY

    def _runs_on(self, curve, ways, p):
        """Whether the network shows the ways (list of pose and motion) of a curve to its images, without what lies
        beside either; p : share of the curve that is shown."""
        between = np.array([self._between(curve, *way) for way in ways])
        free = np.isfinite(between)
        if not free.any():
            return True
        if np.nanmean(between) < RUNS_ON * p:
            return False
        # Holes are anywhere, ends are at one place.
        whole = free.all(axis=0)
        shown = (between[:, whole] > 0.5).sum(axis=0)
        return not (whole.any() and binom.cdf(shown, len(ways), p).min() < UNLIKELY)

    def _between(self, curve, pose, motion):
        """(STEPS,) float64, of places on the way of the curve's middle to its image, the share of what is around them
        that the network shows; nan where the curve or its image lies."""
        twist = np.concatenate(screw_velocity(motion[None]), axis=1)[0]
        middle = curve[len(curve) // 2]
        steps = exponential(np.linspace(0, 1, 200)[:, None] * twist)
        line = resample_polyline(apply(steps, middle[None])[:, 0], 1.0, False)
        at, way = apply(pose, line), directions(line) @ pose[:3, :3].T
        shown = uniform_filter1d(self._flags(at[None], way[None])[0].astype(float), AROUND, mode="nearest")
        shown[np.isfinite(cKDTree(curve).query(line, distance_upper_bound=self.radius)[0])] = np.nan
        shown[np.isfinite(cKDTree(apply(motion, curve)).query(line, distance_upper_bound=self.radius)[0])] = np.nan
        return shown[(np.arange(STEPS) + 0.5).astype(int) * len(line) // STEPS]

    def _shown(self, points, ways):
        """(k,) float64, share of points (k, m, 3) with directions (k, m, 3) that the network shows."""
        return self._flags(points, ways).mean(axis=1)

    def _flags(self, points, ways):
        """(k, m) bool, points (k, m, 3) with directions (k, m, 3) that the network shows."""
        distance, near = self.tree.query(points, k=4, distance_upper_bound=self.radius)
        found = np.isfinite(distance)
        line = self.network.tangents[np.where(found, near, 0)]
        found &= np.abs((line * ways[:, :, None]).sum(-1)) > 0.75
        return found.any(axis=2)
