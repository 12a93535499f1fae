# SPDX-License-Identifier: GPL-3.0-or-later
"""The layouts: each turns a random generator into a true network; sizes are scene units, 0.02 is one edge."""

from __future__ import annotations

import numpy as np

from . import ornaments
from .network import Network, shifts, turns
from .shapes import arc, circle, line, mirrored, rotation


def cells(columns, rows, first, second) -> np.ndarray:
    """(columns * rows, 2) float64, positions of a grid with the two generators."""
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    return i.reshape(-1, 1) * np.asarray(first, float) + j.reshape(-1, 1) * np.asarray(second, float)


def courses(network, positions, *, below, above, depth=0.1) -> None:
    """Two straight mouldings under and over the positions (n, 2)."""
    (x0, y0), (x1, y1) = positions.min(axis=0), positions.max(axis=0)
    network.keep(line((x0 - 1.3, y0 - below, depth), (x1 + 1.1, y0 - below, depth)))
    network.keep(line((x0 - 1.1, y1 + above, depth), (x1 + 1.4, y1 + above, depth)))


def gothic_grid(rng) -> Network:
    """Pointed windows on two translations at right angles."""
    network = Network()
    step = rng.uniform(1.6, 2.0), rng.uniform(2.4, 2.8)
    at = cells(rng.integers(4, 7), rng.integers(3, 4), (step[0], 0), (0, step[1]))
    network.repeat(ornaments.gothic_window(rng), shifts(at))
    courses(network, at, below=0.5, above=2.2)
    return network


def rosette(rng) -> Network:
    """Petals about one axis, k-fold, in a round frame."""
    network = Network()
    k = int(rng.choice([6, 8, 9, 10, 12, 16]))
    scale = max(1.0, k / 9)
    network.repeat([p * scale for p in ornaments.petal(rng, 360 / k)], turns(np.arange(k) * 360 / k))
    network.keep(circle((0, 0), 2.25 * scale, z=0.08))
    return network


def theatre(rng) -> Network:
    """Rows of one seat about one axis; every row has the same angle step, on request half a step apart."""
    network = Network()
    step, rows, pitch = rng.uniform(8, 11), int(rng.integers(2, 5)), rng.uniform(1.0, 1.2)
    nearest, rise, stagger = 60 / step, rng.uniform(0.2, 0.35), step / 2 * rng.integers(0, 2)
    count = int(rng.integers(7, 10))
    motions = []
    for row in range(rows):
        out = np.array([0, nearest + pitch * row, rise * row])
        for turn, shift in turns((np.arange(count) - count / 2) * step + stagger * (row % 2)):
            motions.append((turn, turn @ out + shift))
        reach = count / 2 * step + 4
        network.keep(arc((0, 0), nearest + pitch * row - 0.2, 90 - reach, 90 + reach - 3 * row, z=rise * row))
    network.repeat(ornaments.seat(rng), motions)
    return network


def colonnade(rng) -> Network:
    """One row of columns under an entablature."""
    network = Network()
    at = cells(int(rng.integers(8, 13)), 1, (rng.uniform(0.95, 1.25), 0), (0, 0))
    network.repeat(ornaments.column(rng), shifts(at))
    courses(network, at, below=0.4, above=3.0, depth=0.5)
    courses(network, at, below=0.6, above=3.4, depth=0.6)
    return network


def balustrade(rng) -> Network:
    """A row of thin balusters between two rails."""
    network = Network()
    at = cells(int(rng.integers(12, 19)), 1, (rng.uniform(0.4, 0.5), 0), (0, 0))
    network.repeat(ornaments.baluster(rng), shifts(at))
    courses(network, at, below=0.15, above=1.75, depth=0.15)
    return network


def irregular(rng) -> Network:
    """One window at 8 to 10 places in no regular order, some turned, on two walls at a right angle."""
    network = Network()
    count, places, motions = int(rng.integers(8, 11)), [], []
    while len(places) < count:
        wall, x, y = len(places) % 2, rng.uniform(0.9, 6.0), rng.uniform(0, 4.5)
        if all(w != wall or np.hypot(x - u, y - v) > 1.9 for w, u, v in places):
            places.append((wall, x, y))
            lean = float(rng.choice([0, 0, 0, 90, -35, rng.uniform(-180, 180)]))
            turn, shift = rotation((0, 0, 1), lean), np.array([x, y, 0])
            side = rotation((0, 1, 0), 90 * wall)
            motions.append((side @ turn, side @ shift))
    network.repeat(ornaments.round_window(rng), motions)
    network.keep(line((0, -1.4, 0), (0, 6.6, 0)), line((0.3, 6.3, 0.1), (6.8, 6.3, 0.1)))
    return network


