# SPDX-License-Identifier: GPL-3.0-or-later
"""Courses: curves that run on through all cells of an orbit, such as a cornice, a rail or a ring about the axis.

Such a curve recurs with itself only. In one cell it is a piece of no meaning, and cells would cut its ends off where
it reaches half into one. It is therefore completed as what it is, one long curve: the pieces of the cells, one after
the other, as far as the input shows them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation.averaging import pull
from .drafts import Draft
from .geometry.motions import exponential
from .geometry.polylines import directions, resample_polyline, smooth_polyline, steady_polyline
from .geometry.rows import distinct_rows
from .network.network import CurveNetwork
from .orbits import Orbit
from .support import slips

GAP, TURN, FOLLOW, AHEAD, MOSTLY = 4.0, 0.85, 6.0, 1.0, 0.65
"""Edge lengths and cosine within which a piece goes on as its own image, edge lengths over which a course follows the
samples (no two cells of a real building are quite the same), those within which a sample is beside a point and not
ahead of it, and the share of a course that samples must show."""


STRAIGHT, LEAST, HIDDEN, PARTLY, FEWEST, BY_CHANCE = 0.9, 0.3, 0.25, 0.5, 3, 1e-3
"""Share of a curve that must run along a motion for it to be a piece of a course with holes, the share of a step that
it must fill, the shares of what is typical below which cells do not show a point and below which a row of them does not
show all, or hardly anything, fewest cells that can tell, and the probability below which it is no chance that holes
hide a place in all."""


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
    courses : list of Course; draft : without the curves that they are made of, and without what joins a curve of a
        cell to that of the next one where no cell shows it, as between the sills of neighbouring windows
    """
    courses, curves = [], list(draft.curves)
    samples = np.flatnonzero(free)
    if not len(samples):
        return courses, draft
    tree = cKDTree(network.points[samples])
    taken = []
    for c, (curve, ring) in enumerate(zip(draft.curves, draft.closed)):
        if ring:
            continue
        axis, line = _endless(orbit, curve)
        whole = axis is None
        if whole:
            axis, line = _slipping(orbit, curve)
        if axis is None:
            continue
        rows = [(keys, _chain(orbit, line, keys)) for keys in _rows(draft, c, axis, orbit)]
        part, rows = _shown_part(network, tree, samples, rows, orbit, axis, line, radius)
        if part is None or not len(part):
            taken.append(c)
        else:
            curves[c] = curve if whole else part
        for keys, path in rows:
            round_ = orbit.closed and len(keys) > orbit.count[axis]
            courses += _shown_parts(network, tree, samples, path, round_, len(line), radius, shortest)
    left = np.setdiff1d(np.arange(len(curves)), taken)
    return courses, replace(draft, curves=curves).part(left)


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


