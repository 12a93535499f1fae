# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the occurrences of one thing stand: each function gives (k, 4, 4) poses for a thing of a given box.

Lengths are in edges. A pose with determinant -1 is a mirror image. Whether what is placed so keeps its distances is
asked of the finished network; a placement only aims at it.
"""

from __future__ import annotations

import numpy as np

from ..scenes.shapes import rotation

APART = 5.0  # edges that neighbours keep at least, with a margin over what is asked of the network
MIRROR = np.diag([-1.0, 1.0, 1.0, 1.0])


def shift(x, y, z=0.0) -> np.ndarray:
    """(4, 4) float64, a translation."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def turn(axis, degrees) -> np.ndarray:
    """(4, 4) float64, a rotation about an axis through the origin."""
    pose = np.eye(4)
    pose[:3, :3] = rotation(axis, degrees)
    return pose


def gap(rng, size) -> float:
    """Free space between neighbours of this size."""
    return APART + rng.uniform(0.05, 0.9) * size


def cells(rng, box, count) -> tuple[np.ndarray, np.ndarray]:
    """Column and row numbers (k, 2) of a grid of about `count` cells, and its two steps."""
    columns = int(rng.integers(2, max(count // 2, 2), endpoint=True))
    rows = max(2, int(round(count / columns)))
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    steps = np.array([box[0] + gap(rng, box[0]), box[1] + gap(rng, box[1])])
    return np.stack([i.ravel(), j.ravel()], axis=1), steps


def row(rng, box, count):
    """One row, sometimes one above the other."""
    if rng.random() < 0.8:
        return [shift(k * d, 0) for d in [box[0] + gap(rng, box[0])] for k in range(count)]
    return [shift(0, k * d) for d in [box[1] + gap(rng, box[1])] for k in range(count)]


def grid(rng, box, count):
    """Columns and rows at right angles."""
    at, steps = cells(rng, box, count)
    return [shift(*p) for p in at * steps]


def sheared(rng, box, count):
    """Columns and rows at 50 to 80 degrees."""
    at, (dx, dy) = cells(rng, box, count)
    lean = dy / np.tan(np.radians(rng.uniform(50, 80))) * rng.choice([-1, 1])
    return [shift(i * dx + j * lean, j * dy) for i, j in at]


def staggered(rng, box, count):
    """Every other row half a step along."""
    at, (dx, dy) = cells(rng, box, count)
    return [shift((i + 0.5 * (j % 2)) * dx, j * dy) for i, j in at]


def gaps(rng, box, count):
    """A grid, or a row, with 15 to 40% of its cells empty."""
    share = rng.uniform(0.15, 0.4)
    whole = max(int(round(count / (1 - share))), count + 1)
    poses = (row if rng.random() < 0.4 else grid)(rng, box, whole)
    kept = np.sort(rng.choice(len(poses), size=min(count, len(poses) - 1), replace=False))
    return [poses[k] for k in kept]


def ring(rng, box, count):
    """About an axis that the things point away from."""
    count = max(count, 3)
    width = box[0] + APART + rng.uniform(0, 0.4) * box[0]
    inner = width / (2 * np.tan(np.pi / count)) + rng.uniform(0, 0.5) * box[1]
    return [turn((0, 0, 1), 360 / count * k) @ shift(0, inner + box[1] / 2) for k in range(count)]


def arc_in_depth(rng, box, count):
    """On a cylinder with an upright axis, in one to three rows of one angle."""
    rows = int(rng.integers(1, 4)) if count >= 9 else 1
    columns = max(count // rows, 2)
    angle = min(rng.uniform(4, 24), 330 / columns)
    rise = box[1] + gap(rng, box[1])
    width = box[0] + gap(rng, 0.4 * box[0])
    radius = width / (2 * np.tan(np.radians(angle / 2))) + box[2]
    return [turn((0, 1, 0), angle * k) @ shift(0, rise * j, radius) for j in range(rows) for k in range(columns)]


def screw(rng, box, count):
    """A winding stair about an upright axis; the things stand, or lie as treads do."""
    lying = bool(rng.random() < 0.5)
    wide, high, deep = box if not lying else (box[0], box[2], box[1])
    angle = rng.uniform(15, 50)
    radius = (wide + APART) / (2 * np.tan(np.radians(angle / 2))) + deep / 2 + rng.uniform(2, 20)
    around = 360 / angle  # things in a turn
    rise = (high + APART + rng.uniform(0.1, 0.6) * high) / (around - 1)
    hand = float(rng.choice([-1, 1]))
    own = turn((1, 0, 0), -90) if lying else np.eye(4)
    return [turn((0, 1, 0), hand * angle * k) @ shift(0, rise * k, radius) @ own for k in range(count)]


def scattered(rng, box, count) -> list:
    """Positions and leans in no order on the xy plane, its middle at the origin."""
    reach = np.hypot(box[0], box[1]) + APART
    side = np.sqrt(2.4 * count) * reach
    upright = bool(rng.random() < 0.4)
    places, poses = np.zeros((0, 2)), []
    for _ in range(4000):
        at = rng.uniform(-0.5, 0.5, size=2) * side
        if len(poses) < count and (len(places) == 0 or np.linalg.norm(places - at, axis=1).min() >= reach):
            places = np.concatenate([places, [at]])
            poses.append(shift(*at) @ turn((0, 0, 1), 0 if upright else rng.uniform(-180, 180)))
    return poses


def free_wall(rng, box, count):
    """Anywhere on one wall."""
    return scattered(rng, box, count)


def free_walls(rng, box, count):
    """Anywhere on three walls of a room."""
    counts = [len(part) for part in np.array_split(np.arange(max(count, 3)), 3)]
    reach = np.hypot(box[0], box[1]) + APART
    away = np.sqrt(2.4 * max(counts)) * reach / 2 + reach
    return [
        turn((0, 1, 0), 90 * wall) @ shift(0, 0, -away) @ pose
        for wall, k in enumerate(counts)
        for pose in scattered(rng, box, k)
    ]


def mirrored(rng, box, count):
    """Mirrored pairs: in one row, or the two wings of a building."""
    pairs = max(count // 2, 1)
    wide = box[0] + gap(rng, box[0])
    if pairs == 1 or rng.random() < 0.5:
        step = wide + box[0] + gap(rng, box[0])
        return [pose for k in range(pairs) for pose in (shift(k * step, 0), shift(k * step + wide, 0) @ MIRROR)]
    rows = 1 if pairs < 4 or rng.random() < 0.4 else 2
    rise, out = box[1] + gap(rng, box[1]), box[0] / 2 + gap(rng, box[0])
    wing = [shift(out + i * wide, j * rise) for j in range(rows) for i in range(pairs // rows)]
    return wing + [MIRROR @ pose for pose in wing]


PLACEMENTS = {
    "row": row,
    "grid": grid,
    "sheared": sheared,
    "staggered": staggered,
    "gaps": gaps,
    "ring": ring,
    "arc": arc_in_depth,
    "screw": screw,
    "free-wall": free_wall,
    "free-walls": free_walls,
    "mirrored": mirrored,
}
LEAST = {"grid": 4, "sheared": 4, "staggered": 4, "gaps": 4, "ring": 3, "free-walls": 3}
"""How many occurrences a placement needs; two where it is not named."""
