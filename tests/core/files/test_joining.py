# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines joined by position, whatever indices they have."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import NoCurves
from core.files.joining import join
from core.files.reading import Reading, concatenate
from core.values import Curves


def reading(*lines, named=True, kind=None, closed=None):
    curves = Curves.from_list([np.array(line, float) for line in lines], closed)
    source = np.arange(len(lines)) if named else np.full(len(lines), -1)
    values = None if kind is None else np.repeat(kind, [len(line) for line in lines])
    curves = Curves(curves.points, curves.offsets, curves.closed, None, source, None, values)
    return Reading(curves, len(lines) if named else 0)


def flat(*points):
    return [(x, y, 0.0) for x, y in points]


def soup(points, closed=False):
    """Single edges that share no point."""
    pairs = list(zip(points[:-1], points[1:])) + ([(points[-1], points[0])] if closed else [])
    return [flat(a, b) for a, b in pairs]


def lists(read):
    return [read.curves.curve(i)[:, :2].tolist() for i in range(len(read.curves))]


SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def test_edges_with_points_of_their_own_are_one_curve():
    read = join(reading(*soup(SQUARE, closed=True), named=False), 0.0)
    assert lists(read) == [[list(p) for p in SQUARE]]
    assert read.curves.closed.tolist() == [True]
    assert read.count == 1 and read.curves.source.tolist() == [0]
    assert read.shares.length.tolist() == [4]


def test_ends_within_the_tolerance_meet_and_others_do_not():
    lines = flat((0, 0), (1, 0)), flat((1.004, 0.003), (2, 0)), flat((2.02, 0), (3, 0))
    assert lists(join(reading(*lines), 0.01)) == [[[0, 0], [1, 0], [2, 0]], [[2.02, 0], [3, 0]]]
    assert len(join(reading(*lines), 0.03).curves) == 1
    assert len(join(reading(*lines), 0.0).curves) == 3


def test_a_tolerance_beyond_the_spacing_keeps_every_point():
    fine = [(k * 0.001, 0) for k in range(200)]
    for lines in ([flat(*fine)], soup(fine)):
        read = join(reading(*lines, named=False), 5.0)
        assert np.array_equal(read.curves.points[:, 0], [x for x, _ in fine])


def test_a_curve_whose_ends_meet_is_closed():
    read = join(reading(flat(*SQUARE, (1e-4, 0))), 1e-3)
    assert read.curves.closed.tolist() == [True] and len(read.curves.points) == 4


@pytest.mark.parametrize("foot", [(0.5, 0), (0.5, 0.0009), (0.25, 0)])
def test_a_line_is_cut_where_another_ends_on_it(foot):
    read = join(reading(flat((0, 0), (1, 0)), flat(foot, (0.5, 2))), 1e-3)
    at = list(foot)
    assert lists(read) == [[[0, 0], at], [at, [1, 0]], [at, [0.5, 2]]]
    assert read.count == 2 and read.curves.source.tolist() == [0, 0, 1]
    lengths = [np.hypot(*foot), np.hypot(1 - foot[0], foot[1]), np.hypot(0.5 - foot[0], 2)]
    assert read.shares.length == pytest.approx(lengths, rel=1e-3)


def test_a_long_line_is_cut_by_many_and_crossings_without_an_end_are_none():
    posts = [flat((x, 0), (x, 1)) for x in np.arange(1.0, 100)]
    across = flat((-1, 0.5), (101, 0.5))
    read = join(reading(flat((0, 0), (100, 0)), *posts, across), 1e-3)
    assert len(read.curves) == 100 + 99 + 1
    assert read.count == 101


def test_segments_that_are_there_twice_count_once():
    line = flat((0, 0), (1, 0), (2, 1))
    read = join(reading(line, line[::-1], flat((2, 1), (3, 1))), 1e-3)
    assert lists(read) == [[[0, 0], [1, 0], [2, 1], [3, 1]]]
    assert read.count == 3 and read.shares.line.tolist() == [0, 1, 2]


def test_what_overlaps_in_part_counts_once():
    read = join(reading(flat((0, 0), (10, 0)), flat((5, 0), (15, 0))), 1e-3)
    x = np.sort(read.curves.points[:, 0])
    assert lists(read) == [[[0, 0], [5, 0], [10, 0], [15, 0]]] and x.tolist() == [0, 5, 10, 15]


def test_lines_of_two_kinds_are_not_joined():
    lines = flat((0, 0), (1, 0)), flat((1, 0), (2, 0)), flat((2, 0), (3, 0))
    assert len(join(reading(*lines, kind=[0, 1, 1]), 1e-3).curves) == 2


def test_input_curves_are_in_the_order_in_which_they_begin():
    edges = reading(*soup([(0, 0), (1, 0), (2, 0)]), named=False)
    named = reading(flat((0, 5), (1, 5), (2, 5)), flat((7, 7), (7, 7)), flat((0, 9), (3, 9)))
    read = join(concatenate([named, edges, named]), 1e-3)
    # the second of `named` has no length and is an input curve all the same; the last three are there twice
    assert read.count == 7
    assert read.curves.source.tolist() == [0, 2, 3]
    assert set(zip(read.shares.curve.tolist(), read.shares.line.tolist())) == {(0, 0), (1, 2), (2, 3), (0, 4), (1, 6)}


def test_nothing_with_a_length_is_no_curve():
    with pytest.raises(NoCurves):
        join(reading(flat((1, 1), (1, 1))), 1e-3)


def test_the_input_is_not_changed():
    read = reading(*soup(SQUARE))
    kept = read.curves.points.copy(), read.curves.offsets.copy()
    join(read, 1e-3)
    assert np.array_equal(read.curves.points, kept[0]) and np.array_equal(read.curves.offsets, kept[1])


def segments_of(read):
    """Every segment by its ends, however the curves run."""
    out = set()
    for i in range(len(read.curves)):
        p = read.curves.curve(i)
        p = np.r_[p, p[:1]] if read.curves.closed[i] else p
        out |= {frozenset((tuple(a), tuple(b))) for a, b in zip(p[:-1].tolist(), p[1:].tolist())}
    return out


POINT = st.tuples(st.integers(0, 4), st.integers(0, 4))


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(POINT, min_size=2, max_size=6), min_size=1, max_size=8), st.randoms())
def test_edges_or_polylines_in_any_order_give_the_same_segments(lines, random):
    edges = [flat(a, b) for line in lines for a, b in zip(line[:-1], line[1:])]
    if all(a == b for a, b in edges):
        return
    wanted = {frozenset(e) for e in edges if e[0] != e[1]}
    assert segments_of(join(reading(*(flat(*line) for line in lines)), 0.0)) == wanted
    random.shuffle(edges)
    read = join(reading(*edges, named=False), 0.0)
    assert segments_of(read) == wanted
    degree = {}
    for segment in wanted:
        for p in segment:
            degree[p] = degree.get(p, 0) + 1
    for i in range(len(read.curves)):  # curves run on exactly where two segments meet
        inner = read.curves.curve(i)[1:] if read.curves.closed[i] else read.curves.curve(i)[1:-1]
        assert all(degree[tuple(p)] == 2 for p in inner.tolist())
        if not read.curves.closed[i]:
            assert all(degree[tuple(p)] != 2 for p in read.curves.curve(i)[[0, -1]].tolist())
