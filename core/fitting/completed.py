# SPDX-License-Identifier: GPL-3.0-or-later
"""The curves of a completion as primitives, within the noise of the scene that they came from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from ..threads import single_threaded
from ..values import CompletedCurve, Completion, Curves
from .fit import FittedCurve, fit_curves

RAYLEIGH = 1.1774
"""Median distance from a line in space of points that are off by one standard deviation along each axis."""

NEAR, LEAST_NOISE = 2.0, 0.05
"""Edge lengths within which a point of the input shows a completed curve, and the least noise that is taken: what is
finer than that is the drawing's, not the scene's."""


@dataclass(frozen=True)
class FittedCompletion:
    """templates : for each template its curves, in template space; strong : the other curves, in the world
    sigma : standard deviation of the input along one axis, scene units
    """

    templates: tuple[tuple[FittedCurve, ...], ...]
    strong: tuple[FittedCurve, ...]
    sigma: float


def fit_completion(completion: Completion, curves: Curves, *, smoothing: float = 3.0) -> FittedCompletion:
    """All curves of a completion as primitives.

    Parameters
    ----------
    curves : what was completed; how far its points are from the completed curves is the noise
    smoothing : standard deviation of the smoothing along the curves, edge lengths
    """
    with single_threaded():  # or each small product would wake OpenBLAS's threads, which takes most of the time
        return _fit(completion, curves, smoothing)


def _fit(completion, curves, smoothing):
    sigma = scene_noise(completion, curves)
    options = {
        "sigma": sigma,
        "blur": smoothing * completion.edge_length,
        "correlation": max(1.0, 2 * smoothing),
    }

    def fitted(group):
        return tuple(fit_curves([c.points for c in group], [c.closed for c in group], **options))

    return FittedCompletion(tuple(fitted(t.curves) for t in completion.templates), fitted(completion.strong), sigma)


@dataclass(frozen=True)
class DrawnCurve(CompletedCurve):
    """A completed curve that knows its primitives, in its own space."""

    primitives: tuple = ()


def drawn(completion: Completion, fitted: FittedCompletion) -> Completion:
    """The completion with a DrawnCurve for each of its curves: what drawings are written from."""

    def of(curves, fits):
        return tuple(DrawnCurve(c.points, c.closed, c.component, c.support, f.primitives) for c, f in zip(curves, fits))

    templates = zip(completion.templates, fitted.templates)
    return replace(
        completion,
        templates=tuple(replace(t, curves=of(t.curves, fits)) for t, fits in templates),
        strong=of(completion.strong, fitted.strong),
    )


def scene_noise(completion: Completion, curves: Curves) -> float:
    """Standard deviation along one axis of the input about the completed curves, scene units."""
    lines = [
        (c.points @ m[:3, :3].T + m[:3, 3], c.closed)
        for t in completion.templates
        for m in t.occurrences
        for c in t.curves
    ]
    lines += [(c.points, c.closed) for c in completion.strong]
    lines = [(p, closed) for p, closed in lines if len(p) > 1]
    least = LEAST_NOISE * completion.edge_length
    if not lines or not len(curves.points):
        return least
    points = np.concatenate([p for p, _ in lines])
    ways = np.concatenate([_ways(p, closed) for p, closed in lines])
    distance, near = cKDTree(points).query(curves.points, distance_upper_bound=NEAR * completion.edge_length)
    seen = np.isfinite(distance)
    if not seen.any():
        return least
    gap = curves.points[seen] - points[near[seen]]
    way = ways[near[seen]]
    across = np.linalg.norm(gap - (gap * way).sum(axis=1)[:, None] * way, axis=1)
    return max(float(np.median(across)) / RAYLEIGH, least)


def _ways(points, closed):
    """(n, 3) float64, unit directions at the points of a polyline."""
    ring = np.concatenate([points[-1:], points, points[:1]]) if closed else np.pad(points, ((1, 1), (0, 0)), "edge")
    way = ring[2:] - ring[:-2]
    return way / np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
