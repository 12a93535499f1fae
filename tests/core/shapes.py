# SPDX-License-Identifier: GPL-3.0-or-later
"""Small curves, motions and networks with one edge length as unit, for the tests of the method."""

from __future__ import annotations

import numpy as np

from core.drafts import Draft
from core.network.building import build_network
from core.values import Curves
from tests import naive


def wiggle(rng, n, *, bend=0.15):
    """(n, 3) smooth random curve of unit steps; `bend` is how much the direction changes a step, in radians."""
    way = [rng.normal(size=3)]
    for _ in range(n - 2):
        way.append(way[-1] / np.linalg.norm(way[-1]) + rng.normal(scale=bend, size=3))
    way = np.array(way) / np.linalg.norm(way, axis=1)[:, None]
    return np.vstack([np.zeros(3), np.cumsum(way, axis=0)])


def line(n, start=(0, 0, 0), way=(1, 0, 0)):
    """(n, 3) straight curve of unit steps."""
    way = np.asarray(way, float) / np.linalg.norm(way)
    return np.asarray(start, float) + np.arange(n)[:, None] * way


def circle(radius, centre=(0, 0, 0), *, n=None, phase=0.0):
    """(n, 3) closed circle in the xy plane, about one edge length between its points, the first not repeated."""
    n = n or int(round(2 * np.pi * radius))
    a = phase + 2 * np.pi * np.arange(n) / n
    return np.asarray(centre, float) + radius * np.c_[np.cos(a), np.sin(a), np.zeros(n)]


def ornament(rng, n=3, *, size=12, count=45):
    """Curves of one thing: n curls that fix every motion, within a ball of about `size`."""
    curves = []
    for _ in range(n):
        a = np.linspace(0, 1, count)[:, None] * 2 * np.pi
        wave = sum(rng.normal(size=3) / k * np.sin(k * a + rng.uniform(0, 6, size=3)) for k in (0.5, 1, 1.5))
        wave = wave + np.linspace(-1, 1, count)[:, None] * rng.normal(size=3)
        curves.append(size * 0.5 * (wave / np.abs(wave).max() + 0.5 * rng.normal(size=3)))
    return curves


def network(curves, *, closed=None, smoothing=0.0, edge_length=1.0):
    """The network of a list of curves."""
    return build_network(Curves.from_list(curves, closed=closed), edge_length=edge_length, smoothing=smoothing)


def in_frame(net, m):
    """A motion of the world, (4, 4), as a motion of the network's frame."""
    to_world = np.eye(4)
    to_world[:3, :3], to_world[:3, 3] = net.rotation * net.unit, net.centre
    return np.linalg.inv(to_world) @ m @ to_world


def to_frame(net, points):
    """Points of the world, (n, 3), in the network's frame."""
    return (points - net.centre) @ net.rotation / net.unit


def draft(curves, poses, *, closed=None, keys=None, evidence=None, orbital=True, transformation=0):
    """A draft of curves at poses, all of which show all curves; cells of an orbit where nothing else is said."""
    closed = [False] * len(curves) if closed is None else list(closed)
    keys = np.arange(len(poses))[:, None] if keys is None else np.asarray(keys, np.int64)
    evidence = np.ones((len(poses), len(curves))) if evidence is None else evidence
    return Draft(list(curves), closed, np.array(poses), keys, evidence, transformation, np.full(len(poses), orbital))


def random_motion(rng, reach=50.0):
    """A random rotation and a random shift."""
    return naive.rigid(naive.turn(rng.normal(size=3), rng.uniform(0, np.pi)), rng.uniform(-reach, reach, size=3))
