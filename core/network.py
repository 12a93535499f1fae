# SPDX-License-Identifier: GPL-3.0-or-later
"""The feature curve network (section 4): curves as evenly spaced samples in a frame of their own.

The frame makes every later stage independent of the pose, the scale, the order and the direction of the
input: the origin is the centroid, the axes are the principal axes, the unit is the edge length, curves are
sorted by what they are and each runs the way its own shape says.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import correlate1d
from scipy.spatial import cKDTree

from .errors import InputError
from .values import Curves

CROSSING = np.pi * np.sqrt(3) / 12
"""Mean length of a random chord of an equilateral triangle of edge 1 (pi x area / perimeter)."""


@dataclass(frozen=True)
class CurveNetwork:
    """Resampled curves; lengths in edge lengths.

    points : (n, 3) float64, samples about one edge length apart, in the network's frame
    tangents : (n, 3) float64, unit
    weights : (n,) float64, length of curve that a sample stands for
    offsets : (m + 1,) int64; closed : (m,) bool
    curve_of : (n,) int64, the curve of each sample
    strength : (m,) float64, average curvature of each curve (1 / edge length), NaN where unknown
    source : (m,) int64, index of the curve in the Curves it was made from
    rotation, centre, unit : frame to world is ``points * unit @ rotation.T + centre``
    normals, kind : (n, 3) float64, unit, of the surface that the curves are on, and (n,) int64, ridge, valley or
        other; None where unknown
    """

    points: np.ndarray
    tangents: np.ndarray
    weights: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    curve_of: np.ndarray
    strength: np.ndarray
    source: np.ndarray
    rotation: np.ndarray
    centre: np.ndarray
    unit: float
    normals: np.ndarray | None = None
    kind: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def curve(self, i: int) -> np.ndarray:
        """(k, 3) float64, the samples of curve i."""
        return self.points[self.offsets[i] : self.offsets[i + 1]]

    @property
    def lengths(self) -> np.ndarray:
        """(m,) float64, length of each curve in edge lengths."""
        return np.add.reduceat(self.weights, self.offsets[:-1]) if len(self) else np.zeros(0)

    def part(self, curves: np.ndarray) -> CurveNetwork:
        """The network of some curves (k,) int64 alone, in that order and in the same frame."""
        sizes = np.diff(self.offsets)[curves]
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        at = np.arange(offsets[-1]) + np.repeat(self.offsets[curves] - offsets[:-1], sizes)
        return replace(
            self,
            points=self.points[at],
            tangents=self.tangents[at],
            weights=self.weights[at],
            offsets=offsets,
            closed=self.closed[curves],
            curve_of=np.repeat(np.arange(len(curves)), sizes),
            strength=self.strength[curves],
            source=self.source[curves],
            normals=None if self.normals is None else self.normals[at],
            kind=None if self.kind is None else self.kind[at],
        )

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points of the frame, (..., 3), in scene units and world axes."""
        return points * self.unit @ self.rotation.T + self.centre

    def motion_to_world(self, motions: np.ndarray) -> np.ndarray:
        """Rigid motions of the frame, (..., 4, 4), as motions of the world in scene units."""
        frame, back = self._frames()
        return frame @ motions @ back

    def motion_from_world(self, motions: np.ndarray) -> np.ndarray:
        """Rigid motions of the world in scene units, (..., 4, 4), as motions of the frame."""
        frame, back = self._frames()
        return back @ motions @ frame

    def _frames(self):
        """(4, 4) each, frame to world and back."""
        frame, back = np.eye(4), np.eye(4)
        frame[:3, :3], frame[:3, 3] = self.rotation * self.unit, self.centre
        back[:3, :3] = self.rotation.T / self.unit
        back[:3, 3] = -back[:3, :3] @ self.centre
        return frame, back


def estimate_edge_length(curves: Curves, *, crossings: bool = False) -> float:
    """Edge length of the mesh that the curves came from, in scene units.

    Curves along mesh edges show it as their median segment. Crest lines cut through triangles
    (`crossings`): a random chord of an equilateral triangle is `CROSSING` of its edge long.
    """
    _, steps = _segments(curves)
    steps = steps[steps > 0]
    if not len(steps):
        raise InputError("no curve has a length: give curves of at least two different points")
    return float(np.mean(steps) / CROSSING if crossings else np.median(steps))


