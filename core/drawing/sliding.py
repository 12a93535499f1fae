# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that run on from pose to pose: a cornice, a rail, a ring about the axis.

Such a curve recurs with itself only. In one pose it is a piece of no meaning, so it is no curve of a template.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import apply, exponential, inverse, screw_velocity
from ..geometry.polylines import directions, resample_polyline

NEIGHBOURS, SAME, MOVED, MOSTLY, STRAIGHT = 6, 5.0, 4.0, 0.7, 0.97
"""Tolerances: poses around each to which motions are looked at, edge lengths (RMS) within which two motions are one,
those that a motion must move a point, share of a curve that slides, and cosine of its tangent and its way."""

RUNS_ON = 0.33
"""Share of what is shown of a curve that must be shown of the way to its image for both to be one: about where the odds
of seen against chance are even."""

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
        between it and its image about as well as the curve itself: a cornice, not a row of sills.
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
        between = [
            self._between(curve, self.poses[a], g) if one else None for a, g, one in zip(mine, motions, along & ~on)
        ]
        gaps = np.array([np.nan if gap is None else gap for gap in between])
        asked = np.isfinite(gaps)
        runs = on.copy()
        if asked.any():
            runs[asked] = gaps[asked].mean() >= RUNS_ON * here[mine][asked].mean()
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

    def _between(self, curve, pose, motion):
        """Share that the network shows of the way of the curve's middle to its image, without what lies beside either;
        1 where nothing is between."""
        twist = np.concatenate(screw_velocity(motion[None]), axis=1)[0]
        middle = curve[len(curve) // 2]
        steps = exponential(np.linspace(0, 1, 200)[:, None] * twist)
        line = resample_polyline(apply(steps, middle[None])[:, 0], 1.0, False)
        free = ~np.isfinite(cKDTree(curve).query(line, distance_upper_bound=self.radius)[0])
        free &= ~np.isfinite(cKDTree(apply(motion, curve)).query(line, distance_upper_bound=self.radius)[0])
        if free.sum() < 3:
            return 1.0
        at, way = apply(pose, line[free]), directions(line)[free] @ pose[:3, :3].T
        return float(self._shown(at[None], way[None])[0])

    def _shown(self, points, ways):
        """(k,) float64, share of points (k, m, 3) with directions (k, m, 3) that the network shows."""
        distance, near = self.tree.query(points, k=4, distance_upper_bound=self.radius)
        found = np.isfinite(distance)
        line = self.network.tangents[np.where(found, near, 0)]
        found &= np.abs((line * ways[:, :, None]).sum(-1)) > 0.75
        return found.any(axis=2).mean(axis=1)