def _slipping(orbit: Orbit, curve):
    """The generator that a curve runs along, or None, and one step of the way of its middle along it."""
    for axis, g in enumerate(orbit.generators):
        along = slips(g[None], np.zeros(len(curve), np.int64), curve, directions(curve))
        step = exponential(np.linspace(0, 1, 200, endpoint=False)[:, None] * orbit.twists[axis])
        line = step[:, :3, :3] @ curve[len(curve) // 2] + step[:, :3, 3]
        length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        if along.mean() >= STRAIGHT and LEAST * length < len(curve) < length:
            return axis, resample_polyline(line, 1.0, False)
    return None, curve


def _shown_part(network, tree, samples, rows, orbit, axis, line, radius):
    """The part of one step of a course that cells show, None where they show all of it; and the rows of courses.

    Most of the cells must be in rows that have a gap. Rows that show all are courses even so: a cornice may lie where
    the sills of another row of windows would be.
    """
    seen = [_Row.of(network, tree, samples, orbit, keys, path, radius) for keys, path in rows]
    told = [row for row in seen if len(row) >= FEWEST]
    # A row that hardly shows the curve does not tell where it ends.
    best = max((row.typical for row in told), default=0.0)
    told = [row for row in told if row.typical >= PARTLY * best]
    if not told and sum(map(len, seen)) >= FEWEST:
        told = [_Row.together(seen)]
    gaps = [(row, gap) for row in told if (gap := row.gap()) is not None]
    if 2 * sum(len(row) for row, _ in gaps) <= sum(map(len, told)):
        return None, rows
    # Rows may have gaps in other places; the place is the one where most have theirs.
    place = np.argmax(sum(len(row) * gap for row, gap in gaps))
    mine = [(row, gap) for row, gap in gaps if gap[place]]
    gap = _Row.together([row for row, _ in mine]).gap()
    gap = max((gap for _, gap in mine), key=np.sum) if gap is None else gap
    start = int(np.argmax(~gap & np.roll(gap, 1)))
    g = orbit.generators[axis]
    both = np.concatenate([line, line @ g[:3, :3].T + g[:3, 3]])
    return both[start : start + len(line) - gap.sum()], [keys for keys, row in zip(rows, seen) if row.shows_all()]


@dataclass(frozen=True)
class _Row:
    """What the cells of a row show of one step of a course.

    seen : (a, n) bool, points that samples lie along; beside : (a, n) bool, those that a curve runs beside, as where
    no two cells are quite the same
    """

    seen: np.ndarray
    beside: np.ndarray

    @classmethod
    def of(cls, network, tree, samples, orbit, keys, path, radius):
        # The first and the last cell of an open row are there to find out where it ends.
        inner = slice(None) if orbit.closed else slice(1, -1)
        seen = _seen(network, tree, samples, path, radius)
        beside = seen | _beside(network, tree, samples, path)
        return cls(*(x.reshape(len(keys), -1)[inner] for x in (seen, beside)))

    @classmethod
    def together(cls, rows):
        return cls(*(np.concatenate([getattr(row, name) for row in rows]) for name in ("seen", "beside")))

    def __len__(self):
        return len(self.seen)

    @property
    def typical(self) -> float:
        """Share of the cells that show a point of the course which is shown at all."""
        share = self.seen.mean(axis=0)
        return float(np.median(share[share > 0])) if share.any() else 0.0

    def gap(self):
        """(n,) bool, the points of the gap that the cells have in common, or None.

        Of few cells one may have a hole where the next one has; in many no hole is at the same place, and a short gap
        is one, too, unless curves run beside it.
        """
        gap = _longest(self.seen.mean(axis=0) < HIDDEN * self.typical, 2 * GAP)
        if gap is None and (1 - self.typical) ** len(self) < BY_CHANCE:
            gap = _longest(self.beside.mean(axis=0) < HIDDEN * self.typical, GAP)
        return gap

    def shows_all(self) -> bool:
        few = self.beside.mean(axis=0) < PARTLY * self.typical
        return len(self) >= FEWEST and self.gap() is None and _longest(few, GAP) is None


def _longest(hidden, least):
    """(n,) bool, the longest run of flags of a ring (n,) bool, or None where it is shorter than `least`."""
    if hidden.all():
        return hidden
    turn = int(np.argmin(hidden))
    ring = np.concatenate([[False], np.roll(hidden, -turn), [False]])
    begin, end = np.flatnonzero(~ring[:-1] & ring[1:]), np.flatnonzero(ring[:-1] & ~ring[1:])
    if not len(begin) or (end - begin).max() < least:
        return None
    k = int(np.argmax(end - begin))
    run = np.zeros(len(hidden), bool)
    run[begin[k] : end[k]] = True
    return np.roll(run, turn)


def _rows(draft: Draft, curve, axis, orbit: Orbit):
    """Keys (k, g) of each row of cells along an axis that shows the curve, one cell more at either end."""
    seen = draft.keys[draft.orbital & (draft.evidence[:, curve] > 0.3)]
    for other in distinct_rows(np.delete(seen, axis, axis=1))[0]:
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


def _beside(network, tree, samples, path):
    """(k,) bool, points of a path that lie beside samples that run as it does on the whole, and not ahead of them."""
    distance, near = tree.query(path, k=24, distance_upper_bound=FOLLOW, workers=-1)
    found = np.isfinite(distance)
    index = samples[np.where(found, near, 0)]
    lines, way = network.tangents[index], directions(smooth_polyline(path, 2 * FOLLOW, False))[:, None]
    found &= np.abs((lines * way).sum(-1)) > 0.75
    ahead = ((network.points[index] - path[:, None]) * lines).sum(-1)
    return (found & (np.abs(ahead) <= AHEAD)).any(axis=1)
