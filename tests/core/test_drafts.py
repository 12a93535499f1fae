# SPDX-License-Identifier: GPL-3.0-or-later
"""What the network shows of clean curves at their places, sample by sample."""

from __future__ import annotations

import numpy as np
import pytest

from core.drafts import RIVAL, along, explained_samples, placed, seen_share
from core.geometry.polylines import directions
from tests import naive
from tests.core import shapes

RADIUS = 2.5


def scene(rng):
    """A network of noisy wiggles that cross each other, and curves at poses that run along some of them."""
    curves = [shapes.wiggle(rng, 40, bend=0.3) + rng.uniform(-8, 8, size=3) for _ in range(6)]
    net = shapes.network([c + 0.1 * rng.normal(size=c.shape) for c in curves])
    clean = [shapes.to_frame(net, c) for c in curves[:3]]
    nudges = [naive.about(rng.normal(size=3), np.radians(7), np.zeros(3), along=2.0) for _ in range(3)]
    return net, clean, np.array([np.eye(4), *nudges])


@pytest.mark.parametrize("seed", range(3))
def test_the_share_that_is_seen_is_that_of_the_loop(seed):
    rng = np.random.default_rng(seed)
    net, curves, poses = scene(rng)
    for free in (None, rng.random(len(net.points)) < 0.4):
        got = seen_share(net, curves, poses, radius=RADIUS, free=free)
        use = slice(None) if free is None else free
        expected = naive.seen_share(net.points[use], net.tangents[use], curves, poses, radius=RADIUS)
        assert np.allclose(got, expected)
        assert got.shape == (4, 3) and 0.2 < got[1:].mean() < 0.9 * got[0].min()


@pytest.mark.parametrize("seed", range(3))
def test_samples_along_curves_are_those_of_the_loop(seed):
    net, curves, poses = scene(np.random.default_rng(seed))
    points, ways = naive.placed(curves, poses)
    got = along(net, points, ways, RADIUS)
    seen = 0
    for p, w, flag, near, distance in zip(net.points, net.tangents, *got):
        k, gap = naive.lies_along(p, w, points, ways, radius=RADIUS, cosine=0.7, most=4)
        assert flag == (k >= 0) and distance == pytest.approx(gap)
        if flag:
            assert near == k
        seen += flag
    assert 0.2 * len(net.points) < seen < 0.95 * len(net.points)


@pytest.mark.parametrize("seed", range(3))
def test_samples_go_to_the_nearer_of_rivals(seed):
    net, curves, poses = scene(np.random.default_rng(seed))
    one, other = shapes.draft(curves[:2], poses[1:3]), shapes.draft(curves[1:], poses[:1])
    lines = [naive.placed(d.curves, d.poses) for d in (one, other)]
    expected = []
    for p, w in zip(net.points, net.tangents):
        own, rival = (naive.lies_along(p, w, *x, radius=RADIUS, cosine=0.7, most=4)[1] for x in lines)
        expected.append((own < np.inf, own < np.inf and own <= rival + 1.0))
    alone, beside = np.array(expected).T
    assert np.array_equal(explained_samples(net, one, radius=RADIUS), alone)
    assert np.array_equal(explained_samples(net, one, radius=RADIUS, rivals=other), beside)
    assert alone.sum() > beside.sum() > 0
    nothing = shapes.draft([], np.zeros((0, 4, 4)))
    assert np.array_equal(explained_samples(net, one, radius=RADIUS, rivals=nothing), alone)


@pytest.mark.parametrize("off, share", [(2.49, 1.0), (2.51, 0.0)])
def test_the_radius_bounds_what_is_seen(off, share):
    net = shapes.network([shapes.line(30), shapes.line(30, [0, 40, 0])])
    line = shapes.to_frame(net, shapes.line(30) - [0, off, 0])
    assert seen_share(net, [line], np.eye(4)[None], radius=RADIUS)[0, 0] == share
    assert explained_samples(net, shapes.draft([line], [np.eye(4)]), radius=RADIUS).sum() == 30 * share


