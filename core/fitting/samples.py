# SPDX-License-Identifier: GPL-3.0-or-later
"""A polyline made ready to be fitted: checked, in even steps, in its own frame, with its noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError

LARGEST, OFF_PLANE = 5.0, 4.5
"""Standard deviations that a sample may be off, one in 270000 is further with normal noise across the curve; and off
the plane of a plane curve."""

FINEST, UNEVEN, FEWEST = 1e-5, 8.0, 24
"""The smallest noise that is taken, as a share of the curve's size, for rounding; the longest step, in medians, up to
which samples count as even; and how many samples an uneven curve is given at least."""


@dataclass(frozen=True)
class Samples:
    """points : (n, 3) float64 in the curve's frame, in even steps, without the first at the end where closed
    origin, axes : the frame, a point p of it is ``origin + p @ axes`` in the world
    plane : the curve lies in a plane within its noise; all third coordinates of `points` are 0 then
    height : (n,) float64, how far each sample was off that plane; 0 in space
    sigma : standard deviation of a sample along one axis; correlation : how many neighbours err alike
    """

    points: np.ndarray
    closed: bool
    origin: np.ndarray
    axes: np.ndarray
    plane: bool
    height: np.ndarray
    sigma: float
    correlation: float

    @property
    def variance(self) -> float:
        return self.sigma**2 * self.correlation

    @property
    def bound(self) -> float:
        """How far a sample may be off."""
        return LARGEST * self.sigma

    def off(self, distance) -> np.ndarray:
        """(n,) float64, how far the samples were off before they were taken into their plane."""
        return np.hypot(distance, self.height)

    def rolled(self, first) -> Samples:
        """A closed curve that begins at another sample."""
        return replace(self, points=np.roll(self.points, -int(first), axis=0), height=np.roll(self.height, -int(first)))

    @property
    def spacing(self) -> float:
        step = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return float(step.mean())

    @property
    def price(self) -> float:
        """What one number costs: log of the number of independent samples."""
        return float(np.log(max(len(self.points) / self.correlation, 2)))

    def to_world(self) -> np.ndarray:
        """(4, 4) float64, the rigid motion from the frame to the world."""
        motion = np.eye(4)
        motion[:3, :3], motion[:3, 3] = self.axes.T, self.origin
        return motion


def make_samples(points, closed, *, sigma=None, correlation=1.0) -> Samples | None:
    """Samples of a polyline (n, 3), None where it has no length.

    An open curve whose ends meet within the noise is closed. With sigma None the noise is estimated from the curve.
    Raises InputError where points are not finite, are not (n, 3), or sigma is not above 0.
    """
    points = np.asarray(points, float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"points of shape {points.shape}: give one row of three coordinates a point")
    if not np.isfinite(points).all():
        raise InputError(f"point {int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])} is not finite: remove it")
    if sigma is not None and not (np.isfinite(sigma) and sigma >= 0):
        raise InputError(f"a noise of {sigma!r}: give a length of at least 0, or None to estimate it")
    points = points[np.r_[True, (np.diff(points, axis=0) != 0).any(axis=1)]] if len(points) else points
    if closed and len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    if len(points) < 2:
        return None
    closed = bool(closed) and len(points) > 2
    even, ratio = _even(points, closed)
    correlation *= max(ratio, 1.0)
    size = float(np.ptp(even, axis=0).max())
    sigma = max(estimate_sigma(even, closed) if sigma is None else sigma, FINEST * size)
    if not closed and len(even) > 7 and np.linalg.norm(even[-1] - even[0]) <= LARGEST * sigma < size / 8:
        even, closed = even[:-1], True
    origin = even.mean(axis=0)
    _, spread, axes = np.linalg.svd(even - origin, full_matrices=len(even) < 3)
    local = (even - origin) @ axes.T
    rms = np.sqrt((local[:, 2] ** 2).mean())
    height = np.abs(local[:, 2])
    plane = rms <= 1.5 * sigma and height.max() <= OFF_PLANE * sigma
    local[:, 2] *= not plane
    return Samples(local, closed, origin, axes, bool(plane), height * plane, sigma, correlation)


def estimate_sigma(points, closed=False) -> float:
    """Standard deviation of independent noise along one axis, from third differences of even samples (n, 3).

    A curve that is smooth over four samples leaves nothing in them, and the median does not see its corners.
    """
    if closed:
        points = np.concatenate([points, points[:3]])
    if len(points) < 8:
        return 0.0
    return float(np.median(np.abs(np.diff(points, n=3, axis=0)).max(axis=1)) / MEDIAN)


MEDIAN = 1.2816 * np.sqrt(20)
"""Median of the largest of three normal numbers, each with variance 20: 1 + 9 + 9 + 1."""


def _even(points, closed):
    """The points if they are even and many, otherwise points in even steps; and how many there are for one before."""
    ring = np.concatenate([points, points[:1]]) if closed else points
    step = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    typical = np.median(step)
    if len(points) >= FEWEST and step.max() <= UNEVEN * typical or len(points) >= 8 and step.max() <= 1.5 * typical:
        return points, 1.0
    along = np.r_[0.0, np.cumsum(step)]
    count = int(np.clip(along[-1] / typical, 2 * FEWEST, 4 * len(points) + 2 * FEWEST))
    at = np.linspace(0, along[-1], count + 1)[: count if closed else None]
    even = np.stack([np.interp(at, along, ring[:, c]) for c in range(3)], axis=1)
    return even, len(even) / len(points)
