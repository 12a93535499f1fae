# SPDX-License-Identifier: GPL-3.0-or-later
"""Strong curves that are there once, about what recurs: cornices, outlines, rails. Lengths are in edges."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from ..scenes.shapes import arc, line, resample

CLEAR = 4.0  # edges that a strong curve keeps from everything else


def cornice(rng, low, top) -> np.ndarray:
    """A straight line under or over everything, sometimes bent at its ends."""
    below = rng.random() < 0.5
    far = rng.uniform(6, 60)
    y = low[1] - far if below else top[1] + far
    a, b = low[0] - rng.uniform(5, 60), top[0] + rng.uniform(5, 60)
    z = rng.uniform(low[2] - 10, top[2] + 10)
    if rng.random() < 0.6:
        return line((a, y, z), (b, y, z))
    out = rng.uniform(8, 25)
    return line((a, y, z - out), (a, y, z), (b, y, z), (b, y, z - out))


def ledge(rng, low, top) -> np.ndarray:
    """A straight line under or over everything; where nothing may recur, no bent ends are alike."""
    y = low[1] - rng.uniform(6, 60) if rng.random() < 0.5 else top[1] + rng.uniform(6, 60)
    z = rng.uniform(low[2] - 10, top[2] + 10)
    return line((low[0] - rng.uniform(5, 60), y, z), (top[0] + rng.uniform(5, 60), y, z))


def pilaster(rng, low, top) -> np.ndarray:
    """An upright line at one side."""
    x = low[0] - rng.uniform(6, 70) if rng.random() < 0.5 else top[0] + rng.uniform(6, 70)
    z = rng.uniform(low[2] - 10, top[2] + 10)
    return line((x, low[1] - rng.uniform(0, 60), z), (x, top[1] + rng.uniform(0, 60), z))


def gable(rng, low, top) -> np.ndarray:
    """An outline about everything, open at its foot."""
    a, b, z = low[0] - rng.uniform(10, 60), top[0] + rng.uniform(10, 60), rng.uniform(low[2], top[2])
    eaves, peak = top[1] + rng.uniform(5, 40), top[1] + rng.uniform(50, 120)
    middle = a + rng.uniform(0.3, 0.7) * (b - a)
    return line((a, low[1] - 15, z), (a, eaves, z), (middle, peak, z), (b, eaves, z), (b, low[1] - 15, z))


def ground(rng, low, top) -> np.ndarray:
    """A long curve in depth under everything."""
    count = int(rng.integers(5, 10))
    x = np.linspace(low[0] - 30, top[0] + 30, count)
    size = 0.06 * (top[0] - low[0]) + 8
    y = low[1] - rng.uniform(10, 30) - size * rng.uniform(0, 1, count)
    z = rng.uniform(low[2], top[2]) + size * rng.uniform(-1, 1, count)
    t = np.arange(count)
    return CubicSpline(t, np.c_[x, y, z])(np.linspace(0, count - 1, 60 * count))


def hoop(rng, low, top) -> np.ndarray:
    """A circle about the z axis, outside or inside of everything."""
    outer = 0.5 * max(top[0] - low[0], top[1] - low[1]) * rng.uniform(0.1, 1.5)
    loop = arc((0, 0), outer, 0, 360, z=rng.uniform(low[2], top[2]))
    loop[-1] = loop[0]
    return loop


def course(rng, low, top) -> np.ndarray:
    """An arc about the upright axis, under or over everything."""
    far = rng.uniform(6, 50)
    y = low[1] - far if rng.random() < 0.5 else top[1] + far
    radius = max(abs(low[0]), abs(top[0]), abs(low[2]), abs(top[2])) * rng.uniform(0.8, 1.1)
    start = rng.uniform(-60, 60)
    return arc((0, 0), radius, start, start + rng.uniform(80, 300))[:, [0, 2, 1]] + [0, y, 0]


def newel(rng, low, top) -> np.ndarray:
    """A wound rail about the upright axis, or the straight axis itself."""
    if rng.random() < 0.4:
        return line((0, low[1] - 20, 0), (0, top[1] + 20, 0))
    t = np.linspace(0, 1, 600)
    reach = max(top[0], -low[0], top[2], -low[2])
    radius, angle = reach * rng.uniform(0.1, 1.3), np.radians(rng.uniform(200, 700)) * t
    return np.c_[radius * np.cos(angle), low[1] + (top[1] - low[1]) * t + rng.uniform(-30, 60), radius * np.sin(angle)]


FLAT = (cornice, cornice, cornice, pilaster, gable, ground)
ABOUT = {
    "none": (ledge, pilaster, ground),
    "ring": (hoop, hoop, ground),
    "arc": (course, course, ground),
    "screw": (newel, course, newel),
}


def strong_curves(rng, points, layout) -> list:
    """0 to 5 long curves that stay clear of the points (n, 3) and of each other, points one edge apart."""
    low, top = points.min(axis=0), points.max(axis=0)
    choice, taken, out = ABOUT.get(layout, FLAT), points, []
    wanted = int(rng.integers(0, 6))
    for _ in range(8 * wanted):
        if len(out) == wanted:
            break
        curve = resample(choice[int(rng.integers(len(choice)))](rng, low, top), 1.0)
        if len(curve) > 0.6 * len(points):  # long beside what it surrounds
            continue
        if cKDTree(taken).query(curve, distance_upper_bound=CLEAR)[0].min() > CLEAR:
            taken = np.concatenate([taken, curve])
            out.append(curve)
    return out
