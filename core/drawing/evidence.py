# SPDX-License-Identifier: GPL-3.0-or-later
"""Log odds of curves: seen where the poses put them, against seen by chance.

At a pose that shows a share p of the thing, a point of a curve that is there is seen with probability p, and one that
is not with probability q, measured with the poses moved aside (target and decoy). A seen point is worth log(p / q), a
missed one log((1 - p) / (1 - q)), in nats; points close to each other on a curve tell the same, so that `APART` edge
lengths make one observation. The curve was found where some pose shows it: one sighting of each point is its
discovery and no evidence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import apply
from ..geometry.polylines import directions
from .overlay import Overlay, decoys

APART = 12.0
"""Edge lengths along a curve after which a sighting is independent of the last one (chance runs on for 9 to 24)."""

RIVAL = 1.0
"""Tolerance: edge lengths by which another curve must be nearer to a sample to have it."""

DECOYS, ASIDE = 6, 4.0
"""Motions that measure chance, and edge lengths by which one must move a point across its curve to tell something."""

DISCOVERY = 0.5
"""Share of a sighting that counts for nothing: it found the curve, which was traced where several poses agree."""

LEAST_SHOWN, MOST_SHOWN = 0.35, 0.9
"""Bounds of the share of a curve that a pose shows."""

LEAST_CHANCE, MOST_CHANCE, TRUST = 0.05, 0.6, 50.0
"""Bounds of the chance of a sighting, and the number of points at which the measured value weighs as much as the
least one."""


@dataclass(frozen=True)
class Sightings:
    """Which samples of an overlay lie along which points of some curves.

    point : (s,) int64, index into the points of all curves; item : (s,) int64, index into the overlay's samples
    distance : (s,) float64; offsets : (c + 1,) int64, where the points of each curve begin
    """

    point: np.ndarray
    item: np.ndarray
    distance: np.ndarray
    offsets: np.ndarray

    def of_curve(self, c) -> slice:
        """The sightings of curve c."""
        return slice(*np.searchsorted(self.point, self.offsets[c : c + 2]))


def sightings(curves, overlay: Overlay, *, radius, cosine=0.75, places=None) -> Sightings:
    """Sightings of curves in an overlay; places : points (n, 3) and tangents (n, 3) in place of the overlay's own."""
    line, way = np.concatenate(curves), np.concatenate([directions(c) for c in curves])
    points, tangents = (overlay.points, overlay.tangents) if places is None else places
    low, high = line.min(axis=0) - radius, line.max(axis=0) + radius
    near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
    found = cKDTree(line).sparse_distance_matrix(cKDTree(points[near]), radius, output_type="ndarray")
    point, item = found["i"].astype(np.int64), near[found["j"]]
    good = np.abs((way[point] * tangents[item]).sum(1)) > cosine
    point, item, distance = point[good], item[good], found["v"][good]
    order = np.lexsort((item, point))
    offsets = np.concatenate([[0], np.cumsum([len(c) for c in curves])])
    return Sightings(point[order], item[order], distance[order], offsets)


def seen_by(found: Sightings, overlay: Overlay, use=slice(None)):
    """(cells, points) bool, which points of the curves the poses show; use : which of the sightings count."""
    seen = np.zeros((overlay.cells, int(found.offsets[-1])), bool)
    seen[overlay.cell[found.item[use]], found.point[use]] = True
    return seen


def chances(curves, overlay: Overlay, *, radius):
    """(c,) float64, how likely a point of each curve is seen where it is not."""
    line, way = np.concatenate(curves), np.concatenate([directions(c) for c in curves])
    offsets = np.concatenate([[0], np.cumsum([len(c) for c in curves])])
    few = overlay.of_cells(np.unique(np.linspace(0, overlay.cells - 1, 8).astype(int)))
    hits, asked = np.zeros(len(line)), np.zeros(len(line))
    for g in decoys(line, DECOYS):
        shift = apply(g, line) - line
        across = np.linalg.norm(shift - way * (shift * way).sum(1)[:, None], axis=1) > ASIDE
        moved = [c @ g[:3, :3].T + g[:3, 3] for c in curves]
        found = seen_by(sightings(moved, few, radius=radius), few)
        hits += found.sum(axis=0) * across
        asked += across * few.cells
    hits, asked = (np.add.reduceat(x, offsets[:-1]) for x in (hits, asked))
    return np.clip((hits + LEAST_CHANCE * TRUST) / (asked + TRUST), LEAST_CHANCE, MOST_CHANCE)


def log_odds(seen, p, q):
    """(cells, points) float64, nats that each point of a curve adds at each pose; seen : (cells, points) bool.

    A curve shorter than `APART` is one observation in each pose.
    """
    return np.where(seen, np.log(p / q), np.log((1 - p) / (1 - q))) / min(APART, seen.shape[1])


def point_scores(seen, p, q):
    """(points,) float64, nats of each point over all poses, one sighting being its discovery."""
    first = DISCOVERY * np.log(p / q) / min(APART, seen.shape[1])
    return log_odds(seen, p, q).sum(axis=0) - first * seen.any(axis=0)


def kept_stretches(score, closed, least, shortest):
    """Stretches of a curve that are left when all that surely is not there is cut out.

    Parameters
    ----------
    score : (n,) float64, nats of each point; closed : whether the last point is followed by the first
    least : nats that a stretch must have against it to be cut out; shortest : points of a gap inside a curve

    Returns
    -------
    list of (k,) int64, indices in order; a closed curve that is whole is np.arange(n)
    """
    n = len(score)
    turn = 0
    if closed:
        # A ring is opened where it is surest.
        smooth = np.convolve(np.r_[score, score, score], np.ones(9), "same")[n : 2 * n]
        turn = int(np.argmax(smooth))
    line = np.roll(score, -turn)
    keep = np.ones(n, bool)
    _cut(line, keep, 0, n, least, shortest)
    if keep.all():
        return [np.arange(n)]
    at = np.flatnonzero(keep)
    parts = [part for part in np.split(at, np.flatnonzero(np.diff(at) != 1) + 1) if len(part)]
    if closed and len(parts) > 1 and keep[0] and keep[-1]:
        parts = [np.concatenate([parts[-1], parts[0]]), *parts[1:-1]]
    return [(part + turn) % n for part in parts]


def _cut(score, keep, begin, end, least, shortest):
    """Clear `keep` on the stretches of [begin, end) whose scores sum to less than -least, worst first."""
    stack = [(begin, end)]
    while stack:
        a, b = stack.pop()
        if b - a < 1:
            continue
        total = np.concatenate([[0.0], np.cumsum(score[a:b])])
        drop = total - np.maximum.accumulate(total)
        stop = int(np.argmin(drop))
        if drop[stop] >= -least:
            continue
        start = int(np.argmax(total[: stop + 1]))
        if stop - start < shortest and start > 0 and stop < b - a:
            # Too short for a gap: corners are rounded off in all poses alike.
            stack += [(a, a + start), (a + stop, b)]
            continue
        keep[a + start : a + stop] = False
        stack += [(a, a + start), (a + stop, b)]
