# SPDX-License-Identifier: GPL-3.0-or-later
"""What scanning and curve detection do to a network: fragments, jagged vertices, holes, clutter and a pose.

Lengths are in edge lengths. A true curve loses stretches (holes), is cut, loses single vertices, and each vertex is
displaced by white plus slowly changing noise. Clutter curves are random walks that start near the true network.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d


@dataclass(frozen=True)
class Level:
    """How strong the damage is.

    white, smooth : standard deviation of each coordinate, edge lengths
    holes : holes that every repeated curve gets; hole_every: one more per that length on average
    strong_hole_every : mean distance of holes in a curve that does not repeat
    hole_length : shortest and longest hole, edge lengths
    cut_every : mean distance of cuts; at a cut one vertex is lost
    drop : share of single vertices that are lost
    clutter : length of the clutter as a share of the true length
    """

    white: float
    smooth: float
    holes: int
    hole_every: float
    strong_hole_every: float
    hole_length: tuple[float, float]
    cut_every: float
    drop: float
    clutter: float


LEVELS = {
    "clean": None,
    "light": Level(0.12, 0.14, 0, 90.0, 300.0, (5.0, 24.0), 400.0, 0.05, 0.12),
    "medium": Level(0.29, 0.31, 1, 110.0, 200.0, (8.0, 28.0), 130.0, 0.14, 0.35),
    "hard": Level(0.44, 0.48, 1, 60.0, 110.0, (8.0, 28.0), 75.0, 0.14, 0.80),
}
SMOOTH_WIDTH = 3.1  # samples; correlation of the slow part of the noise
SHORTEST = 4  # vertices; shorter pieces are not detected
CLUTTER_TURN = 0.45  # standard deviation of what is added to the direction at each step
CLUTTER_LENGTH = (4, 14.0, 60)  # edges: shortest, mean, longest
CLUTTER_SPREAD = 12.5  # edge lengths, standard deviation of the distance of a walk's start from the network


def fragments(curve, level: Level, *, step: float, repeated: bool, rng) -> list[np.ndarray]:
    """Pieces of one true curve, each (k, 3) float64 with k >= 4, in either direction.

    curve : (n, 3) float64, points about `step` apart; closed if the last is the first
    """
    closed = len(curve) > 3 and np.allclose(curve[0], curve[-1])
    points = curve[:-1] if closed else curve
    n = len(points)
    seen = np.ones(n, bool)
    count = level.holes + rng.poisson(n / level.hole_every) if repeated else rng.poisson(n / level.strong_hole_every)
    for _ in range(count):
        length = min(rng.uniform(*level.hole_length), 0.5 * n)
        first = int(round(rng.uniform(0, n) - length / 2))
        hole = np.arange(first, first + int(length))
        seen[hole % n if closed else hole[(hole >= 0) & (hole < n)]] = False
    seen &= rng.random(n) >= 1 / level.cut_every
    white = rng.normal(size=(n, 3)) * level.white
    slow = gaussian_filter1d(rng.normal(size=(n, 3)), SMOOTH_WIDTH, axis=0, mode="wrap" if closed else "reflect")
    slow *= level.smooth * np.sqrt(2 * SMOOTH_WIDTH * np.sqrt(np.pi))
    noisy = points + (white + slow) * step
    kept = rng.random(n) >= level.drop
    if closed and seen.all():
        loop = noisy[kept]
        return [np.concatenate([loop, loop[:1]])]
    order = np.roll(np.arange(n), -int(np.argmin(seen))) if closed else np.arange(n)
    runs = np.split(order, np.nonzero(~seen[order])[0])
    pieces = [noisy[run[seen[run] & kept[run]]] for run in runs]
    return [p[::-1] if rng.random() < 0.5 else p for p in pieces if len(p) >= SHORTEST]


def random_walk(start, *, step: float, rng) -> np.ndarray:
    """(k, 3) float64, a clutter curve of edges of length `step` whose direction changes little by little."""
    low, mean, high = CLUTTER_LENGTH
    edges = int(np.clip(round(rng.exponential(mean)), low, high))
    direction = rng.normal(size=3)
    directions = np.empty((edges, 3))
    for k in range(edges):
        direction = direction / np.linalg.norm(direction)
        directions[k] = direction
        direction = direction + CLUTTER_TURN * rng.normal(size=3)
    return start + np.concatenate([np.zeros((1, 3)), np.cumsum(directions, axis=0)]) * step


def random_pose(rng) -> tuple[np.ndarray, np.ndarray]:
    """A rotation (3, 3) float64, uniform over all rotations, and a translation (3,) of a few units."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.sign(np.linalg.det(q))
    return q, rng.normal(size=3) * 4.0


def damaged(curves, labels, level: Level | None, *, step: float, rng):
    """The damaged network of a true one.

    curves : list of (n, 3) float64, true curves with points `step` apart
    labels : list of (class, kind, instance)
    level : None leaves the curves whole

    Returns a list of (k, 3) float64 and the list of their labels, in random order; clutter is (2, -1, -1).
    """
    if level is None:
        pieces = [(c.copy(), tuple(label)) for c, label in zip(curves, labels, strict=True)]
    else:
        pieces = [
            (p, tuple(label))
            for c, label in zip(curves, labels, strict=True)
            for p in fragments(c, level, step=step, repeated=label[0] == 0, rng=rng)
        ]
        vertices = np.concatenate(curves)
        missing = level.clutter * sum(len(c) - 1 for c in curves)
        while missing > 0:
            start = vertices[rng.integers(len(vertices))] + rng.normal(size=3) * CLUTTER_SPREAD * step
            walk = random_walk(start, step=step, rng=rng)
            pieces.append((walk, (2, -1, -1)))
            missing -= len(walk) - 1
    order = rng.permutation(len(pieces))
    return [pieces[i][0] for i in order], [pieces[i][1] for i in order]
