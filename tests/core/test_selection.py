# SPDX-License-Identifier: GPL-3.0-or-later
"""Model selection keeps what a loop keeps that computes every likelihood afresh."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.orbits import Orbit
from core.selection import curve_affinities, eliminate, select_model
from core.support import Screen
from tests import naive
from tests.core import shapes

NULL = 25 * np.exp(-2)


@pytest.mark.parametrize("seed", range(40))
def test_elimination_is_that_of_the_loop(seed):
    rng = np.random.default_rng(seed)
    k, m = int(rng.integers(1, 9)), int(rng.integers(1, 25))
    affinity = rng.gamma(0.6, 12, size=(k, m)) * (rng.random((k, m)) < 0.6)
    ratio = float(rng.choice([1.0, 3.0, 10.0, 1e4]))
    kept, loss, best = eliminate(affinity, NULL, ratio)
    expected, losses = naive.eliminate(affinity.tolist(), NULL, ratio)
    assert kept == expected
    assert np.allclose(loss, losses)
    for c in range(m):
        scores = [affinity[i, c] for i in kept]
        if best[c] == len(kept):
            assert max(scores, default=0) <= NULL
        else:
            assert scores[best[c]] == max(scores) > NULL


@settings(max_examples=60, deadline=None)
@given(st.lists(st.lists(st.sampled_from([0.0, 1.0, 5.0, 20.0]), min_size=4, max_size=4), min_size=1, max_size=6))
def test_ties_keep_a_model_that_is_as_likely(rows):
    affinity = np.array(rows)
    kept, loss, best = eliminate(affinity, NULL, 10.0)
    expected, _ = naive.eliminate(rows, NULL, 10.0)
    mine, theirs = (naive.log_likelihood(rows, alive, NULL) for alive in (kept, expected))
    assert mine == pytest.approx(theirs) and len(kept) == len(expected)
    assert (loss > np.log(10)).all() and len(loss) == len(kept)
    assert kept == sorted(set(kept)) and best.max() <= len(kept)


def test_of_two_equal_transformations_one_stays():
    row = [30.0, 40.0, 20.0]
    kept, loss, best = eliminate(np.array([row, row, row]), NULL, 10.0)
    assert len(kept) == 1 and best.tolist() == [0, 0, 0]
    assert loss[0] == pytest.approx(np.log(np.prod(row) / NULL**3))


def test_the_bayes_ratio_is_the_limit():
    for ratio, stays in ((9.99, True), (10.01, False)):
        kept, loss, best = eliminate(np.array([[NULL * 10.0]]), NULL, ratio)
        assert (kept == [0]) == stays and (best[0] < len(kept)) == stays
    kept, _, best = eliminate(np.zeros((3, 5)), NULL, 1.0)
    assert kept in ([], [0]) and (best == len(kept)).all(), "what explains nothing explains no curve"
    kept, loss, best = eliminate(np.zeros((0, 4)), NULL, 10.0)
    assert kept == [] and len(loss) == 0 and best.tolist() == [0] * 4


def row_of_things(rng, count=4, *, step=(45.0, 0, 0)):
    """A thing at `count` places, a curve of its own, and the translation between neighbours as an orbit."""
    thing, step = shapes.ornament(rng, 4), np.array(step)
    curves = [c + k * step for k in range(count) for c in thing] + [shapes.wiggle(rng, 40, bend=0.4) + [0, 0, 70]]
    net = shapes.network(curves)
    u = shapes.in_frame(net, naive.rigid(shift=step))[:3, 3]
    return net, Orbit("translation", np.r_[0, 0, 0, u][None], np.array([count - 1]), False, 1.0)


def naive_affinity(net, powers, *, radius, least, t):
    """Sum over motions of l exp(-d / (0.5 t)) of the stretch that a sample lies in, averaged over each curve."""
    total = np.zeros(len(net.points))
    for m in powers:
        there, turned = naive.moved(m, net.points), net.tangents @ m[:3, :3].T
        gaps = np.linalg.norm(there[:, None] - net.points[None], axis=2)
        near = gaps.argmin(axis=1)
        same = np.abs((turned * net.tangents[near]).sum(axis=1)) > 0.8
        hit = naive.long_stretches((gaps.min(axis=1) <= radius) & same, net.curve_of, least)
        tells = np.array(hit) & ~np.array(naive.slips(m, net.points, net.tangents, 0.95))
        offset = there - net.points[near]
        away = np.linalg.norm(np.cross(offset, net.tangents[near]), axis=1)
        i = 0
        while i < len(tells):
            k = i
            while k < len(tells) and tells[k] and net.curve_of[k] == net.curve_of[i]:
                k += 1
            if k > i:
                total[i:k] += net.weights[i:k].sum() * np.exp(-away[i:k].mean() / (0.5 * t))
            i = max(k, i + 1)
    return np.array([total[net.curve_of == c].mean() for c in range(len(net))])


def test_affinities_are_those_of_the_stretches(rng):
    net, orbit = row_of_things(rng, 4)
    screen = Screen(net, radius=2.0)
    affinity, hits, _ = curve_affinities(net, orbit, screen, t=2.0)
    least = np.minimum(screen.least, np.diff(net.offsets))[net.curve_of]
    powers = np.array([k * orbit.twists[0, 3:] for k in (-3, -2, -1, 1, 2, 3)])
    expected = naive_affinity(net, [naive.rigid(shift=v) for v in powers], radius=2.0, least=least, t=2.0)
    # The field is exact to half a voxel; chance, which is taken off, is little here.
    assert np.allclose(affinity, expected, atol=0.1 * expected.max())
    assert np.abs(affinity - expected).mean() < 0.05 * expected.mean()
    own = net.source == len(net) - 1
    assert expected[~own].min() > 5 and affinity[own] < 0.2 * net.lengths[own]
    assert np.median(hits[~own[net.curve_of]]) == 3 and hits[own[net.curve_of]].mean() < 0.5


def test_a_motion_and_its_inverse_count_alike(rng):
    net, orbit = row_of_things(rng, 2)
    there = Orbit("single", orbit.twists, np.array([1]), False, 1.0)
    back = Orbit("single", -orbit.twists, np.array([1]), False, 1.0)
    screen = Screen(net, radius=2.0)
    assert np.allclose(
        curve_affinities(net, there, screen, t=2.0)[0], curve_affinities(net, back, screen, t=2.0)[0], atol=2.0
    )


def test_the_true_orbit_stays_and_the_others_go(rng):
    net, orbit = row_of_things(rng, 5)
    screen = Screen(net, radius=2.0)
    twist = orbit.twists
    double = Orbit("translation", 2 * twist, np.array([2]), False, 1.0)
    single = Orbit("single", twist, np.array([1]), False, 1.0)
    wrong = Orbit("single", np.r_[0, 0, 0.4, 3, 8, 20][None], np.array([1]), False, 1.0)
    told = []
    options = {"l0": 25.0, "t": 2.0, "bayes_ratio": 10.0, "progress": lambda *a: told.append(a)}
    model = select_model(net, [double, wrong, orbit, single], screen, **options)
    assert [o is orbit for o in model.orbits] == [True]
    own = net.source == len(net) - 1
    assert (model.of_curve[~own & (net.lengths > 6)] == 0).mean() > 0.9 and model.of_curve[own] == -1
    assert model.log_bayes_factor[0] > np.log(10)
    assert model.support[0] == pytest.approx(net.lengths[~own].sum(), rel=0.15)
    assert {stage for stage, _ in told} == {"selection"} and all(0 <= f <= 1 for _, f in told)
    none = select_model(net, [], screen, **options)
    assert none.orbits == [] and (none.of_curve == -1).all() and none.hits.shape == (0, len(net.points))