def build_network(curves: Curves, *, edge_length: float, smoothing: float = 1.5) -> CurveNetwork:
    """Samples of the curves, smoothed along each curve and one edge length apart.

    Parameters
    ----------
    curves : scene units, any pose
    edge_length : scene units
    smoothing : standard deviation along the curve, in edge lengths; 0 leaves the curves as they are

    Notes
    -----
    O(n) time and memory in the total length. Curves without length are left out.
    """
    _check(curves, edge_length)
    rotation, centre = _frame(curves, edge_length)
    points = (curves.points - centre) @ rotation / edge_length
    normals, kind = None if curves.normals is None else curves.normals @ rotation, curves.kind
    curves = Curves(points, curves.offsets, curves.closed, curves.strength, curves.source)
    strength = _average_strength(curves) * edge_length
    fine, offsets, closed, kept = _resample(curves, 0.5)
    if smoothing > 0:
        fine = _smooth(fine, offsets, closed, smoothing / 0.5)
    smooth = Curves(fine, offsets, closed)
    points, offsets, closed, again = _resample(smooth, 1.0)
    kept = kept[again]
    points, offsets, closed, order = _canonical(points, offsets, closed)
    # Rounding errors of another pose, scale or order end here: from here on the numbers are the same bit by bit.
    points, kept = np.round(points, 6), kept[order]
    curve_of = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    tangents, weights = _tangents(points, offsets, closed, curve_of)
    if normals is not None or kind is not None:
        nearest = cKDTree(curves.points).query(points)[1]
        normals, kind = (None if values is None else values[nearest] for values in (normals, kind))
    return CurveNetwork(
        points, tangents, weights, offsets, closed, curve_of, strength[kept], kept, rotation, centre,
        float(edge_length), normals, kind,
    )  # fmt: skip


def _check(curves: Curves, edge_length: float) -> None:
    if not np.isfinite(edge_length) or edge_length <= 0:
        raise InputError(f"the edge length is {edge_length!r}: give a length above 0")
    bad = ~np.isfinite(curves.points).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        c = int(np.searchsorted(curves.offsets, i, side="right") - 1)
        raise InputError(f"curve {c} has the coordinates {curves.points[i].tolist()}: remove or repair that point")
    if len(curves) == 0:
        raise InputError("there is no curve: give at least one polyline of two points")
    _, steps = _segments(curves)
    total = steps.sum()
    if not total > 0:
        raise InputError("no curve has a length: give curves of at least two different points")
    if total / edge_length > 5e7:
        raise InputError(f"the edge length {edge_length:g} makes over 50 million samples: give a longer one")


def _segments(curves: Curves):
    """Segment vectors' start curve and their lengths, the closing segment of closed curves included."""
    step = np.diff(curves.points, axis=0, append=curves.points[:1]) if len(curves.points) else np.zeros((0, 3))
    last = curves.offsets[1:] - 1
    full = np.diff(curves.offsets) > 0
    first, last, closed = curves.offsets[:-1][full], last[full], curves.closed[full]
    step[last] = np.where(closed[:, None], curves.points[first] - curves.points[last], 0)
    return step, np.linalg.norm(step, axis=1)


def _frame(curves: Curves, edge_length: float):
    """Rotation (columns are the axes) and centre of the frame, from length-weighted moments."""
    anchor = curves.points.min(axis=0)
    step, length = _segments(curves)
    middle = curves.points - anchor + step / 2
    total = length.sum()
    centre = length @ middle / total
    local = (middle - centre) / edge_length
    second = (local * length[:, None]).T @ local + (step * length[:, None]).T @ step / (12 * edge_length**2)
    _, axes = np.linalg.eigh(second)
    axes = axes[:, ::-1].copy()
    skew = ((local @ axes) ** 3 * length[:, None]).sum(axis=0)
    axes[:, skew < 0] *= -1
    if np.linalg.det(axes) < 0:
        axes[:, np.argmin(np.abs(skew))] *= -1
    return axes, anchor + centre


def _average_strength(curves: Curves) -> np.ndarray:
    if curves.strength is None:
        return np.full(len(curves), np.nan)
    count = np.diff(curves.offsets)
    total = np.bincount(
        np.repeat(np.arange(len(curves)), count), np.abs(curves.strength), minlength=len(curves)
    )
    return total / np.maximum(count, 1)


