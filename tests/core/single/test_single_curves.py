# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that do not recur: what is kept of damaged scenes, how it is drawn, and what must not change it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.scenes.damage import LEVELS, damaged
from core.network.building import build_network
from core.parameters import Parameters
from core.single import single_curves
from core.single.drawing import steadied
from core.values import Curves
from tests.core import shapes


def truth(rng, count=24):
    """Lines, arcs, rings and angles, each of its own size and pose, some way apart."""
    curves = []
    for k in range(count):
        size, turn = rng.uniform(25, 160), np.linalg.qr(rng.normal(size=(3, 3)))[0]
        if k % 4 == 0:
            curve = shapes.line(int(size))
        elif k % 4 == 1:
            curve = shapes.circle(size / 3)[: int(size)]
        elif k % 4 == 2:
            ring = shapes.circle(max(size / 8, 6))
            curve = np.concatenate([ring, ring[:1]])
        else:
            half = int(size / 2)
            curve = np.concatenate([shapes.line(half), shapes.line(half, [half - 1, 1, 0], [0.3, 1, 0])])
        curves.append(curve @ turn.T + rng.uniform(0, 160, size=3))
    return curves


def as_curves(pieces):
    closed = [len(c) > 3 and bool((c[0] == c[-1]).all()) for c in pieces]
    return Curves.from_list([c[:-1] if ring else c for c, ring in zip(pieces, closed)], closed)


def kept(curves, parameters=None, **how):
    net = build_network(curves, edge_length=1.0, smoothing=3.0)
    return net, single_curves(net, np.ones(len(net.points), bool), parameters or Parameters(), **how)


def f_measure(points, true):
    near = (cKDTree(true).query(points)[0] <= 2).mean(), (cKDTree(points).query(true)[0] <= 2).mean()
    return 2 * near[0] * near[1] / sum(near)


def off(points, true):
    """RMS distance to the truth of what is near it."""
    distance = cKDTree(true).query(points)[0]
    return np.sqrt((distance[distance <= 2] ** 2).mean())


@pytest.mark.parametrize("level, gain", [("clean", -0.005), ("medium", 0.05), ("hard", 0.1)])
def test_the_output_is_nearer_to_the_truth_than_the_input(rng, level, gain):
    curves = truth(rng)
    given, labels = damaged(curves, [(1, -1, -1)] * len(curves), LEVELS[level], step=1.0, rng=rng)
    net, singles = kept(as_curves(given))
    out, true = np.concatenate([net.to_world(c.points) for c in singles]), np.concatenate(curves)
    assert f_measure(out, true) - f_measure(np.concatenate(given), true) >= gain
    if level == "clean":
        return
    clutter = np.array([label[0] == 2 for label in labels])[net.source]
    members = np.unique(np.concatenate([c.members for c in singles]))
    assert net.lengths[members][clutter[members]].sum() < 0.12 * net.lengths[clutter].sum()
    shown = np.concatenate([g for g, label in zip(given, labels) if label[0] < 2])
    assert off(out, true) < 0.85 * off(shown, true)


def dashed(rng, dash=9, gap=5, count=9):
    """A line in dashes among clutter, each too short to be told from it."""
    starts = [[k * (dash + gap), 0, 0] for k in range(count)]
    dashes = [shapes.line(dash, start) + rng.normal(scale=0.05, size=(dash, 3)) for start in starts]
    walks = [shapes.wiggle(rng, 12, bend=0.7) + rng.uniform(-60, 160, size=3) for _ in range(60)]
    return dashes, walks


def test_dashes_that_carry_each_other_on_are_one_curve(rng):
    dashes, walks = dashed(rng)
    net, singles = kept(Curves.from_list([*dashes, *walks]))
    longest = max(singles, key=lambda c: len(c.points))
    assert sorted(net.source[longest.members]) == list(range(9))
    assert np.linalg.norm(net.to_world(longest.points)[:, 1:], axis=1).max() < 0.5
    assert longest.support == pytest.approx(9 * 8 / (9 * 8 + 8 * 6), abs=0.05)


