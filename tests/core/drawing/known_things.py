# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes of one thing with known curves at known poses, each pose with holes and noise of its own."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from core.geometry.motions import apply, motion
from core.network.building import build_network
from core.values import Curves
from tests.core import shapes


def window():
    """Curves of a thing in edge lengths, and which are closed: an outline, a bar across it, a ring over it."""
    side = np.arange(30.0)
    outline = np.concatenate(
        [np.c_[side, 0 * side, 0 * side], np.c_[0 * side + 30, side * 1.5, 0 * side],
         np.c_[30 - side, 0 * side + 45, 0 * side], np.c_[0 * side, 45 - side * 1.5, 0 * side]]
    )  # fmt: skip
    bar = np.c_[side[2:28], 0 * side[2:28] + 20, 0.1 * side[2:28]]
    ring = shapes.circle(7) + [15, 58, 2]
    return [outline, bar, ring], [True, False, True]


def row(count, step=50.0):
    """(count, 4, 4) poses in a row."""
    return motion(np.tile(np.eye(3), (count, 1, 1)), np.arange(count)[:, None] * [step, 0.0, 0.0])


def free_poses(rng, count, room=200.0, mirrored=False):
    """(count, 4, 4) poses in no order, far enough from each other; every other one mirrored on request."""
    turns = Rotation.random(count, random_state=int(rng.integers(1 << 30))).as_matrix()
    if mirrored:
        turns[1::2] = turns[1::2] @ np.diag([-1.0, 1.0, 1.0])
    places = np.arange(count)[:, None] * [room, 0, 0] + rng.uniform(-40, 40, size=(count, 3))
    return motion(turns, places)


def scene(rng, poses, *, noise=0.35, hole=10, clutter=12, curves=None, strong=()):
    """Network, true curves, whether they are closed, and the poses in the network's frame.

    hole : longest stretch of each curve that a pose does not show, samples
    strong : further curves that do not recur
    """
    truth, closed = curves or window()
    pieces = [
        c for pose in poses for c, ring in zip(truth, closed) for c in _shown(rng, apply(pose, c), ring, noise, hole)
    ]
    everything = np.concatenate(pieces)
    for _ in range(clutter):
        step = np.cumsum(rng.normal(size=(12, 3)) * 0.6, axis=0)
        pieces.append(everything[rng.integers(len(everything))] + rng.normal(size=3) * 12 + step)
    pieces += list(strong)
    network = build_network(Curves.from_list(pieces), edge_length=1.0, smoothing=2.0)
    turn = network.rotation.T
    inside = motion(turn @ poses[:, :3, :3], (poses[:, :3, 3] - network.centre) @ network.rotation)
    return network, truth, closed, inside


def _shown(rng, curve, ring, noise, hole):
    """Noisy pieces of a curve with one hole."""
    n = len(curve)
    slow = gaussian_filter1d(rng.normal(size=curve.shape), 2.0, axis=0, mode="wrap" if ring else "nearest") * 2.0
    noisy = curve + noise * (0.5 * rng.normal(size=curve.shape) + 0.7 * slow)
    if ring:
        turned = np.roll(noisy, int(rng.integers(n)), axis=0)
        return [turned[: n - int(rng.integers(2, hole))]]
    first = int(rng.integers(0, n))
    return [p for p in (noisy[:first], noisy[first + int(rng.integers(2, hole)) :]) if len(p) >= 4]


def thing(poses, curve):
    """A hypothesis: one curve of the thing is known, and the poses."""
    way = np.gradient(curve, axis=0)
    return SimpleNamespace(points=curve, tangents=way / np.linalg.norm(way, axis=1)[:, None], poses=poses)


def shaken(rng, poses, middle, shift=0.7, angle=0.4):
    """Poses a little off, as a search leaves them."""
    out = []
    for pose in poses:
        turn = Rotation.from_rotvec(np.radians(angle) * rng.uniform(-1, 1, size=3)).as_matrix()
        off = motion(turn, middle - turn @ middle + rng.uniform(-1, 1, size=3) * shift)
        out.append(pose @ off)
    return np.array(out)
