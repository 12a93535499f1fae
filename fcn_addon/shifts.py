# SPDX-License-Identifier: GPL-3.0-or-later
"""Global shifts: Blender holds single precision, so what lies far from the origin is kept near it, with its distance.

World coordinates are those of a scene plus its shift. The shift is rounded, as in CloudCompare, so that people can read
and type it.
"""

from __future__ import annotations

from dataclasses import replace
from math import floor, log10

import numpy as np

FAR = 4.0
"""How many extents from the origin a network may lie without a shift: the result is then still within 1e-6 of its
extent of the report, and near scans stay where their coordinates say."""


def shift_for(points) -> np.ndarray:
    """(3,) float64, a rounded shift that brings points (n, 3) near the origin; zero along axes where they are near."""
    if not len(points):
        return np.zeros(3)
    low, high = points.min(axis=0), points.max(axis=0)
    extent, middle = float((high - low).max()), 0.5 * (low + high)
    if extent <= 0:
        return np.zeros(3)
    unit = 10.0 ** floor(log10(extent))
    return np.where(np.abs(middle) > FAR * extent, np.round(middle / unit) * unit, 0.0)


def held(places) -> np.ndarray:
    """Places as single precision holds them, in float64.

    An object that stands on such a place is there exactly, and its data about it are as fine as those near the origin.
    """
    return np.asarray(places, np.float32).astype(np.float64)


def held_middle(points) -> np.ndarray:
    """(3,) float64, near the middle of the bounding box of points (n, 3), a place that single precision holds."""
    return held(0.5 * (points.min(axis=0) + points.max(axis=0)))


def moved_curves(curves, by):
    """Curves moved by (3,)."""
    return replace(curves, points=curves.points + by)


def moved_completion(completion, by):
    """A Completion moved by (3,); templates keep their own space, their occurrences move."""
    there, back = np.eye(4), np.eye(4)
    there[:3, 3], back[:3, 3] = by, -np.asarray(by)
    return replace(
        completion,
        transformations=tuple(
            replace(t, generators=np.array([there @ g @ back for g in t.generators]).reshape(-1, 4, 4))
            for t in completion.transformations
        ),
        templates=tuple(replace(t, occurrences=there @ t.occurrences) for t in completion.templates),
        strong=tuple(replace(curve, points=curve.points + by) for curve in completion.strong),
    )


def moved_fitted(fitted, by):
    """A FittedCompletion moved by (3,); templates keep their own space."""
    motion = np.eye(4)
    motion[:3, 3] = by
    strong = (replace(curve, primitives=tuple(p.moved(motion) for p in curve.primitives)) for curve in fitted.strong)
    return replace(fitted, strong=tuple(strong))
