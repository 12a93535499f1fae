# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks of things at known places, and the drafts that a perfect method would make of them."""

from __future__ import annotations

import numpy as np

from core.drafts import seen_share
from core.parameters import Parameters
from tests import naive
from tests.core import shapes

PARAMETERS = Parameters(l0=20.0)
RADIUS = 1.25 * PARAMETERS.epsilon
TURNED = naive.rigid(naive.turn([0.3, 1, 0.2], 1.1), [0, 130, 10])


def known(net, curves, steps, **more):
    """A draft of curves of the frame at motions of the world, and what the network shows of it."""
    poses = np.array([shapes.in_frame(net, m) for m in steps])
    return shapes.draft(curves, poses, evidence=seen_share(net, curves, poses, radius=RADIUS), **more)


def row(step, count, first=None):
    return [np.linalg.matrix_power(step, k) @ (np.eye(4) if first is None else first) for k in range(count)]


def scene(rng, things, *, noise=0.15):
    """A network of things, each a list of curves, at their places."""
    curves = [naive.moved(m, c) + noise * rng.normal(size=c.shape) for thing, places in things for m in places
              for c in thing]  # fmt: skip
    return shapes.network(curves, smoothing=1.5)


def frame(net, m, thing):
    """Clean curves of a thing at a place of the world, in the network's frame."""
    return [shapes.to_frame(net, naive.moved(m, naive.resample(c, 1.0))) for c in thing]
