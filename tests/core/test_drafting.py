# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves are drafted where enough occurrences agree, once each, and occurrences are moved onto what shows them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.drafting import (
    CHANCE_SHARE,
    agreed,
    consolidate,
    consolidate_places,
    least_agreement,
    one_of_each,
    one_period,
    refined_poses,
)  # fmt: skip
from core.orbits import Orbit
from core.overlay import fold_orbit
from tests import naive
from tests.core import shapes

STEP = np.array([45.0, 4, 0])


# ---- what is agreed on


def naive_agreed(count, least, run, few):
    """Samples that are agreed on: each is looked at alone, its stretch followed to both sides."""
    n, low = len(count), max(1, -(-least // 2))
    keep = [False] * n
    for i in range(n):
        if count[i] < low:
            continue
        for step in (-1, 1):
            k = i
            while 0 <= k < n and run[k] == run[i] and count[k] >= low:
                keep[i] |= bool(count[k] >= least)
                k += step
    if not few:
        return keep
    mostly = []
    for i in range(n):
        mine = [keep[k] for k in range(n) if run[k] == run[i]]
        mostly.append(keep[i] or sum(mine) >= len(mine) / 2)
    return mostly


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_what_is_agreed_on_is_that_of_the_loop(data):
    n = data.draw(st.integers(1, 30))
    count = np.array(data.draw(st.lists(st.integers(0, 5), min_size=n, max_size=n)))
    run = np.cumsum(data.draw(st.lists(st.integers(0, 2), min_size=n, max_size=n)))
    least, few = data.draw(st.integers(1, 6)), data.draw(st.booleans())
    assert agreed(count, least, run, few).tolist() == naive_agreed(count, least, run, few)


def test_agreement_is_carried_along_the_curve_and_not_over_its_end():
    count = np.array([1, 2, 2, 4, 2, 1, 2, 2, 2, 2])
    run = np.array([0, 0, 0, 0, 0, 0, 0, 0, 1, 1])
    assert agreed(count, 4, run).tolist() == [False, True, True, True, True, False, False, False, False, False]
    # four of eight are half of the run
    assert agreed(count, 4, run, few=True).tolist() == [True] * 8 + [False] * 2
    assert agreed(np.append(count[:8], 1), 4, np.zeros(9, int), few=True).tolist()[0] is False
    assert not agreed(np.zeros(5, int), 1, np.zeros(5, int), few=True).any()


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_the_least_agreement_leaves_a_tenth_to_chance(data):
    n = data.draw(st.integers(1, 25))
    count, wrong = (np.array(data.draw(st.lists(st.integers(0, 4), min_size=n, max_size=n))) for _ in range(2))
    weight = np.array(data.draw(st.lists(st.integers(0, 3), min_size=n, max_size=n)), float)
    expected = None
    for least in range(1, max(count) + 1):
        seen = sum(w for c, w in zip(count, weight) if c >= least)
        chance = sum(w for c, w in zip(wrong, weight) if c >= least)
        if expected is None and chance <= CHANCE_SHARE * seen:
            expected = least
    assert least_agreement(count, wrong, weight) == (expected or max(1, max(count)))


def test_chance_may_be_just_a_tenth():
    count, weight = np.repeat([3, 1], 10), np.ones(20)
    wrong = np.zeros(20, int)
    wrong[:2] = 1
    assert least_agreement(count, wrong, weight) == 1
    wrong[:3] = 1
    assert least_agreement(count, wrong, weight) == 2
    assert least_agreement(np.zeros(0, int), np.zeros(0, int), np.zeros(0)) == 1


# ---- one of each


def row_orbit(step=(30, 0, 0), second=None):
    twists = [[0, 0, 0, *step]] + ([] if second is None else [[0, 0, 0, *second]])
    return Orbit(
        "translation" if second is None else "grid", np.array(twists, float), np.full(len(twists), 4), False, 1
    )


def images(orbit):
    """Motions to the cell itself and to those around it, one after the other."""
    out = []
    for k in product((-1, 0, 1), repeat=len(orbit.twists)):
        out.append(naive.rigid(shift=sum(n * t[3:] for n, t in zip(k, orbit.twists))))
    return out


def naive_one_of_each(curves, orbit, points, inner, radius=2.5, covered=0.6):
    """Indices of the curves that are kept, by distances between all pairs of points."""
    own = [sum(int(inner[naive.nearest(points, p)[0]]) for p in c) for c in curves]
    left, kept = list(range(len(curves))), []
    while left:
        best = left[0]
        for k in left[1:]:
            if (len(curves[k]) // 4, own[k]) > (len(curves[best]) // 4, own[best]):
                best = k
        left.remove(best)
        shown = 0
        for p in curves[best]:
            away = [naive.nearest(naive.moved(m, curves[k]), p)[1] for k in kept for m in images(orbit)]
            shown += bool(away) and min(away) < radius
        if own[best] and shown <= covered * len(curves[best]):
            kept.append(best)
    return kept


@pytest.mark.parametrize("second", [None, (3, 28, 0)], ids=["row", "grid"])
@pytest.mark.parametrize("seed", range(4))
def test_one_of_each_is_that_of_the_loop(seed, second):
    rng = np.random.default_rng(seed)
    orbit = row_orbit(second=second)
    things = [shapes.wiggle(rng, int(rng.integers(8, 22)), bend=0.3) + rng.uniform(0, 25, size=3) for _ in range(4)]
    curves = []
    for c in things:
        # what the cell and its margins show of a thing: images of it, each with other ends and a little off
        for m in rng.permutation(images(orbit))[: int(rng.integers(1, 4))]:
            low, high = rng.integers(0, 4), len(c) - rng.integers(0, 4)
            curves.append(naive.moved(m, c[low:high]) + 0.3 * rng.normal(size=3))
    points = np.concatenate(curves)
    inner = (points[:, 0] > 0) & (points[:, 0] < 30)
    out, rings = one_of_each(curves, [False] * len(curves), orbit, points, inner)
    kept = naive_one_of_each(curves, orbit, points, inner)
    assert [next(k for k, c in enumerate(curves) if c is line) for line in out] == kept
    assert rings == [False] * len(kept) and 1 < len(kept) < len(curves)


def test_rings_stay_rings_and_what_lies_in_the_margin_only_is_left_out():
    orbit = row_orbit()
    ring, outside = shapes.circle(5, [15, 0, 0]), shapes.line(12, [40, 20, 0])
    points = np.concatenate([ring, outside])
    out, rings = one_of_each([outside, ring], [False, True], orbit, points, points[:, 0] < 30)
    assert rings == [True] and len(out) == 1 and out[0] is ring
    assert one_of_each([], [], orbit, points, points[:, 0] < 30) == ([], [])


@pytest.mark.parametrize("shared, kept", [(12, 2), (13, 1)])
def test_how_much_of_a_curve_others_may_show(shared, kept):
    """Twelve of twenty samples are just the share that may be covered."""
    one = shapes.line(40)
    two = shapes.line(20, [42 - shared, 0.0, 0])  # two edges beyond its end the first one is within the radius
    out, _ = one_of_each([one, two], [False] * 2, row_orbit((0, 300, 0)), one, np.ones(40, bool))
    assert len(out) == kept


def test_a_curve_through_all_cells_is_cut_to_one_period():
    orbit = row_orbit()
    cornice = shapes.line(75, [-10, 3, 1])
    for line in (cornice, cornice[::-1]):
        cut = one_period(line, orbit)
        assert np.array_equal(cut[0], line[0]) and naive.length(cut) == pytest.approx(30)
        (out,), _ = one_of_each([line], [False], orbit, line, (line[:, 0] > 0) & (line[:, 0] < 30))
        assert np.array_equal(out, cut)
    assert len(one_period(cornice[:26], orbit)) == 26, "it ends before its image begins"
    # a wave that comes back to its image, but turned, does not run on
    turned = np.concatenate([cornice[:30], [20, 3, 1] + shapes.line(12, way=[0, 1, 0])])
    assert len(one_period(turned, orbit)) == len(turned)


# ---- drafts


def row(rng, count, *, noise=0.3, clutter=3):
    """A row of things among clutter, its orbit and the clean curves, in the network's frame."""
    thing = shapes.ornament(rng, 3)
    placed = [c + k * STEP + noise * rng.normal(size=c.shape) for k in range(count) for c in thing]
    placed += [shapes.wiggle(rng, 40) + rng.uniform(0, 1, size=3) * [45.0 * count, 20, 10] for _ in range(clutter)]
    net = shapes.network(placed, smoothing=1.5)
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [count - 1])
    return net, orbit, [shapes.to_frame(net, c) for c in thing]


def away_from(lines, curves, motions):
    """Mean distance of the points of lines from curves at the nearest of some places, and the share that is missed."""
    placed = [naive.moved(m, c) for m in motions for c in curves]
    gaps = [min(naive.distance_to_polyline(p, c) for c in placed) for line in lines for p in line]
    missed = [min(naive.distance_to_polyline(p, line) for m in motions for line in (naive.moved(m, q) for q in lines))
              for c in curves for p in c]  # fmt: skip
    return float(np.mean(gaps)), float(np.mean(np.array(missed) > 2.0))


@pytest.mark.parametrize("wide", [False, True])
def test_what_cells_agree_on_is_drafted_and_clutter_is_not(rng, wide):
    net, orbit, thing = row(rng, 5)
    samples = np.arange(len(net.points))
    overlay = fold_orbit(net, orbit, samples, net.weights)
    more = {"wide": fold_orbit(net, orbit, samples, net.weights, share=0.5)} if wide else {}
    draft = consolidate(net, overlay, 7, epsilon=2.0, orbit=orbit, **more)
    assert draft.transformation == 7 and draft.orbital.all() and np.array_equal(draft.keys, overlay.keys)
    steps = [np.linalg.matrix_power(orbit.generators[0], k) for k in range(-5, 6)]
    away, missed = away_from(draft.curves, thing, steps)
    assert away < 0.4 and missed < 0.12
    assert draft.lengths.sum() == pytest.approx(sum(map(len, net_curves(net, thing))), rel=0.15)
    # the thing is whole in the cells that show it
    shown = draft.evidence @ draft.lengths / draft.lengths.sum()
    assert (np.sort(shown)[-4:] > 0.8).all()


def net_curves(net, curves):
    return [naive.resample(c, 1.0) for c in curves]


def test_places_that_are_a_little_off_are_moved_onto_what_shows_them(rng):
    net, orbit, thing = row(rng, 4)
    truth = np.array([np.linalg.matrix_power(orbit.generators[0], k) for k in range(4)])
    off = truth.copy()
    for k in (1, 2, 3):
        middle = naive.moved(truth[k], np.concatenate(thing)).mean(axis=0)
        off[k] = naive.about(rng.normal(size=3), np.radians(3), middle, along=0.7) @ truth[k]
    free = np.ones(len(net.points), bool)
    region = np.concatenate(thing)
    draft = consolidate_places(net, off, region, 3, free, epsilon=2.0)
    assert len(draft.poses) == 4 and not draft.orbital.any() and draft.transformation == 3
    away, missed = away_from(draft.curves, thing, [draft.poses[0] @ np.linalg.inv(truth[0]), np.eye(4)])
    assert away < 0.5 and missed < 0.15
    # the curves keep their place in the frame in which they were made: what counts is from place to place
    for poses in (draft.poses, refined_poses(net, shapes.draft(net_curves(net, thing), off), free, radius=4.0)):
        between = poses @ np.linalg.inv(poses[0])
        known, given_ = truth @ np.linalg.inv(truth[0]), off @ np.linalg.inv(off[0])
        for k in (1, 2, 3):
            at = naive.moved(truth[0], region)
            error = [np.linalg.norm(naive.moved(m, at) - naive.moved(known[k], at), axis=1).mean()
                     for m in (between[k], given_[k])]  # fmt: skip
            assert error[0] < 0.5 * error[1]


def test_places_that_belong_together_keep_their_places_to_each_other(rng):
    net, orbit, thing = row(rng, 4, clutter=0)
    truth = np.array([np.linalg.matrix_power(orbit.generators[0], k) for k in range(4)])
    region = np.concatenate(thing)
    nudges = [naive.about(way, np.radians(2), region.mean(axis=0), along=0.6) for way in ([1, 2, 1], [-2, 1, 0])]
    draft = shapes.draft(net_curves(net, thing), [truth[k] @ nudges[k // 2] for k in range(4)])
    free = np.ones(len(net.points), bool)
    poses = refined_poses(net, draft, free, radius=4.0, together=np.array([5, 5, 9, 9]), rounds=6)
    for a, b in ((0, 1), (2, 3)):
        between = draft.poses[b] @ np.linalg.inv(draft.poses[a])
        assert np.allclose(poses[b] @ np.linalg.inv(poses[a]), between), "of one number: they move as one"
    assert not np.allclose(poses[2] @ np.linalg.inv(poses[1]), draft.poses[2] @ np.linalg.inv(draft.poses[1]))
    for k in range(4):
        after, before = (np.linalg.norm(naive.moved(m, region) - naive.moved(truth[k], region), axis=1).mean()
                         for m in (poses[k], draft.poses[k]))  # fmt: skip
        assert after < 0.3 * before


def test_few_occurrences_and_no_samples(rng):
    net, orbit, thing = row(rng, 3, clutter=0)
    free, curves = np.ones(len(net.points), bool), net_curves(net, thing)
    region = np.concatenate(thing)
    one = consolidate_places(net, np.eye(4)[None], region, 0, free, epsilon=2.0)
    assert one.curves == [] and one.evidence.shape == (1, 0) and len(one.poses) == 1, "one place agrees with nothing"
    draft = shapes.draft(curves, orbit.power([[0], [1]]))
    assert np.array_equal(refined_poses(net, draft, ~free, radius=2.0), draft.poses)
    far = shapes.draft(curves, [naive.rigid(shift=[0, 0, 500])])
    assert np.array_equal(refined_poses(net, far, free, radius=2.0), far.poses), "what nothing shows stays"
    kept = draft.poses.copy()
    refined_poses(net, draft, free, radius=2.0)
    assert np.array_equal(draft.poses, kept)
