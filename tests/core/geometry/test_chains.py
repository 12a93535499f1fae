# SPDX-License-Identifier: GPL-3.0-or-later
"""Graphs into curves, against a loop that walks them edge by edge."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.chains import chains_of_edges, split_paths

EDGES = st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=30)


def lists(chains):
    """[(vertices, closed, source), ...]"""
    parts = np.split(chains.vertices, chains.offsets[1:-1]) if len(chains) else []
    return [(p.tolist(), bool(c), int(s)) for p, c, s in zip(parts, chains.closed, chains.source)]


def edges_of(vertices, closed):
    ring = [*vertices, vertices[0]] if closed else vertices
    return {frozenset(pair) for pair in zip(ring[:-1], ring[1:])}


def walked(edges):
    """The same chains as sets of edges, found one step at a time."""
    left = {frozenset(e) for e in edges if e[0] != e[1]}
    beside = {}
    for edge in left:
        for v in edge:
            beside.setdefault(v, set()).update(edge - {v})
    chains = set()
    stops = [v for v in beside if len(beside[v]) != 2]
    for start in [*stops, *beside]:  # what is left after all stops are loops
        for onward in sorted(beside[start]):
            if frozenset((start, onward)) not in left:
                continue
            chain, before, here = set(), start, onward
            while True:
                chain.add(frozenset((before, here)))
                left.discard(frozenset((before, here)))
                if here == start or len(beside[here]) != 2:
                    break
                before, here = here, next(iter(beside[here] - {before}))
            chains.add(frozenset(chain))
    return chains


@given(EDGES)
def test_chains_are_those_of_a_walk(edges):
    chains = lists(chains_of_edges(np.array(edges, int).reshape(-1, 2)))
    assert {frozenset(edges_of(v, c)) for v, c, _ in chains} == walked(edges)
    assert sum(len(edges_of(v, c)) for v, c, _ in chains) == len({frozenset(e) for e in edges if e[0] != e[1]})


@given(EDGES)
def test_chains_come_in_the_order_of_their_first_edges(edges):
    rank = {}
    for i, edge in enumerate(edges):
        rank.setdefault(frozenset(edge), i)
    firsts = [min(rank[e] for e in edges_of(v, c)) for v, c, _ in lists(chains_of_edges(edges))]
    assert firsts == sorted(firsts)


@pytest.mark.parametrize(
    ("edges", "expected"),
    [
        ([], []),
        ([(4, 4)], []),
        ([(0, 1)], [([0, 1], False)]),
        ([(0, 1), (1, 0)], [([0, 1], False)]),
        ([(0, 1), (1, 2), (2, 0)], [([0, 1, 2], True)]),
        ([(0, 1), (1, 2), (1, 3)], [([0, 1], False), ([1, 2], False), ([1, 3], False)]),
        # A loop on a stalk stays closed and begins at its junction.
        ([(0, 1), (1, 2), (2, 3), (3, 1)], [([0, 1], False), ([1, 2, 3], True)]),
    ],
)
def test_small_graphs(edges, expected):
    assert [(v, c) for v, c, _ in lists(chains_of_edges(edges))] == expected


def test_a_long_loop_in_any_order_of_its_edges():
    n = 1000
    edges = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)
    chains = chains_of_edges(np.random.default_rng(0).permutation(edges))
    assert len(chains) == 1 and chains.closed[0]
    steps = np.diff(np.r_[chains.vertices, chains.vertices[0]]) % n
    assert set(steps.tolist()) in ({1}, {n - 1})


def paths(*vertices):
    return np.concatenate(vertices), np.cumsum([0, *map(len, vertices)])


def test_paths_that_do_not_meet_stay_whole():
    chains = split_paths(*paths([0, 1, 2], [5, 6, 7, 8, 5], [9, 10]))
    assert lists(chains) == [([0, 1, 2], False, 0), ([5, 6, 7, 8], True, 1), ([9, 10], False, 2)]


def test_a_path_is_cut_where_another_ends_in_it():
    chains = split_paths(*paths([0, 1, 2, 3], [2, 5]))
    assert lists(chains) == [([0, 1, 2], False, 0), ([2, 3], False, 0), ([2, 5], False, 1)]


def test_paths_that_cross_are_both_cut_and_ends_that_meet_are_not_joined():
    chains = split_paths(*paths([0, 1, 2], [3, 1, 4], [4, 6]))
    assert [(v, s) for v, _, s in lists(chains)] == [([0, 1], 0), ([1, 2], 0), ([3, 1], 1), ([1, 4], 1), ([4, 6], 2)]


def test_the_same_path_twice_is_two_curves():
    assert [(v, s) for v, _, s in lists(split_paths(*paths([0, 1, 2], [2, 1, 0])))] == [([0, 1, 2], 0), ([2, 1, 0], 1)]


def test_a_loop_is_cut_at_its_junctions_only():
    ring = [7, 8, 9, 10, 7]
    assert lists(split_paths(*paths(ring, [9, 20])))[0] == ([9, 10, 7, 8], True, 0)
    assert lists(split_paths(*paths(ring, [9, 20], [8, 21])))[:2] == [([8, 9], False, 0), ([9, 10, 7, 8], False, 0)]


def test_the_input_is_not_changed():
    edges = np.array([(0, 1), (2, 1), (2, 0)])
    kept = edges.copy()
    chains_of_edges(edges)
    assert (edges == kept).all()