def sheared_grid(rng) -> Network:
    """Windows on two translations 60 to 75 degrees apart."""
    network = Network()
    lean = np.radians(rng.uniform(60, 75))
    rise = rng.uniform(2.2, 2.6)
    second = (rise / np.tan(lean), rise)
    at = cells(int(rng.integers(4, 7)), int(rng.integers(3, 5)), (rng.uniform(1.9, 2.3), 0), second)
    network.repeat(ornaments.baroque_window(rng), shifts(at))
    courses(network, at, below=0.6, above=2.4)
    return network


def spiral(rng) -> Network:
    """A spiral stair of 14 steps with its rail."""
    network = Network()
    angle, rise, steps = rng.uniform(20, 27), rng.uniform(0.3, 0.38), 14
    network.repeat(ornaments.stair_step(rng, angle), turns(-angle * np.arange(steps), axis=(0, 1, 0), rise=rise))
    t = np.linspace(-0.5, steps, 40 * steps)
    a = np.radians(angle * t)
    network.keep(np.c_[1.2 * np.cos(a), rise * t + 1.1, 1.2 * np.sin(a)])
    return network


def two_grids(rng) -> Network:
    """Two kinds of windows with different steps, one region beside the other."""
    network = Network()
    first = cells(int(rng.integers(3, 5)), 3, (rng.uniform(1.6, 1.8), 0), (0, rng.uniform(2.3, 2.5)))
    network.repeat(ornaments.gothic_window(rng, 0.9), shifts(first))
    step = rng.uniform(1.9, 2.3)
    second = cells(int(rng.integers(3, 5)), 4, (step, 0), (0, rng.uniform(1.75, 1.9))) + (first[:, 0].max() + 2.2, 0.2)
    network.repeat(ornaments.round_window(rng, 0.85), shifts(second))
    courses(network, np.concatenate([first, second]), below=0.6, above=2.3)
    return network


def gap_grid(rng) -> Network:
    """A grid with missing cells; at one place two neighbouring columns are empty."""
    network = Network()
    columns, rows = int(rng.integers(8, 10)), 2
    at = cells(columns, rows, (rng.uniform(1.7, 2.0), 0), (0, rng.uniform(2.2, 2.5))).reshape(columns, rows, 2)
    there = np.ones((columns, rows), bool)
    empty = int(rng.integers(3, columns - 4))
    there[empty : empty + 2] = False
    there[int(rng.integers(1, empty - 1)) if empty > 2 else 1, int(rng.integers(rows))] = False
    there[empty + 3, int(rng.integers(rows))] = False
    network.repeat(ornaments.round_window(rng), shifts(at[there]))
    courses(network, at.reshape(-1, 2), below=0.6, above=2.0)
    return network


def subgrid(rng) -> Network:
    """A screwdriver: six grooves round the handle, a blade that is the same on two sides, rings."""
    network = Network()
    grooves, sides = ornaments.groove(rng)
    network.repeat(grooves, turns(np.arange(6) * 60, axis=(1, 0, 0)))
    network.repeat(sides, turns([0, 180], axis=(1, 0, 0)))
    for x, radius in ((-1.0, 0.4), (0.95, 0.36), (1.3, 0.2)):
        network.keep(circle((0, 0), radius)[:, [2, 0, 1]] + [x, 0, 0])
    return network


def mirrored_wings(rng) -> Network:
    """Two wings, one the mirror image of the other; windows repeat by translation inside a wing only."""
    network = Network()
    step = rng.uniform(1.9, 2.2), rng.uniform(2.1, 2.4)
    at = cells(3, int(rng.integers(2, 4)), (step[0], 0), (0, step[1])) + (1.8, 0)
    window = ornaments.round_window(rng)
    network.repeat(window, shifts(at))
    network.repeat([mirrored(c) for c in window], shifts(at * (-1, 1)))
    both = np.concatenate([at, at * (-1, 1)])
    courses(network, both, below=0.6, above=2.0)
    network.keep(line((-1.2, -1, 0.2), (-1.2, 4, 0.2), (0, 5.2, 0.2), (1.2, 4, 0.2), (1.2, -1, 0.2)))
    return network


def large(rng) -> Network:
    """A long facade of about 120 windows."""
    network = Network()
    at = cells(int(rng.integers(14, 17)), 8, (rng.uniform(1.15, 1.3), 0), (0, rng.uniform(1.5, 1.7)))
    network.repeat(ornaments.gothic_window(rng, 0.6), shifts(at))
    courses(network, at, below=0.4, above=1.4)
    return network


LAYOUTS = {
    "gothic-grid": gothic_grid,
    "rosette": rosette,
    "theatre": theatre,
    "colonnade": colonnade,
    "balustrade": balustrade,
    "irregular": irregular,
    "sheared-grid": sheared_grid,
    "spiral": spiral,
    "two-grids": two_grids,
    "gap-grid": gap_grid,
    "subgrid": subgrid,
    "mirrored": mirrored_wings,
    "large": large,
}
