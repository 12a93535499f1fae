# SPDX-License-Identifier: GPL-3.0-or-later
"""Noisy copies of a thing become one curve where the thing has one, and that curve is better than each copy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from core.consolidation.averaging import condense, own_points
from core.consolidation.consolidation import fit_curves
from core.consolidation.tracing import _graph, _longest_shortest_path, trace_curves
from tests import naive
from tests.core import shapes

COPIES, NOISE = 8, 0.45


def copies(rng, curves, closed, *, noise=NOISE, count=COPIES):
    """Points, tangents and the single noisy copies of the curves; each copy has a sample phase of its own."""
    points, tangents, single = [], [], []
    for _ in range(count):
        for c, ring in zip(curves, closed):
            mode = "wrap" if ring else "nearest"
            c = np.roll(c, rng.integers(len(c)), axis=0) if ring else c
            slow = gaussian_filter1d(rng.normal(size=c.shape), 2.0, axis=0, mode=mode) * 2.5
            p = c + noise * (0.5 * rng.normal(size=c.shape) + 0.8 * slow)
            step = (
                np.roll(p, -2, 0) - np.roll(p, 2, 0) if ring else np.gradient(gaussian_filter1d(p, 1.0, axis=0), axis=0)
            )
            points.append(p)
            tangents.append(step / np.linalg.norm(step, axis=1)[:, None])
            single.append(p)
    return np.concatenate(points), np.concatenate(tangents), single


def consensus(rng, curves, closed, **more):
    points, tangents, single = copies(rng, curves, closed, **more)
    weight = np.ones(len(points))
    middle, lines = condense(points, tangents, weight, radius=2.5)
    run = np.repeat(np.arange(len(single)), [len(p) for p in single])
    out, rings = fit_curves(trace_curves(middle, lines), middle, lines, weight, run)
    return out, rings, single


def error(line, curves, closed):
    """Mean distance of a line's points from the true curves."""
    return float(np.mean([min(naive.distance_to_polyline(p, c, r) for c, r in zip(curves, closed)) for p in line]))


def missed(curves, closed, lines, rings, radius=1.5):
    """Share of the true samples with no line near."""
    truth = np.concatenate(curves)
    return np.mean([min(naive.distance_to_polyline(p, q, r) for q, r in zip(lines, rings)) > radius for p in truth])


THINGS = {
    "line": ([shapes.line(50, way=[1, 2, 0.5])], [False], 1),
    "arc": ([shapes.circle(25)[:80]], [False], 1),
    "circle": ([shapes.circle(12)], [True], 1),
    "helix": ([np.c_[9 * np.cos(np.arange(70) / 10), 9 * np.sin(np.arange(70) / 10), np.arange(70) * 0.4]], [False], 1),
    "two lines": ([shapes.line(40), shapes.line(40, [0, 7, 0])], [False, False], 2),
    "two circles": ([shapes.circle(9), shapes.circle(15)], [True, True], 2),
    "corner": ([np.concatenate([shapes.line(25)[::-1], shapes.line(25, way=[0, 1, 0])[1:]])], [False], 1),
}


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize("seed", range(3))
def test_one_curve_where_the_thing_has_one(name, seed):
    curves, closed, count = THINGS[name]
    lines, rings, single = consensus(np.random.default_rng(seed), curves, closed)
    assert len(lines) == len(rings) == count
    assert sorted(rings) == sorted(closed)
    errors = [error(line, curves, closed) for line in lines]
    each = [error(c, curves, closed) for c in single]
    # At the corner itself smoothing rounds a little off.
    assert max(errors) < (0.9 if name == "corner" else 0.6) * min(each), "nearer to the truth than the best copy"
    assert missed(curves, closed, lines, rings) < 0.05
    total = sum(naive.length(c, r) for c, r in zip(curves, closed))
    assert sum(naive.length(c, r) for c, r in zip(lines, rings)) == pytest.approx(total, rel=0.08)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("lean", [90, 60])
def test_a_junction_has_a_stem_and_a_bar(seed, lean):
    way = [np.cos(np.radians(lean)), np.sin(np.radians(lean)), 0]
    curves, closed = [shapes.line(61, [-30, 0, 0]), shapes.line(35, way=way)], [False, False]
    lines, rings, single = consensus(np.random.default_rng(seed), curves, closed)
    assert len(lines) == 2 and not any(rings)
    assert missed(curves, closed, lines, rings) < 0.05
    # the bar is whole
    assert max(naive.length(c) for c in lines) == pytest.approx(60, abs=4)
    assert max(error(line, curves, closed) for line in lines) < min(error(c, curves, closed) for c in single)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("gap", [-1.5, 0.0, 0.6])
def test_curves_that_touch_or_cross_at_a_flat_angle_stay_two(seed, gap):
    """Two bows whose middles nearly lie on each other: each copy runs along one of them, and says which."""
    rng = np.random.default_rng(seed)
    t = np.linspace(-32, 32, 65)
    bow = np.c_[t, t**2 / 60 + gap / 2, 0 * t]
    curves, closed = [bow, bow * [1, -1, 1]], [False, False]
    lines, rings, _ = consensus(rng, curves, closed)
    assert len(lines) == 2 and not any(rings)
    for line in lines:
        assert min(np.mean([naive.distance_to_polyline(p, c, False) for p in line]) for c in curves) < 0.6
        assert naive.length(line) == pytest.approx(naive.length(bow), rel=0.08)


def test_samples_are_an_edge_length_apart(rng):
    for name in ("arc", "circle"):
        lines, rings, _ = consensus(rng, *THINGS[name][:2])
        for line, ring in zip(lines, rings):
            closing = [np.linalg.norm(line[0] - line[-1])] if ring else []
            steps = np.r_[np.linalg.norm(np.diff(line, axis=0), axis=1), closing]
            assert steps.max() < 1.15 and steps.min() > 0.7


