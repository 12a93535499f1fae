# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of known pieces, sampled with noise."""

import numpy as np


def noisy(points, sigma, seed=0):
    return points + np.random.default_rng(seed).normal(scale=sigma, size=points.shape) if sigma else points


def polygon(corners, step=0.05):
    """Samples of a closed polygon, none at a corner but the first."""
    corners = np.asarray(corners, float)
    out = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0)):
        count = int(np.ceil(np.linalg.norm(b - a) / step))
        out.append(a + (b - a) * np.arange(count)[:, None] / count)
    return np.concatenate(out)


def rectangle(width=3.0, height=2.0, step=0.05):
    return polygon([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]], step)


def arc(radius=1.0, begin=0.0, end=np.pi, count=80, centre=(0, 0, 0)):
    t = np.linspace(begin, end, count)
    return np.stack([radius * np.cos(t), radius * np.sin(t), 0 * t], axis=1) + centre


def circle(radius=1.0, count=100):
    return arc(radius, 0, 2 * np.pi, count + 1)[:-1]


def pointed_arch(count=40):
    """Two arcs of radius 2 that meet at a point above the middle of their feet, 2 apart."""
    left = arc(2.0, np.pi, np.pi * 2 / 3, count, (1, 0, 0))
    right = arc(2.0, np.pi / 3, 0, count, (-1, 0, 0))
    return np.concatenate([left, right[1:]])


def window(count=30):
    """A pointed arch on two straight sides that go on into it."""
    sides = np.stack([np.full(count, -1.0), np.linspace(-3, 0, count, endpoint=False), np.zeros(count)], axis=1)
    return np.concatenate([sides, pointed_arch(count), (sides * [-1, 1, 1])[::-1]])


def space_curve(count=150):
    t = np.linspace(0, 1, count)[:, None]
    s = 1 - t
    control = np.array([[0, 0, 0], [1, 2, 0], [2, -2, 1], [4, 1, 2.0]])
    return s**3 * control[0] + 3 * s * s * t * control[1] + 3 * s * t * t * control[2] + t**3 * control[3]


def motion(seed=3):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = q * np.sign(np.linalg.det(q)), [5.0, -3.0, 8.0]
    return out


def moved(points, m):
    return points @ m[:3, :3].T + m[:3, 3]
