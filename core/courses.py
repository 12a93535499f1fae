# SPDX-License-Identifier: GPL-3.0-or-later
"""Courses: curves that run on through all cells of an orbit, such as a cornice, a rail or a ring about the axis.

Such a curve recurs with itself only. In one cell it is a piece of no meaning, and cells would cut its ends off where
it reaches half into one. It is therefore completed as what it is, one long curve: the pieces of the cells, one after
the other, as far as the input shows them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .consolidation import pull
from .drafts import Draft, directions
from .network import CurveNetwork, resample_polyline, smooth_polyline, steady_polyline
from .orbits import Orbit

GAP, TURN, FOLLOW, MOSTLY = 4.0, 0.85, 6.0, 0.65
"""Edge lengths and cosine within which a piece goes on as its own image, edge lengths over which a course follows the
samples (no two cells of a real building are quite the same), and the share of a course that samples must show."""


@dataclass(frozen=True)
class Course:
    """A curve in the network's frame. points : (k, 3) float64; support : share of it that the input shows."""

    points: np.ndarray
    closed: bool
    support: float


def find_courses(network: CurveNetwork, orbit: Orbit, draft: Draft, free, *, radius, shortest):
    """Courses among the curves of a draft.

    Parameters
    ----------
    free : (n,) bool, samples that nothing explains yet
    shortest : edge lengths, shorter ones are left out

    Returns
    -------
    courses : list of Course; taken : (c,) int64, the curves of the draft that they are made of
    """
    courses, taken = [], []
    samples = np.flatnonzero(free)
    if not len(samples):
        return courses, np.zeros(0, np.int64)
    tree = cKDTree(network.points[samples])
    for c, (curve, ring) in enumerate(zip(draft.curves, draft.closed)):
        axis, line = _endless(orbit, curve) if not ring else (None, curve)
        if axis is None:
            continue
        taken.append(c)
        for keys in _rows(draft, c, axis, orbit):
            path = _chain(orbit, line, keys)
            round_ = orbit.closed and len(keys) > orbit.count[axis]
            courses += _shown_parts(network, tree, samples, path, round_, len(line), radius, shortest)
    return courses, np.array(taken, np.int64)


def _endless(orbit: Orbit, curve):
    """The generator along which a curve goes on as its own image, or None, and the curve in that direction."""
    way = directions(curve)
    for axis, g in enumerate(orbit.generators):
        for line, end in ((curve, way), (curve[::-1], -way[::-1])):
            start, lead = g[:3, :3] @ line[0] + g[:3, 3], g[:3, :3] @ end[0]
            if np.linalg.norm(start - line[-1]) < GAP and lead @ end[-1] > TURN:
                over = int(np.ceil(max(0.0, (line[-1] - start) @ end[-1])))
                return axis, line[: max(2, len(line) - over)]
    return None, curve


def _rows(draft: Draft, curve, axis, orbit: Orbit):
    """Keys (k, g) of each row of cells along an axis that shows the curve, one cell more at either end."""
    seen = draft.keys[draft.orbital & (draft.evidence[:, curve] > 0.3)]
    for other in np.unique(np.delete(seen, axis, axis=1), axis=0):
        mine = seen[(np.delete(seen, axis, axis=1) == other).all(axis=1)][:, axis]
        if orbit.closed:
            steps = np.arange(orbit.count[axis] + 1)
        else:
            steps = np.arange(mine.min() - 1, mine.max() + 2)
        keys = np.zeros((len(steps), seen.shape[1]), np.int64)
        keys[:, axis] = steps
        keys[:, np.arange(seen.shape[1]) != axis] = other
        yield keys


def _chain(orbit: Orbit, line, keys):
    """(k, 3) float64, one path through the images of a line under consecutive powers."""
    motions = orbit.power(keys)
    pieces = line @ np.swapaxes(motions[:, :3, :3], 1, 2) + motions[:, None, :3, 3]
    return np.concatenate(pieces)


def _shown_parts(network, tree, samples, path, ring, step, radius, shortest):
    """Courses along a path as far as samples show it; as with cells, two steps without a sample part them."""
    path = smooth_polyline(resample_polyline(path, 1.0, ring), 2.0, ring)
    seen = _seen(network, tree, samples, path, radius)
    if not seen.any():
        return []
    if ring and seen.mean() > 0.4:
        parts = [(path, True, seen)]
    else:
        at = np.flatnonzero(seen)
        holes = np.flatnonzero(np.diff(at) > 2 * step)
        bounds = zip(np.r_[at[0], at[holes + 1]], np.r_[at[holes], at[-1]])
        parts = [(path[a : b + 1], False, seen[a : b + 1]) for a, b in bounds]
    courses = []
    for line, closed, shown in parts:
        if shown.sum() < shortest or shown.mean() < MOSTLY:
            continue
        for _ in range(2):
            line = pull(
                line, network.points[samples], network.tangents[samples], network.weights[samples], radius, closed,
                spread=FOLLOW,
            )  # fmt: skip
        line = steady_polyline(resample_polyline(line, 1.0, closed), closed)
        courses.append(Course(line, closed, float(shown.mean())))
    return courses


def _seen(network, tree, samples, path, radius):
    """(k,) bool, points of a path that samples lie along."""
    distance, near = tree.query(path, k=3, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    lines = network.tangents[samples[np.where(found, near, 0)]]
    return (found & (np.abs((lines * directions(path)[:, None]).sum(-1)) > 0.75)).any(axis=1)
