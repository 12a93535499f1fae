# SPDX-License-Identifier: GPL-3.0-or-later
"""What motifs are made of: curves inside a box, each drawn from a random generator.

Lengths are in edges, x to the right, y up, z towards the viewer; a box is centred on the origin.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from ..scenes.shapes import arc, join, line, volute

OUTLINES = ("box", "round", "pointed", "segmental", "blob")


def blob(rng, wide, high) -> np.ndarray:
    """(n, 3) float64, a closed curve without corners."""
    t = np.linspace(0, 2 * np.pi, 241)
    waves = [rng.uniform(-0.3, 0.3) / k * np.cos(k * t + rng.uniform(0, 2 * np.pi)) for k in (1, 2, 3, 4)]
    radius = 1 + sum(waves)
    xy = np.c_[radius * np.cos(t), radius * np.sin(t)]
    low, top = xy.min(axis=0), xy.max(axis=0)
    xy = ((xy - low) / (top - low) - 0.5) * (wide, high)
    xy[-1] = xy[0]
    return np.c_[xy, np.zeros(len(xy))]


def head(shape, wide, high) -> np.ndarray:
    """(n, 3) float64, the upper end of an outline, from the right jamb to the left one, bottom at y = 0."""
    half = wide / 2
    if shape == "box":
        return line((half, 0), (half, high), (-half, high), (-half, 0))
    if shape in ("round", "segmental"):
        start = 0 if shape == "round" else 40
        curve = arc((0, 0), 1, start, 180 - start)
        curve -= [0, np.sin(np.radians(start)), 0]
        return curve * [half / curve[:, 0].max(), high / curve[:, 1].max(), 1]
    right = arc((-0.5, 0), 1.5, 0, np.degrees(np.arccos(1 / 3)))
    curve = join(right, (right * [-1, 1, 1])[::-1])
    return curve * [half, high / curve[:, 1].max(), 1]


def outline(rng, shape, wide, high, *, open_below=False) -> np.ndarray:
    """(n, 3) float64, one curve about the box; closed unless `open_below`."""
    rise = {"box": 0.3 * high, "segmental": min(0.2 * wide, 0.4 * high)}.get(shape, min(0.5 * wide, 0.6 * high))
    rise *= rng.uniform(0.9, 1.2)
    upper = head(shape, wide, rise) + [0, high / 2 - rise, 0]
    right, left = (wide / 2, -high / 2, 0), (-wide / 2, -high / 2, 0)
    curve = join(line(right), upper, line(left))
    return curve if open_below else join(curve, line(right))


def spline(rng, wide, high, deep) -> np.ndarray:
    """(n, 3) float64, a smooth open curve across the box, in depth too."""
    count = int(rng.integers(4, 8))
    knots = rng.uniform(-0.5, 0.5, size=(count, 3)) * (wide, high, deep)
    knots[:, int(high > wide)] = np.linspace(-0.5, 0.5, count) * max(wide, high)
    return CubicSpline(np.arange(count), knots)(np.linspace(0, count - 1, 40 * count))


def zigzag(rng, wide, high) -> np.ndarray:
    """(n, 3) float64, straight teeth from left to right, of one width and two heights at most."""
    teeth = int(np.clip(wide / rng.uniform(8, 20), 2, 12))
    x = np.linspace(-0.5, 0.5, 2 * teeth + 1) * wide
    tall = np.where(np.arange(len(x)) % 4 == 1, 1.0, rng.choice([1.0, 0.6]))
    y = np.where(np.arange(len(x)) % 2, tall, 0.0) * high - high / 2
    return np.c_[x, y, np.zeros(len(x))]


def spiral(rng, size) -> np.ndarray:
    """(n, 3) float64, a volute whose turns lie four edges apart or more."""
    turns = float(np.clip(0.1 * size, 1.0, rng.uniform(1.2, 3.0)))
    return volute((0, 0), size / 2, turns, start=rng.uniform(0, 360), hand=rng.choice([-1.0, 1.0]))


def tracery(rng, wide, high) -> list:
    """Two lancets and an eye, as three curves."""
    radius, spring = wide * 0.22, rng.uniform(-0.1, 0.1) * high
    centre = wide * 0.26
    top = arc((centre, spring), radius, 0, 180)
    lancet = join(line((centre + radius, -high / 2, 0)), top, line((centre - radius, -high / 2, 0)))
    space = high / 2 - spring - radius
    eye = arc((0, high / 2 - space / 2), min(0.45 * space, 0.3 * wide), 0, 360)
    eye[-1] = eye[0]
    return [lancet, lancet * [-1, 1, 1], eye]


def baluster(rng, wide, high) -> np.ndarray:
    """(n, 3) float64, the right side of a turned post: near-straight, swaying by a few edges."""
    t = np.linspace(0, 1, 160)
    sway = rng.uniform(0.1, 0.35) * wide
    x = 0.5 * wide - sway * (1 - np.cos(2 * np.pi * rng.uniform(0.6, 1.6) * t ** rng.uniform(0.7, 1.5))) / 2
    return np.c_[x, (t - 0.5) * high, np.zeros(len(t))]