def _resample(curves: Curves, step: float):
    """Points evenly along each curve about `step` apart; closed curves do not repeat the first point."""
    _, length = _segments(curves)
    run = np.concatenate([[0.0], np.cumsum(length)])
    start, end = run[curves.offsets[:-1]], run[curves.offsets[1:]]
    total = end - start
    kept = np.flatnonzero(total > 1e-9)
    closed = curves.closed & (total > 4 * step)
    pieces = np.maximum(np.rint(total / step).astype(np.int64), np.where(closed, 4, 1))
    count = (pieces + ~closed)[kept]
    offsets = np.concatenate([[0], np.cumsum(count)])
    curve = np.repeat(kept, count)
    k = np.arange(offsets[-1]) - np.repeat(offsets[:-1], count)
    at = k * (total / np.maximum(pieces, 1))[curve]
    # Zero-length steps between curves leave `run` flat there, so that one search serves all curves.
    first, last = curves.offsets[:-1][curve], curves.offsets[1:][curve] - 1
    position = start[curve] + at
    i = np.clip(np.searchsorted(run, position, side="right") - 1, first, np.where(curves.closed[curve], last, last - 1))
    nxt = np.where(i == last, first, i + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        u = np.clip(np.nan_to_num((position - run[i]) / length[i]), 0, 1)[:, None]
    points = (1 - u) * curves.points[i] + u * curves.points[nxt]
    return points, offsets.astype(np.int64), closed[kept], kept


def _smooth(points, offsets, closed, sigma, order=2):
    """Points smoothed along each curve, bends kept. Open ends stay.

    With G the Gaussian mean, 1 - (1 - G)^2 = 2 G - G^2 leaves every parabola as it is; G alone would shrink a circle
    of radius r by sigma^2 / (2 r). Each order more keeps two degrees more.
    """
    smooth, left = np.zeros_like(points), points
    for _ in range(order):
        mean = _gaussian_mean(left, offsets, closed, sigma)
        smooth, left = smooth + mean, left - mean
    return smooth


def _gaussian_mean(points, offsets, closed, sigma):
    """Gaussian mean along each curve; open ends are reflected through the end point."""
    radius = int(np.ceil(3 * sigma))
    taps = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    taps /= taps.sum()
    out = np.empty_like(points)
    for first, stop, ring in zip(offsets[:-1], offsets[1:], closed):
        p = points[first:stop]
        if ring:
            padded = p[np.arange(-radius, len(p) + radius) % len(p)]
        else:
            k = np.minimum(np.arange(1, radius + 1), len(p) - 1)
            padded = np.concatenate([2 * p[0] - p[k[::-1]], p, 2 * p[-1] - p[len(p) - 1 - k]])
        out[first:stop] = correlate1d(padded, taps, axis=0, mode="nearest")[radius : radius + len(p)]
    return out


def _canonical(points, offsets, closed):
    """Direct each curve by its own shape and sort the curves by length and place."""
    lists, keys = [], []
    for i in range(len(offsets) - 1):
        p = points[offsets[i] : offsets[i + 1]]
        if closed[i]:
            p = np.roll(p, -int(np.argmax(np.round(p @ np.array([1.0, 0.31, 0.17]), 6))), axis=0)
            if np.round((p[1] - p[-1]) @ np.array([0.23, 1.0, 0.41]), 6) < 0:
                p = np.concatenate([p[:1], p[:0:-1]])
        else:
            if np.round((p[-1] - p[0]) @ np.array([1.0, 0.31, 0.17]), 6) < 0:
                p = p[::-1]
        lists.append(p)
        keys.append((-len(p), *np.round(p[0], 6), *np.round(p[-1], 6)))
    order = np.array(sorted(range(len(keys)), key=keys.__getitem__), np.int64)
    count = np.diff(offsets)[order]
    points = np.concatenate([lists[i] for i in order])
    return points, np.concatenate([[0], np.cumsum(count)]), closed[order], order


def _tangents(points, offsets, closed, curve_of):
    first, last = offsets[:-1][curve_of], offsets[1:][curve_of] - 1
    here, ring = np.arange(len(points)), closed[curve_of]
    before = np.where(here > first, here - 1, np.where(ring, last, here))
    after = np.where(here < last, here + 1, np.where(ring, first, here))
    step = points[after] - points[before]
    size = np.linalg.norm(step, axis=1)
    gap_before = np.linalg.norm(points - points[before], axis=1)
    gap_after = np.linalg.norm(points[after] - points, axis=1)
    tangents = step / np.maximum(size, 1e-12)[:, None]
    return tangents, (gap_before + gap_after) / 2


def resample_polyline(points, step, closed):
    """(k, 3) float64, points of one polyline about `step` apart; the first is not repeated on a closed one."""
    one = Curves(points, np.array([0, len(points)]), np.array([closed]))
    return _resample(one, step)[0]


def smooth_polyline(points, sigma, closed, order=2):
    """(k, 3) float64, a polyline smoothed over about `sigma` samples, bends kept; ends stay."""
    if sigma <= 0:
        return points
    return _smooth(points, np.array([0, len(points)]), np.array([closed]), sigma, order)


def steady_polyline(points, closed, *, off=0.6, most=1.5, widest=24.0):
    """(k, 3) float64, a polyline with samples one edge apart, smoothed as far as it stays what it is.

    What is seen once has no other occurrence to average with. It is smoothed over 3, 6, 12, ... samples as long as
    that moves it by at most `off` on average (RMS) and `most` anywhere: noise does not need more, a corner does.
    """
    best, sigma = points, 3.0
    while sigma <= min(widest, len(points) / 3):
        line = smooth_polyline(points, sigma, closed, order=3)
        way = np.linalg.norm(line - points, axis=1)
        if np.sqrt((way**2).mean()) > off or way.max() > most:
            break
        best, sigma = line, 2 * sigma
    return best
