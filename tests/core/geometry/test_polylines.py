# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines are resampled as by a loop, and smoothed only as far as they stay what they are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.geometry.polylines import bend, resample_polyline, smooth_polyline, steady_polyline
from tests import naive
from tests.core import shapes


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.1, 5), st.booleans())
def test_resampling_is_that_of_the_loop(seed, step, closed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(4, 12)), 3)) * 10
    if rng.random() < 0.3:
        points = np.repeat(points, 2, axis=0)
    got = resample_polyline(points, step, closed)
    assert np.allclose(got, naive.resample(points, step, closed))


def test_smoothing_keeps_ends_lines_and_the_number_of_samples(rng):
    line = shapes.line(30)
    assert np.allclose(smooth_polyline(line, 2.0, False), line)
    curve = shapes.wiggle(rng, 40, bend=0.3) + 0.3 * rng.normal(size=(40, 3))
    smooth = smooth_polyline(curve, 2.0, False)
    assert smooth.shape == curve.shape and np.allclose(smooth[[0, -1]], curve[[0, -1]])
    assert np.abs(np.diff(smooth, 2, axis=0)).mean() < 0.3 * np.abs(np.diff(curve, 2, axis=0)).mean()
    ring = shapes.circle(10)
    assert np.allclose(np.linalg.norm(smooth_polyline(ring, 1.0, True), axis=1), 10, atol=0.1)
    assert np.array_equal(smooth_polyline(curve, 0, False), curve)


def rms(points):
    return float(np.sqrt((points**2).sum(axis=1).mean()))


@pytest.mark.parametrize("noise", [0.1, 0.3])
def test_what_is_steadied_is_less_noisy(rng, noise):
    for truth, ring in ((shapes.line(90, way=[1, 2, 3]), False), (shapes.circle(60), True)):
        off = noise * rng.normal(size=truth.shape)
        # the noise across a straight line; along it samples just slide
        away = [[naive.distance_to_polyline(p, truth, ring) for p in line]
                for line in (truth + off, steady_polyline(truth + off, ring))]  # fmt: skip
        assert np.mean(away[1]) < 0.35 * np.mean(away[0])


def test_what_is_steadied_stays_what_it_is(rng):
    """A ring keeps its radius and a corner stays one: smoothing stops where it would change them."""
    ring = shapes.circle(10)
    assert np.abs(np.linalg.norm(steady_polyline(ring, True), axis=1) - 10).max() < 0.1
    noisy = ring + 0.15 * rng.normal(size=ring.shape)
    assert np.abs(np.linalg.norm(steady_polyline(noisy, True)[:, :2], axis=1) - 10).mean() < 0.1
    corner = np.concatenate([shapes.line(40, way=[-1, 0, 0])[::-1], shapes.line(40, way=[0, 1, 0])[1:]])
    after = steady_polyline(corner, False)
    gaps = np.linalg.norm(after - corner, axis=1)
    assert 0.2 < gaps.max() < 1.5 and rms(after - corner) < 0.6
    assert gaps[[10, 20, -20, -10]].max() < 0.1, "only the corner is rounded off"


def test_how_far_a_line_may_be_moved(rng):
    for curve, ring in (
        (shapes.wiggle(rng, 150, bend=0.4), False),
        (shapes.circle(6), True),
        (shapes.circle(31), True),
    ):
        curve = curve + 0.2 * rng.normal(size=curve.shape)
        kept = curve.copy()
        after = steady_polyline(curve, ring)
        assert after.shape == curve.shape and np.array_equal(curve, kept)
        assert rms(after - curve) <= 0.6 and np.linalg.norm(after - curve, axis=1).max() <= 1.5
        assert ring or np.allclose(after[[0, -1]], curve[[0, -1]]), "ends stay"
    jagged = shapes.line(60) + np.resize([1.2, -1.2], 60)[:, None] * [0, 1, 0]
    assert np.array_equal(steady_polyline(jagged, False), jagged), "what would move by more stays"
    assert not np.array_equal(steady_polyline(jagged, False, off=2.0, most=3.0), jagged)
    spike = shapes.line(60)
    spike[30, 1] = 2.0
    assert np.array_equal(steady_polyline(spike, False), spike)
    assert not np.array_equal(steady_polyline(spike, False, most=2.5), spike)


@pytest.mark.parametrize("count, changes", [(8, False), (9, True)])
def test_short_lines_are_not_steadied(rng, count, changes):
    line = shapes.line(count) + 0.1 * rng.normal(size=(count, 3))
    assert np.array_equal(steady_polyline(line, False), line) != changes


def test_the_bend_is_the_distance_from_one_parabola(rng):
    t = np.linspace(-1, 1, 18)
    parabola = np.c_[9 * t, 0.5 * t**2, np.zeros(18)]
    assert bend(parabola[8::-1], parabola[9:]) < 0.02
    corner = shapes.line(9, way=[-1, 0, 0]), shapes.line(9, [0, 1, 0], [0, 1, 0])
    assert bend(*corner) > 0.3
    assert bend(*corner) == pytest.approx(bend(*corner[::-1]))
