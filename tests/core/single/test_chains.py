# SPDX-License-Identifier: GPL-3.0-or-later
"""Chains of pieces, and the stretches of them that are kept, against trying all."""

from itertools import product

import numpy as np
import pytest

from core.single.chains import best_stretches, chains_of


def partners(count, links):
    partner = np.full(2 * count, -1)
    for a, b in links:
        partner[a], partner[b] = b, a
    return partner


def test_each_piece_is_in_one_chain():
    chains = chains_of(partners(5, [(1, 3), (2, 8)]))
    assert sorted(sorted(e // 2 for e in chain) for chain, _ in chains) == [[0, 1, 4], [2], [3]]
    assert not any(closed for _, closed in chains)
    chain = next(c for c, _ in chains if len(c) == 3)
    assert chain in ([0, 3, 8], [9, 2, 1])


def test_chains_that_come_round_are_closed():
    ((chain, closed),) = chains_of(partners(3, [(1, 2), (3, 4), (5, 0)]))
    assert closed and chain == [0, 2, 4]
    ((chain, closed),) = chains_of(partners(1, [(0, 1)]))
    assert closed and chain == [0]


def by_trial(value, link, least):
    """Greatest sum of any choice of pieces; links count between neighbours that are both in, stretches cost `least`."""
    best = 0.0
    for inside in product((False, True), repeat=len(value)):
        total, before = 0.0, False
        for k, now in enumerate(inside):
            if now:
                total += value[k] + (link[k - 1] if before else -least)
            before = now
        best = max(best, total)
    return best


@pytest.mark.parametrize("least", [0.0, 1.5])
def test_stretches_are_the_best_of_all(rng, least):
    for _ in range(60):
        n = int(rng.integers(1, 9))
        odds, worth = rng.normal(scale=4, size=n), np.zeros(2 * n)
        link = rng.exponential(2, size=n)
        for k in range(n - 1):
            worth[2 * k + 1] = worth[2 * k + 2] = link[k]
        got = best_stretches([2 * k for k in range(n)], False, odds, worth, least)
        assert sum(total - least for _, _, total in got) == pytest.approx(by_trial(odds, link, least))
        for run, _, total in got:
            own = [e // 2 for e in run]
            assert own == list(range(own[0], own[-1] + 1))
            assert total == pytest.approx(odds[own].sum() + link[own[:-1]].sum()) and total > least


def test_weak_pieces_carry_each_other_on():
    odds, worth = np.array([-1.0, -1.0, -1.0]), np.array([0, 2.0, 2.0, 2.0, 2.0, 0])
    ((run, _, total),) = best_stretches([0, 2, 4], False, odds, worth, 0.0)
    assert run == [0, 2, 4] and total == pytest.approx(1.0)
    assert not best_stretches([0, 2, 4], False, odds, worth / 2, 0.0)


def test_a_ring_is_whole_or_cut_at_its_worst_piece():
    worth = np.full(6, 1.0)
    ((run, closed, _),) = best_stretches([0, 2, 4], True, np.array([3.0, -1.5, 2.0]), worth, 0.0)
    assert closed and sorted(run) == [0, 2, 4]
    ((run, closed, total),) = best_stretches([0, 2, 4], True, np.array([3.0, -9.0, 2.0]), worth, 0.0)
    assert not closed and run == [4, 0] and total == pytest.approx(6.0)