def test_a_missing_stretch_in_most_copies_is_bridged(rng):
    arc = shapes.circle(25)[:90]
    points, tangents, _ = copies(rng, [arc], [False])
    at = np.tile(np.arange(len(arc)), COPIES)
    keep = (at < 40) | (at > 46) | (np.arange(len(points)) < len(arc))
    weight = np.ones(keep.sum())
    middle, lines = condense(points[keep], tangents[keep], weight, radius=2.5)
    run = np.repeat(np.arange(COPIES), len(arc))[keep]
    out, rings = fit_curves(trace_curves(middle, lines), middle, lines, weight, run)
    assert len(out) == 1 and naive.length(out[0]) == pytest.approx(89, rel=0.06)


def test_condensing_is_the_mean_across_the_curve():
    line = shapes.line(30)
    both = np.concatenate([line + [0, 0.8, 0], line - [0, 0.4, 0]])
    way = np.tile([1.0, 0, 0], (60, 1))
    way[30:] *= -1  # tangents are lines: they have no sense
    kept = both.copy(), way.copy()
    middle, lines = condense(both, way, np.repeat([1.0, 2.0], 30), radius=4.0, rounds=6)
    assert np.abs(middle[:, 1]).max() < 0.1 and np.allclose(middle[:, 0], both[:, 0])
    assert np.allclose(np.abs(lines[:, 0]), 1)
    assert np.array_equal(both, kept[0]) and np.array_equal(way, kept[1])


def test_curves_that_cross_do_not_pull_each_other():
    one, two = shapes.line(31, [-15, 0, 0]), shapes.line(31, [0, -15, 0], [0, 1, 0])
    way = np.repeat([[1.0, 0, 0], [0, 1.0, 0]], 31, axis=0)
    middle, _ = condense(np.concatenate([one, two]), way, np.ones(62), radius=3.0)
    assert np.abs(middle[:31, 1]).max() < 1e-9 and np.abs(middle[31:, 0]).max() < 1e-9


def test_the_longest_shortest_path_is_that_of_all_pairs(rng):
    for _ in range(5):
        curve = shapes.wiggle(rng, 40, bend=0.2)
        way = np.gradient(curve, axis=0)
        graph = _graph(curve, way / np.linalg.norm(way, axis=1)[:, None])
        weight = np.where(graph.toarray() > 0, graph.toarray(), np.inf)
        ways = naive.shortest_ways(weight)
        assert np.isfinite(ways).all()
        path = _longest_shortest_path(graph)
        length = sum(weight[a, b] for a, b in zip(path[:-1], path[1:]))
        assert length == pytest.approx(ways.max())
        assert {int(path[0]), int(path[-1])} == {0, 39}


def naive_own(lines, points, tangents, run, radius, cosine=0.75, most=0.8):
    """For each line the points along it whose run follows no other line for a clearly longer way."""
    ways = [naive.directions(line) for line in lines]
    near = [[k for k, line in enumerate(lines)
             if naive.lies_along(p, w, line, ways[k], radius=radius, cosine=cosine, most=1)[0] >= 0]
            for p, w in zip(points, tangents)]  # fmt: skip
    followed = {}
    for i, there in enumerate(near):
        for k in there:
            followed[run[i], k] = followed.get((run[i], k), 0) + 1
    own = [[] for _ in lines]
    for i, there in enumerate(near):
        for k in there:
            if followed[run[i], k] >= most * max(followed[run[i], other] for other in there):
                own[k].append(i)
    return own


@pytest.mark.parametrize("seed", range(4))
def test_points_belong_to_the_lines_that_their_run_follows(seed):
    """Bows that touch and lines that cross them; each run goes along one of them, with some clutter."""
    rng = np.random.default_rng(seed)
    t = np.linspace(-30, 30, 61)
    bow = np.c_[t, t**2 / 60 + 0.3, 0 * t]
    lines = [bow, bow * [1, -1, 1], shapes.line(40, [-20, -4, 0], [1, 0.25, 0])]
    runs = [c + 0.4 * rng.normal(size=c.shape) for c in lines for _ in range(3)]
    runs = [c[int(rng.integers(0, 20)) :] for c in runs] + [shapes.wiggle(rng, 30) for _ in range(3)]
    order = rng.permutation(len(runs))
    points, run = np.concatenate([runs[k] for k in order]), np.repeat(order, [len(runs[k]) for k in order])
    tangents = np.concatenate([naive.directions(runs[k]) for k in order])
    got = own_points(lines, points, tangents, run, radius=2.0)
    assert [own.tolist() for own in got] == naive_own(lines, points, tangents, run, 2.0)
    for k, own in enumerate(got):
        mine = np.isin(run[own], range(3 * k, 3 * k + 3))
        assert len(own) > 60 and mine.mean() > 0.6
    assert own_points([], points, tangents, run, radius=2.0) == []


def test_few_points():
    assert trace_curves(np.zeros((0, 3)), np.zeros((0, 3))) == []
    assert trace_curves(np.zeros((1, 3)), np.ones((1, 3))) == []
    short = shapes.line(3)
    assert trace_curves(short, np.tile([1.0, 0, 0], (3, 1)), shortest=10) == []
    ways, run = np.tile([1.0, 0, 0], (4, 1)), np.zeros(4, int)
    lines, rings = fit_curves([shapes.line(4)], shapes.line(4), ways, np.ones(4), run)
    assert lines == [] and rings == [], "shorter than what is kept"
