# SPDX-License-Identifier: GPL-3.0-or-later
"""The network is the same whatever pose, scale, order and direction the curves come in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.network.building import build_network, faithful_smoothing
from core.network.edge_length import estimate, estimate_edge_length
from core.values import Curves
from tests import naive
from tests.core import shapes

FIELDS = ("points", "tangents", "weights", "offsets", "closed", "curve_of", "strength")


def scene(rng):
    """Curves of different lengths, a ring and a straight one, with strengths."""
    curves = [shapes.wiggle(rng, n, bend=0.3) + rng.normal(size=3) * 20 for n in (50, 40, 31, 17, 5)]
    curves += [shapes.circle(7, [3, 20, 1]), shapes.line(12, [-9, 3, 3], [1, 2, 3])]
    strength = [rng.uniform(0, 1, size=len(c)) for c in curves]
    return curves, [False] * 5 + [True, False], strength


def close(a, b, *, scale=1.0):
    for name in FIELDS:
        assert np.allclose(getattr(a, name), getattr(b, name), atol=1e-6 * scale, equal_nan=True), name


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-3, 1e3), st.booleans())
def test_pose_scale_order_and_direction_do_not_matter(seed, scale, smooth):
    rng = np.random.default_rng(seed)
    curves, closed, strength = scene(rng)
    smoothing = 1.5 if smooth else 0.0
    first = build_network(Curves.from_list(curves, closed, strength), edge_length=1.0, smoothing=smoothing)
    m = shapes.random_motion(rng, 100)
    order = rng.permutation(len(curves))
    other, also = [], []
    for i in order:
        c, s = scale * naive.moved(m, curves[i]), strength[i] / scale
        if rng.random() < 0.5:
            c, s = c[::-1], s[::-1]
        other.append(c)
        also.append(s)
    second = build_network(
        Curves.from_list(other, np.array(closed)[order], also), edge_length=scale, smoothing=smoothing
    )
    for name in ("offsets", "closed", "curve_of"):
        assert np.array_equal(getattr(first, name), getattr(second, name))
    assert np.array_equal(order[second.source], first.source)
    open_ = ~first.closed[first.curve_of]
    for name in ("points", "tangents", "weights"):
        assert np.allclose(getattr(first, name)[open_], getattr(second, name)[open_], atol=1e-6), name
    # a ring read the other way round is sampled from the same point on, but between other corners
    assert np.allclose(first.points[~open_], second.points[~open_], atol=1e-6)
    assert np.allclose(first.strength, second.strength)
    world = second.to_world(second.points)
    assert np.allclose(world, scale * naive.moved(m, first.to_world(first.points)), atol=1e-6 * scale)


def test_far_from_the_origin_it_is_the_same_to_rounding(rng):
    curves, closed, strength = scene(rng)
    here = build_network(Curves.from_list(curves, closed, strength), edge_length=1.0)
    there = [c + [1e7, -1e7, 1e7] for c in curves]
    far = build_network(Curves.from_list(there, closed, strength), edge_length=1.0)
    close(here, far)
    assert np.allclose(far.to_world(far.points) - [1e7, -1e7, 1e7], here.to_world(here.points), atol=1e-6)


def test_samples_lie_on_the_curves_one_edge_length_apart(rng):
    curves, closed, _ = scene(rng)
    net = build_network(Curves.from_list(curves, closed), edge_length=1.0, smoothing=0.0)
    assert len(net) == len(curves) and sorted(net.source) == list(range(len(curves)))
    world = net.to_world(net.points)
    for i in range(len(net)):
        c, ring = curves[net.source[i]], closed[net.source[i]]
        assert net.closed[i] == ring
        p = world[net.offsets[i] : net.offsets[i + 1]]
        whole = naive.length(c, ring)
        assert len(p) == round(whole) + (not ring)
        # no farther from the curve than two resamplings may cut a corner
        assert max(naive.distance_to_polyline(q, c, ring) for q in p) < 0.1
        steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
        assert steps.max() < 1.1 and steps.min() > 0.7
        assert net.lengths[i] == pytest.approx(whole, rel=0.03)
        if not ring:
            ends = [p[0], p[-1]]
            assert min(np.abs(ends - c[[0, -1]]).max(), np.abs(ends - c[[-1, 0]]).max()) < 1e-5


def test_tangents_weights_and_centre(rng):
    curves, closed, _ = scene(rng)
    net = build_network(Curves.from_list(curves, closed), edge_length=1.0, smoothing=0.0)
    assert np.allclose(np.linalg.norm(net.tangents, axis=1), 1)
    i = 40  # within a curve
    assert net.curve_of[i - 1] == net.curve_of[i + 1]
    way = net.points[i + 1] - net.points[i - 1]
    assert np.allclose(net.tangents[i], way / np.linalg.norm(way))
    middle, total = np.zeros(3), 0.0
    for c, ring in zip(curves, closed):
        for p, q in zip(c, [*c[1:], c[0]] if ring else c[1:]):
            middle, total = middle + (p + q) / 2 * np.linalg.norm(q - p), total + np.linalg.norm(q - p)
    assert np.allclose(net.centre, middle / total)
    assert np.allclose(net.rotation @ net.rotation.T, np.eye(3)) and np.linalg.det(net.rotation) > 0


def test_motions_are_taken_to_the_world(rng):
    curves, closed, _ = scene(rng)
    net = build_network(Curves.from_list(curves, closed), edge_length=0.5)
    m = shapes.random_motion(rng)
    world = net.motion_to_world(m[None])[0]
    assert np.allclose(naive.moved(world, net.to_world(net.points)), net.to_world(naive.moved(m, net.points)))
    assert np.allclose(world[:3, :3] @ world[:3, :3].T, np.eye(3))


def test_strength_is_the_average_of_the_curve(rng):
    curves, closed, strength = scene(rng)
    net = build_network(Curves.from_list(curves, closed, [-s for s in strength]), edge_length=2.0)
    for i, s in zip(net.source, net.strength):
        assert s == pytest.approx(2.0 * strength[i].mean())
    assert np.isnan(build_network(Curves.from_list(curves, closed), edge_length=2.0).strength).all()


def test_the_edge_length_is_estimated():
    curves = [shapes.line(20) * 0.02, shapes.line(9) * 0.02, np.array([[0, 0, 0], [1.0, 0, 0]])]
    assert estimate_edge_length(Curves.from_list(curves)) == pytest.approx(0.02)
    doubled = Curves.from_list([np.repeat(c, 3, axis=0) for c in curves])
    assert estimate_edge_length(doubled) == pytest.approx(0.02), "points that are given twice do not count"


def drawn(count=5, arc=12):
    """Polylines of a row of windows from corner to corner; the frames are 1.2 by 1.8, the arches 0.8 wide."""
    t = np.linspace(0, np.pi, arc + 1)
    frame = np.array([(0, 0, 0), (1.2, 0, 0), (1.2, 0, 1.8), (0, 0, 1.8), (0, 0, 0)])
    inner = np.array([(0.2, 0, 0.2), (0.2, 0, 1.2), *np.c_[0.6 - 0.4 * np.cos(t), 0 * t, 1.2 + 0.4 * np.sin(t)][1:]])
    cornice = np.array([(-1, 0, 2.5), (2.2 * count, 0, 2.5)])
    return [line + [2.2 * i, 0, 0] for i in range(count) for line in (frame, inner)] + [cornice]


def single_lines(curves):
    return [np.stack(pair) for c in curves for pair in zip(c[:-1], c[1:])]


@pytest.mark.parametrize("arc", [9, 12])
def test_of_a_drawing_it_is_a_share_of_the_outlines(arc):
    found = estimate(Curves.from_list(drawn(arc=arc)))
    # five frames, five smaller lines within them, and the cornice: the frame is in the middle
    assert found.outline == pytest.approx(np.hypot(1.2, 1.8)) and found.length == pytest.approx(found.outline / 50)
    assert found.spread[1] > 4 * found.spread[0]


def test_arcs_of_short_chords_keep_them():
    found = estimate(Curves.from_list(drawn(arc=36)))
    chord = 0.8 * np.sin(np.pi / 72)
    assert found.outline is None and found.length == pytest.approx(chord) and found.spread[0] == pytest.approx(chord)


def test_it_does_not_depend_on_how_a_drawing_is_written_or_stands(rng):
    curves = drawn()
    wanted = estimate(Curves.from_list(curves)).length
    assert estimate(Curves.from_list(single_lines(curves))).length == pytest.approx(wanted)
    assert estimate(Curves.from_list([c[::-1] for c in curves[::-1]])).length == pytest.approx(wanted, rel=0.1)
    m = shapes.random_motion(rng)
    assert estimate(Curves.from_list([1000 * naive.moved(m, c) for c in curves])).length == pytest.approx(1000 * wanted)
    far = Curves.from_list([c + [4e5, 5e6, 0] for c in single_lines(curves)])
    assert estimate(far).length == pytest.approx(wanted, rel=1e-3)


def test_equal_lines_are_a_drawing_too_and_lines_that_meet_in_cells_as_well():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), (0, 0, 0)], float)
    found = estimate(Curves.from_list([square + [2 * i, 0, 0] for i in range(6)]))
    assert found.outline == pytest.approx(np.sqrt(2)) and found.length == pytest.approx(np.sqrt(2) / 50)
    cells = [np.array([(i, 0, j), (i + 1, 0, j)], float) for i in range(9) for j in range(4)]
    cells += [np.array([(i, 0, j), (i, 0, j + 1)], float) for i in range(10) for j in range(3)]
    assert estimate(Curves.from_list(cells)).length == pytest.approx(1 / 50)


def test_scans_and_fine_polylines_keep_their_median_segment(rng):
    along = np.cumsum(rng.gamma(8, 0.05 / 8, 200))
    scanned = [np.c_[along, np.sin(along), 0 * along]] * 3
    found = estimate(Curves.from_list(scanned))
    assert found.outline is found.spread is None
    assert found.length == pytest.approx(np.median(np.linalg.norm(np.diff(scanned[0], axis=0), axis=1)))
    assert estimate(Curves.from_list(single_lines(scanned))).length == pytest.approx(found.length)
    # decimated: long and short edges, but many of them on each curve
    uneven = np.cumsum(rng.choice([0.01, 0.02, 0.2], 400))
    found = estimate(Curves.from_list([np.c_[uneven, 0 * uneven, 0 * uneven]]))
    assert found.outline is None and found.length == pytest.approx(0.02) and found.spread is not None


def test_a_drawing_of_dots_gets_no_more_samples_than_can_be_used(rng):
    dots = [np.array([p, p + [0.001, 0, 0]]) for p in rng.uniform(0, 100, (50, 3))]
    lines = [np.array([(0, 0, 5 * i), (100, 0, 5 * i)], float) for i in range(20)]
    curves = Curves.from_list(dots + lines)
    assert 2000 / estimate(curves).length == pytest.approx(50_000, rel=0.01)


def test_crossings_of_triangles_give_their_edge_length(rng):
    # random lines across equilateral triangles of side 3: a direction at random, then a place across it
    corners = np.array([[0, 0], [3, 0], [1.5, 3 * np.sqrt(0.75)]])
    middle, chords = corners.mean(axis=0), []
    for _ in range(20_000):
        angle = rng.uniform(0, np.pi)
        normal, offset = np.array([np.cos(angle), np.sin(angle)]), rng.uniform(-2, 2)
        side = (corners - middle) @ normal - offset
        cut = [
            corners[i] + (corners[j] - corners[i]) * side[i] / (side[i] - side[j])
            for i, j in ((0, 1), (1, 2), (2, 0))
            if side[i] * side[j] < 0
        ]
        if cut:
            chords.append(np.c_[np.array(cut), [0, 0]])
    assert estimate_edge_length(Curves.from_list(chords), crossings=True) == pytest.approx(3, rel=0.02)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_coordinates_that_are_no_numbers_are_named(value):
    curves = [shapes.line(5), shapes.line(5)]
    curves[1][2, 0] = value
    with pytest.raises(InputError, match=r"curve 1 has the coordinates \[.*(nan|inf)"):
        build_network(Curves.from_list(curves), edge_length=1.0)


@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_a_bad_edge_length_is_named(value):
    with pytest.raises(InputError, match="edge length is .*: give a length above 0"):
        build_network(Curves.from_list([shapes.line(5)]), edge_length=value)


@pytest.mark.parametrize("curves", [[], [[[1.0, 2, 3]]], [[[1.0, 2, 3]] * 4], [[[1.0, 2, 3]], [[4.0, 5, 6]]]], ids=str)
def test_curves_without_length_are_refused(curves):
    curves = Curves.from_list([np.array(c, float) for c in curves])
    with pytest.raises(InputError, match="no curve"):
        build_network(curves, edge_length=1.0)
    with pytest.raises(InputError, match="no curve"):
        estimate_edge_length(curves)


def test_too_short_an_edge_length_is_refused_before_it_fills_the_memory():
    with pytest.raises(InputError, match="50 million"):
        build_network(Curves.from_list([shapes.line(1000)]), edge_length=1e-9)


def test_curves_without_length_are_left_out(rng):
    curves = [np.ones((1, 3)), shapes.wiggle(rng, 30), np.ones((5, 3)), np.zeros((0, 3)), shapes.line(8)]
    net = build_network(Curves.from_list(curves, [False, False, True, False, False]), edge_length=1.0)
    assert sorted(net.source) == [1, 4] and np.isfinite(net.points).all() and np.isfinite(net.tangents).all()


def test_the_input_is_not_modified(rng):
    curves, closed, strength = scene(rng)
    given_ = Curves.from_list(curves, closed, strength)
    for array in (given_.points, given_.offsets, given_.closed, given_.strength, given_.source):
        array.flags.writeable = False
    build_network(given_, edge_length=1.0)


def test_every_tangent_is_a_direction():
    """Also in tiny loops, and where a curve goes back the way it came."""
    loop = np.array([[0, 0, 0], [0.9, 0.1, 0], [0, 0, 0]])
    spike = np.concatenate([np.linspace([0, 5, 0], [9, 5, 0], 10), np.linspace([8, 5, 0], [0, 5, 0], 9)])
    long = np.linspace([0, 10, 0], [40, 10, 0], 41)
    net = build_network(Curves.from_list([loop, spike, long, loop * 0.3 + 3]), edge_length=1.0, smoothing=0.0)
    assert np.allclose(np.linalg.norm(net.tangents, axis=1), 1)


@pytest.mark.parametrize("noise", [0.0, 0.25, 0.5])
def test_drawing_smooths_as_noise_asks(rng, noise):
    rings = [shapes.circle(20.0, [60 * k, 0, 0]) for k in range(4)]
    curves = Curves.from_list([ring + noise * rng.normal(size=ring.shape) for ring in rings])
    width = faithful_smoothing(curves, edge_length=1.0, most=3.0)
    larger = Curves.from_list([7.0 * curves.curve(i) for i in range(4)])
    assert faithful_smoothing(larger, edge_length=7.0, most=3.0) == width
    assert width == 0.75 if noise == 0 else 1.0 < width <= 3.0
    assert faithful_smoothing(curves, edge_length=1.0, most=0.5) == 0.5


def test_more_noise_asks_for_more_smoothing(rng):
    def width(noise):
        lines = [shapes.line(120, (0, 30 * k, 0)) + noise * rng.normal(size=(120, 3)) for k in range(5)]
        return faithful_smoothing(Curves.from_list(lines), edge_length=1.0, most=5.0)

    assert width(0.1) < width(0.3) < width(0.9)
