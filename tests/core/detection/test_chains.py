# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines of a graph against a version that walks them, and hysteresis on its bounds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.detection.chains import chains
from core.detection.lines.hysteresis import clear_segments, without_faint_tails
from tests.core.detection import oracle

GRAPHS = st.lists(st.tuples(st.integers(0, 14), st.integers(0, 14)), max_size=30)


def as_set(found):
    return {
        oracle.named(found.nodes[a:b].tolist(), closed)
        for a, b, closed in zip(found.offsets, found.offsets[1:], found.closed)
    }


@settings(max_examples=200, deadline=None)
@given(GRAPHS)
def test_chains_equal_the_walked_ones(pairs):
    segments = np.array(pairs, np.int64).reshape(-1, 2)
    found = chains(segments, 15)
    assert as_set(found) == oracle.walked_chains(segments)
    assert len(found.following()[0]) == len({tuple(sorted(p)) for p in pairs if p[0] != p[1]})


@pytest.mark.parametrize("n", [3, 4, 1000])
def test_one_loop(n):
    order = np.random.default_rng(n).permutation(n)
    segments = np.stack([order, np.roll(order, -1)], axis=1)
    found = chains(segments[np.random.default_rng(1).permutation(n)], n)
    assert found.closed.tolist() == [True] and as_set(found) == {oracle.named(order.tolist(), True)}


def path(clear, closed=False):
    n = len(clear)
    points = np.column_stack([np.arange(n), np.zeros(n), np.zeros(n)]).astype(float)
    if closed:
        turn = np.arange(n) * 2 * np.pi / n
        points = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]) / (2 * np.sin(np.pi / n))
    segments = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)[: n if closed else n - 1]
    return segments, points, np.array(clear, bool)


def left(clear, bridge, closed=False):
    segments, points, mask = path(clear, closed)
    return {tuple(sorted(s)) for s in clear_segments(segments, points, mask, bridge).tolist()}


def test_a_faint_stretch_between_clear_ones_stays_up_to_the_bound():
    clear = [1, 1, 0, 0, 1, 1]  # from clear to clear the stretch is 3 long
    assert len(left(clear, 3.0)) == 5
    assert left(clear, 2.999) == {(0, 1), (4, 5)}


def test_faint_ends_go():
    assert left([0, 1, 1, 0], 10.0) == {(1, 2)}
    assert left([0, 0, 0], 10.0) == set()
    assert left([0, 1, 0], 10.0) == set()


def test_a_faint_stretch_over_the_start_of_a_loop_is_one():
    clear = [0, 1, 1, 1, 1, 1, 1, 0]
    assert len(left(clear, 3.0001, closed=True)) == 8
    assert left(clear, 2.9, closed=True) == {(i, i + 1) for i in range(1, 6)}


def test_faint_pieces_behind_a_bridge_go_and_those_between_strong_ones_stay():
    segments = np.stack([np.arange(9), np.arange(1, 10)], axis=1)

    def kept(strong, bridge):
        masks = (np.isin(np.arange(10), x) for x in (strong, bridge))
        return sorted({i for s in without_faint_tails(segments, 10, *masks).tolist() for i in s})

    assert kept([1, 8], [4]) == list(range(10))
    assert kept([1], [4]) == [0, 1, 2, 3]
    assert kept([8], [2, 4]) == [5, 6, 7, 8, 9]
    assert kept([5], [2, 8]) == [3, 4, 5, 6, 7]
    assert kept([5], []) == list(range(10))
    assert kept([], [5]) == list(range(10))


def test_nothing_gives_nothing():
    assert len(chains(np.zeros((0, 2), np.int64), 0)) == 0
    assert len(clear_segments(np.zeros((0, 2), np.int64), np.zeros((0, 3)), np.zeros(0, bool), 1.0)) == 0
