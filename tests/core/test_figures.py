# SPDX-License-Identifier: GPL-3.0-or-later
"""Two figures cut into parts at other places become one template; the motion between them is that of the whole."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.copies import unite
from core.figures import same_figures
from tests import naive
from tests.core import shapes
from tests.core.known_drafts import PARAMETERS, RADIUS, frame, known, scene


def wave(begin, order, *, radius=60.0, count=120):
    """One period, from an angle in radians on, of two waves of that order around the z axis."""
    a = begin + np.linspace(0, 2 * np.pi / order, count)
    turn = np.c_[np.cos(a), np.sin(a), np.zeros(count)]
    inner = 7 * np.sin(order * a) + 4 * np.cos(2 * order * a)
    outer = 24 + 5 * np.cos(order * a) - 3 * np.sin(3 * order * a)
    return [turn * (radius + way)[:, None] + np.c_[0 * a, 0 * a, way / 2] for way in (inner, outer)]


def two_rings(rng, order=6, *, lost=(), orders=None):
    """Two rings of waves, the second turned, cut half a period further; a draft of each without the `lost` cells."""
    orders = orders or (order, order)
    there = naive.rigid(naive.turn([0.2, 1, 0.1], 0.4), [40, 220, 15])
    steps = [[naive.about([0, 0, 1], 2 * np.pi * k / o, [0, 0, 0]) for k in range(o)] for o in orders]
    rings = [(wave(0.0, orders[0]), steps[0]), (wave(np.pi / orders[1], orders[1]), [there @ m for m in steps[1]])]
    net = scene(rng, rings)
    seen = [k for k in range(orders[1]) if k not in lost]
    drafts = [
        known(net, frame(net, np.eye(4), rings[0][0]), steps[0], transformation=0),
        known(net, frame(net, there, rings[1][0]), [there @ steps[1][k] @ np.linalg.inv(there) for k in seen],
              transformation=1),
    ]  # fmt: skip
    return net, rings, there, drafts


@pytest.mark.parametrize("lost", [(), (2,)])
def test_two_rings_cut_at_other_places_become_one_template(rng, lost):
    net, rings, there, drafts = two_rings(rng, lost=lost)
    (one,) = unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.poses) == 12 and one.orbital.sum() == 6 and one.keys.shape == (12, 1)
    truth = np.concatenate([np.concatenate(frame(net, m, thing)) for thing, places in rings for m in places])
    shown = np.concatenate([naive.moved(m, c) for m in one.poses for c in one.curves])
    assert (cKDTree(truth).query(shown)[0] < 0.6).mean() > 0.97
    assert (cKDTree(shown).query(truth)[0] < 1.5).mean() > 0.97


def test_the_motion_of_a_figure_is_that_of_the_whole(rng):
    """It begins as one that a part tells, and that is wrong far from it."""
    net, _, there, drafts = two_rings(rng)
    truth = shapes.in_frame(net, there @ naive.about([0, 0, 1], np.pi / 3, [0, 0, 0]))
    rough = truth @ naive.rigid(naive.turn([1, 2, 3], np.radians(1.0)), [0.5, -0.8, 0.3])
    other = shapes.in_frame(net, naive.rigid(shift=[0, 90, 0]))
    ((a, b, m),) = same_figures(drafts, np.array([other, rough]), radius=RADIUS)
    assert (a, b) in ((0, 1), (1, 0))
    points = naive.moved(drafts[a].poses[0], np.concatenate(drafts[a].curves))
    turned = [naive.moved(truth @ shapes.in_frame(net, naive.about([0, 0, 1], k * np.pi / 3, [0, 0, 0])), points)
              for k in range(6)]  # fmt: skip
    if a == 1:
        back = shapes.in_frame(net, np.linalg.inv(there))
        turned = [naive.moved(back @ shapes.in_frame(net, there @ naive.about([0, 0, 1], k * np.pi / 3, [0, 0, 0])
                                                     @ np.linalg.inv(there)), points) for k in range(6)]  # fmt: skip
    assert min(np.linalg.norm(naive.moved(m, points) - t, axis=1).max() for t in turned) < 0.3


def test_rings_of_another_order_are_not_the_same(rng):
    net, _, there, drafts = two_rings(rng, orders=(6, 8))
    motions = np.array([shapes.in_frame(net, there)])
    assert same_figures(drafts, motions, radius=RADIUS) == []
    assert same_figures(drafts, np.zeros((0, 4, 4)), radius=RADIUS) == []