def test_nothing_is_joined_over_more_than_the_largest_gap(rng):
    dashes, walks = dashed(rng)
    _, singles = kept(Curves.from_list([*dashes, *walks]), replace(Parameters(), link_gap=4.0))
    assert all(len(c.members) == 1 for c in singles)


def test_what_runs_along_a_gap_speaks_against_it(rng):
    """Two ends that face each other over 20 edges: one line, but for a third curve that fills the gap beside it."""
    noise = lambda n: rng.normal(scale=0.05, size=(n, 3))  # noqa: E731
    a, b = shapes.line(40) + noise(40), shapes.line(40, [59, 0, 0]) + noise(40)
    between = shapes.line(60, [19.5, 1.2, 0]) + noise(60)
    others = [shapes.line(50, [0, 40 + 30 * k, 20 * k]) + noise(50) for k in range(6)]
    for extra, most in (([], 2), ([between], 1)):
        net, singles = kept(Curves.from_list([a, b, *extra, *others]))
        joined = max(len(set(net.source[c.members]) & {0, 1}) for c in singles)
        assert joined == most


def test_higher_odds_keep_less(rng):
    given, _ = damaged(truth(rng), [(1, -1, -1)] * 24, LEVELS["hard"], step=1.0, rng=rng)
    lengths = []
    for odds in (1.0, 20.0):
        _, singles = kept(as_curves(given), replace(Parameters(), keep_odds=odds))
        assert all(c.log_odds > np.log(odds) for c in singles)
        lengths.append(sum(len(c.points) for c in singles))
    assert lengths[1] < lengths[0]


def test_pose_order_and_direction_change_nothing(rng):
    given, _ = damaged(truth(rng), [(1, -1, -1)] * 24, LEVELS["medium"], step=1.0, rng=rng)
    net, before = kept(as_curves(given))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    order = rng.permutation(len(given))
    moved = [given[i][:: 1 if i % 2 else -1] @ turn.T + [900.0, -40.0, 3.0] for i in order]
    again, after = kept(as_curves(moved))
    sets = [
        sorted(sorted(n.source[c.members].tolist() if n is net else order[n.source[c.members]].tolist()) for c in s)
        for n, s in ((net, before), (again, after))
    ]
    assert sets[0] == sets[1]
    one = np.concatenate([net.to_world(c.points) for c in before]) @ turn.T + [900.0, -40.0, 3.0]
    two = np.concatenate([again.to_world(c.points) for c in after])
    assert cKDTree(one).query(two)[0].max() < 1e-3


def test_a_run_can_be_stopped(rng):
    class Stopped(Exception):
        pass

    def stop():
        raise Stopped

    with pytest.raises(Stopped):
        kept(Curves.from_list([shapes.line(60)]), tick=stop)


@pytest.mark.parametrize("curves", [[shapes.line(2)], [shapes.line(3), shapes.line(3)], [shapes.line(40)] * 2])
def test_little_and_doubled_input_is_taken(curves):
    net, singles = kept(Curves.from_list(curves))
    assert all(np.isfinite(c.points).all() and 0 <= c.support <= 1 for c in singles)


def test_nothing_free_gives_nothing():
    net = build_network(Curves.from_list([shapes.line(50)]), edge_length=1.0, smoothing=3.0)
    assert single_curves(net, np.zeros(len(net.points), bool), Parameters()) == []


def test_noise_is_smoothed_and_a_corner_stays(rng):
    angle = np.concatenate([shapes.line(60, way=[-1, 0, 0])[::-1], shapes.line(60, way=[0, 1, 0])[1:]])
    noisy = angle + rng.normal(scale=0.3, size=angle.shape) * [0, 0, 1]
    line = steadied(noisy, False, 0.5)
    far = np.abs(np.arange(len(angle)) - 59) > 12
    assert np.sqrt((line[far, 2] ** 2).mean()) < 0.6 * np.sqrt((noisy[far, 2] ** 2).mean())
    assert np.linalg.norm(line - angle, axis=1)[59] < 1.0
    assert np.array_equal(steadied(noisy, False, 0.0), noisy)