def test_what_runs_another_way_is_not_seen():
    net = shapes.network([shapes.line(31, [-15, 0, 0]), shapes.line(5, [0, 40, 0])])
    across = shapes.to_frame(net, shapes.line(5, [0, -2, 0], [0, 1, 0]))
    assert seen_share(net, [across], np.eye(4)[None], radius=RADIUS)[0, 0] == 0
    assert not explained_samples(net, shapes.draft([across], [np.eye(4)]), radius=RADIUS).any()
    same = shapes.to_frame(net, shapes.line(31, [-15, 0, 0])[::-1])
    assert seen_share(net, [same], np.eye(4)[None], radius=RADIUS)[0, 0] == 1, "tangents have no sense"


@pytest.mark.parametrize("angle, share, explained", [(41, 1, True), (42, 0, True), (45, 0, True), (46, 0, False)])
def test_how_far_directions_may_differ(angle, share, explained):
    net = shapes.network([shapes.line(31, [-15, 0, 0]), shapes.line(5, [0, 40, 0])])
    a = np.radians(angle)
    way = np.array([np.cos(a), np.sin(a), 0])
    curve = shapes.to_frame(net, shapes.line(3, -way, way))
    assert seen_share(net, [curve], np.eye(4)[None], radius=RADIUS)[0, 0] == share
    assert explained_samples(net, shapes.draft([curve], [np.eye(4)]), radius=RADIUS).any() == explained


@pytest.mark.parametrize("more, has", [(-0.05, True), (0.05, False)])
def test_by_how_much_a_rival_must_be_nearer(more, has):
    net = shapes.network([shapes.line(30), shapes.line(30, [0, 40, 0])])
    own, rival = (shapes.to_frame(net, shapes.line(30) - [0, off, 0]) for off in (0.5 + RIVAL + more, 0.5))
    seen = explained_samples(
        net, shapes.draft([own], [np.eye(4)]), radius=RADIUS, rivals=shapes.draft([rival], [np.eye(4)])
    )
    assert seen.sum() == 30 * has


def test_all_curves_at_all_places(rng):
    _, curves, poses = scene(rng)
    points, ways, cell, curve = placed(shapes.draft(curves, poses))
    expected = naive.placed(curves, poses)
    assert np.allclose(points, expected[0]) and np.allclose(ways, expected[1])
    sizes = [len(c) for c in curves]
    assert cell.tolist() == [a for a in range(4) for c in range(3) for _ in range(sizes[c])]
    assert curve.tolist() == [c for a in range(4) for c in range(3) for _ in range(sizes[c])]


def test_directions_are_those_of_the_loop(rng):
    curve = shapes.wiggle(rng, 25, bend=0.4)
    assert np.allclose(directions(curve), naive.directions(curve))
    assert np.isfinite(directions(np.ones((4, 3)))).all(), "points that lie on each other have no direction"


def test_a_part_of_a_draft(rng):
    _, curves, poses = scene(rng)
    evidence = rng.random((4, 3))
    whole = shapes.draft(curves, poses, closed=[True, False, False], evidence=evidence, transformation=5)
    part = whole.part([2, 0], [3, 1])
    assert [np.array_equal(c, curves[k]) for c, k in zip(part.curves, (2, 0))] == [True, True]
    assert part.closed == [False, True] and part.transformation == 5
    assert np.array_equal(part.poses, poses[[3, 1]]) and part.keys.tolist() == [[3], [1]]
    assert np.array_equal(part.evidence, [[evidence[3, 2], evidence[3, 0]], [evidence[1, 2], evidence[1, 0]]])
    assert len(whole.part().curves) == 3 and len(whole.part(cells=[1]).curves) == 3
    none = whole.part([])
    assert none.curves == [] and none.evidence.shape == (4, 0) and none.lengths.shape == (0,)


def test_no_samples_no_places_and_what_stays_as_it_was(rng):
    net, curves, poses = scene(rng)
    kept = [c.copy() for c in curves], poses.copy()
    nothing = np.zeros(len(net.points), bool)
    assert (seen_share(net, curves, poses, radius=RADIUS, free=nothing) == 0).all()
    assert seen_share(net, curves, poses[:0], radius=RADIUS).shape == (0, 3)
    assert all(map(np.array_equal, curves, kept[0])) and np.array_equal(poses, kept[1])
