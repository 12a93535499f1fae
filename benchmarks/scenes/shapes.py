# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve shapes that layouts are made of: (n, 3) arrays with x to the right, y up and z towards the viewer."""

from __future__ import annotations

import numpy as np


def line(*points) -> np.ndarray:
    """(n, 3) float64, a polyline through 2D or 3D points."""
    return np.array([(*p, 0.0)[:3] for p in points], float)


def arc(centre, radius, start, stop, *, z=0.0) -> np.ndarray:
    """(n, 3) float64, an arc in the xy plane; angles in degrees, `radius` a number or one per axis."""
    t = np.radians(np.linspace(start, stop, max(9, int(abs(stop - start)) + 1)))
    rx, ry = np.broadcast_to(radius, 2)
    return np.c_[centre[0] + rx * np.cos(t), centre[1] + ry * np.sin(t), np.full(len(t), float(z))]


def circle(centre, radius, *, z=0.0) -> np.ndarray:
    """(n, 3) float64, a closed loop; the first point is repeated at the end."""
    loop = arc(centre, radius, 0, 360, z=z)
    loop[-1] = loop[0]
    return loop


def volute(centre, radius, turns, *, start=0.0, hand=1.0, z=0.0) -> np.ndarray:
    """(n, 3) float64, a spiral that shrinks to a fifth of its radius; `start` in degrees, `hand` is 1 or -1."""
    t = np.linspace(0, 1, int(120 * turns))
    angle = np.radians(start) + hand * 2 * np.pi * turns * t
    r = radius * (1 - 0.8 * t)
    return np.c_[centre[0] + r * np.cos(angle), centre[1] + r * np.sin(angle), np.full(len(t), float(z))]


def wave(start, stop, amplitude, periods, *, z=0.0) -> np.ndarray:
    """(n, 3) float64, a sine along the segment from `start` to `stop`."""
    t = np.linspace(0, 1, int(60 * periods) + 2)[:, None]
    a, b = np.asarray(start, float), np.asarray(stop, float)
    across = np.array([a[1] - b[1], b[0] - a[0]]) / np.linalg.norm(b - a)
    xy = a + t * (b - a) + amplitude * np.sin(2 * np.pi * periods * t) * across
    return np.c_[xy, np.full(len(xy), float(z))]


def join(*parts) -> np.ndarray:
    """(n, 3) float64, parts one after the other; a point that begins where the last one ended is kept once."""
    points = np.concatenate(parts)
    keep = np.r_[True, np.linalg.norm(np.diff(points, axis=0), axis=1) > 1e-9]
    return points[keep]


def raised(curve, z) -> np.ndarray:
    """(n, 3) float64, the curve moved by `z` towards the viewer."""
    return curve + [0.0, 0.0, z]


def mirrored(curve) -> np.ndarray:
    """(n, 3) float64, the curve with x turned round."""
    return curve * [-1.0, 1.0, 1.0]


def rounded(curve, radius) -> np.ndarray:
    """(n, 3) float64, an open polyline whose corners are cut by a quadratic of size `radius`."""
    parts = [curve[:1]]
    t = np.linspace(0, 1, 9)[:, None]
    for before, corner, after in zip(curve[:-2], curve[1:-1], curve[2:], strict=True):
        a = corner + (before - corner) * min(0.5, radius / np.linalg.norm(before - corner))
        b = corner + (after - corner) * min(0.5, radius / np.linalg.norm(after - corner))
        parts.append((1 - t) ** 2 * a + 2 * t * (1 - t) * corner + t**2 * b)
    return join(*parts, curve[-1:])


def resample(curve, step) -> np.ndarray:
    """(n, 3) float64, points at equal arc length, as near to `step` apart as the ends allow."""
    lengths = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    arclength = np.r_[0, np.cumsum(lengths)]
    at = np.linspace(0, arclength[-1], max(2, int(round(arclength[-1] / step)) + 1))
    return np.stack([np.interp(at, arclength, curve[:, k]) for k in range(3)], axis=1)


def rotation(axis, degrees) -> np.ndarray:
    """(3, 3) float64, the rotation about an axis through the origin."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k
