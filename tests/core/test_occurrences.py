# SPDX-License-Identifier: GPL-3.0-or-later
"""A known thing is found wherever it is once more, and not where there is only clutter."""

from __future__ import annotations

import numpy as np
import pytest

from core.clustering import Clusters, cluster_votes
from core.matching.blast import feature_blast
from core.matching.voting import vote
from core.occurrences import APART, SEEN, STIFF, Pattern, Search, fitted, share_place, shown
from core.support import NeighbourField, Screen
from tests import naive
from tests.core import shapes

STEP = np.array([50.0, 6, 0])


def pattern_of(curves):
    """Curves as what is looked for."""
    points = np.concatenate(curves)
    run = np.repeat(np.arange(len(curves)), [len(c) for c in curves])
    return Pattern(points, np.concatenate([naive.directions(c) for c in curves]), np.ones(len(points)), run, None, None)


def probe_of(net, curves, **more):
    return Screen(net, pattern_of(curves), radius=2.0, still=None, **more)


def scene(rng, places, *, clutter=5, curves=4, noise=0.2, size=16):
    """A network of things at places of the world among clutter; the places and the clean curves in its frame."""
    thing = shapes.ornament(rng, curves, size=size)
    placed = [naive.moved(m, c) + noise * rng.normal(size=c.shape) for m in places for c in thing]
    reach = np.array([m[:3, 3] for m in places])
    low, high = reach.min(axis=0) - 20, reach.max(axis=0) + 20
    placed += [shapes.wiggle(rng, 45, bend=0.25) + rng.uniform(low, high) for _ in range(clutter)]
    net = shapes.network(placed, smoothing=1.5)
    own = [shapes.to_frame(net, naive.resample(c, 1.0)) for c in thing]
    return net, np.array([shapes.in_frame(net, m) for m in places]), own


def search_in(net, **more):
    """A search after the first stages of the method."""
    matches = feature_blast(net, np.arange(len(net)), l0=20.0, s=1.0, t=2.0, delta_l=5.0)
    votes = vote(net, matches, bin_translation=2.0, bin_rotation=1.5)
    screen = Screen(net, radius=2.0)
    clusters = cluster_votes(net, votes, screen, cluster_translation=2.0, cluster_rotation=1.5)
    return Search(net, votes, clusters, screen)


def of_thing(net, k, curves=4):
    """(n,) bool, samples of the thing at place k."""
    return np.isin(net.source[net.curve_of], np.arange(curves * k, curves * (k + 1)))


ROW = [naive.rigid(shift=k * STEP) for k in range(3)]
BESIDE = naive.rigid(naive.turn([1, 2, 0.5], 2.0), [70, 75, 20])


# ---- what is shown


@pytest.mark.parametrize("stretch, most, typical", [(1, 0.08, 0.025), (8, 0.25, 0.08)])
@pytest.mark.parametrize("seed", range(2))
def test_the_share_that_is_shown_is_that_of_the_loop(seed, stretch, most, typical):
    """The table is exact to half a voxel: what lies at the bounds may go either way, and a stretch with it."""
    rng = np.random.default_rng(seed)
    net, places, curves = scene(rng, [np.eye(4), naive.rigid(shift=[30, 0, 0])], clutter=0, curves=2, size=12)
    middle = np.concatenate(curves).mean(axis=0)
    nudges = [naive.about(rng.normal(size=3), np.radians(8), middle, along=1.5) for _ in range(5)]
    poses = np.array([*places, *(places[1] @ n for n in nudges)])
    pattern, field = pattern_of(curves), NeighbourField(net.points, 2.0, voxel=0.2)
    probe = Screen(net, pattern, radius=2.0, still=None, field=field, stretch=stretch)
    gap = []
    for free in (np.ones(len(net.points), bool), np.arange(len(net.points)) % 40 < 28, ~of_thing(net, 0, 2)):
        got, stiff = shown(probe, poses, free)
        expected = []
        for m in poses:
            hit, to = naive.recurs(pattern.points, pattern.tangents, m, net.points, net.tangents, radius=2.0)
            expected.append(np.mean(naive.long_stretches(hit & free[to], pattern.curve_of, [stretch] * len(hit))))
        gap.append(np.abs(got - expected))
        assert got.shape == stiff.shape == (7,)
    assert np.max(gap) < most and np.mean(gap) < typical
    assert got[0] < 0.2 and got[1] > 0.65 and 0.1 < got[2:].mean() < 0.9, "what is not free shows nothing"


def naive_stiffness(points, ways, small=1e-4):
    """Least of the squares by which points leave their tangent lines under a unit shift and turn of the whole."""
    arm = points - points.mean(axis=0)
    size = np.sqrt(np.mean([a @ a for a in arm]))
    columns = []
    for k in range(6):
        away = []
        for a, w in zip(arm, ways):
            if k < 3:
                move = small * np.eye(3)[k]
            else:
                move = naive.turn(np.eye(3)[k - 3], small / size) @ a - a
            away.append((move - w * (move @ w)) / small)
        columns.append(np.concatenate(away))
    jacobian = np.stack(columns, axis=1)
    return np.linalg.eigvalsh(jacobian.T @ jacobian)[0]


def test_what_holds_a_pose(rng):
    """A straight line slides and rolls, a ring turns and parallel lines slide; an ornament stays where it is."""
    z = [0, 0, 1]
    things = {
        "line": [shapes.line(50)],
        "ring": [shapes.circle(12)],
        "rings": [shapes.circle(12), shapes.circle(8, [0, 0, 9])],
        "parallels": [shapes.line(50), shapes.line(50, [0, 9, 4])],
        "helix": [np.c_[9 * np.cos(np.arange(70) / 10), 9 * np.sin(np.arange(70) / 10), np.arange(70) * 0.4]],
        "corner": [shapes.line(40), shapes.line(40, way=[0, 1, 0])],
        "cross": [
            shapes.line(40, [-20, 0, 0]),
            shapes.line(40, [0, -20, 5], [0, 1, 0]),
            shapes.line(40, [9, 9, -20], z),
        ],
        "ornament": shapes.ornament(rng, 3),
    }
    stiff = {}
    for name, curves in things.items():
        net = shapes.network(curves, closed=["ring" in name] * len(curves))
        probe = Screen(net, radius=2.0, still=None, field=NeighbourField(net.points, 2.0, voxel=0.4))
        share, got = shown(probe, np.eye(4)[None], np.ones(len(net.points), bool))
        assert share[0] > 0.97
        stiff[name] = got[0]
        expected = naive_stiffness(net.points, net.tangents)
        weight = net.weights.mean()
        assert got[0] == pytest.approx(weight * expected, rel=0.15, abs=0.3), name
    for name in ("line", "ring", "rings", "parallels", "helix"):
        assert stiff[name] < 0.5, name
    for name in ("corner", "cross", "ornament"):
        assert stiff[name] > STIFF, name


def test_only_what_is_shown_holds_a_pose(rng):
    net, places, curves = scene(rng, ROW[:2], clutter=0)
    every = np.ones(len(net.points), bool)
    probe = probe_of(net, curves)
    share, stiff = shown(probe, places, every)
    assert share.min() > 0.9 and stiff.min() > STIFF
    for free in (~every, ~of_thing(net, 1)):
        share, less = shown(probe, places, free)
        assert share[1] == 0 and abs(less[1]) < 1e-9
    far = np.array([naive.rigid(shift=[0, 0, 300])])
    assert shown(probe, far, every)[0] == 0
    assert [x.shape for x in shown(probe, places[:0], every)] == [(0,), (0,)]


def test_poses_are_fitted_to_free_samples(rng):
    net, places, curves = scene(rng, ROW, clutter=0)
    every, region = np.ones(len(net.points), bool), np.concatenate(curves)
    nudges = [naive.about(rng.normal(size=3), np.radians(3), region.mean(axis=0), along=0.8) for _ in places]
    before = np.array([m @ n for m, n in zip(places, nudges)])
    kept, probe = before.copy(), probe_of(net, curves)
    after = fitted(probe, before, every, 6)
    off = [[np.linalg.norm(naive.moved(m, region) - naive.moved(p, region), axis=1).mean() for m, p in zip(x, places)]
           for x in (before, after)]  # fmt: skip
    assert np.array_equal(before, kept) and (np.array(off[1]) < 0.35 * np.array(off[0])).all()
    assert np.array_equal(fitted(probe, before, ~every, 3), before), "nothing is free"
    mine = fitted(probe, before, ~of_thing(net, 1), 3)
    assert np.array_equal(mine[1], before[1]) and not np.allclose(mine[2], before[2])
    assert fitted(probe, before[:0], every, 3).shape == (0, 4, 4)


# ---- places


@pytest.mark.parametrize("size", [3, 40])
@pytest.mark.parametrize("seed", range(3))
def test_motions_that_share_a_place_are_those_of_the_loop(seed, size):
    rng = np.random.default_rng(seed)
    points = size * rng.normal(size=(30, 3)) + [50, 0, 0]
    motions, known = (np.array([shapes.random_motion(rng, 20) for _ in range(n)]) for n in (25, 4))
    limit = max(8.0, 0.5 * np.sqrt(np.mean([np.sum((p - points.mean(axis=0)) ** 2) for p in points])))
    expected = []
    for m in motions:
        places = [naive.moved(x, [points.mean(axis=0)])[0] for x in (m, *known)]
        expected.append(any(np.linalg.norm(places[0] - p) < limit for p in places[1:]))
    got = share_place(points, motions, known)
    assert got.tolist() == expected
    assert share_place(points, known, known).all(), "a place is shared with itself, however it is turned"


@pytest.mark.parametrize("off, same", [(APART - 0.01, True), (APART + 0.01, False)])
def test_how_far_two_places_are_apart(off, same):
    points = shapes.line(10, [30, 0, 0])
    middle = points.mean(axis=0)
    turned = naive.rigid(shift=[0, off, 0]) @ naive.about([0, 0, 1], 3.0, middle)
    assert share_place(points, turned[None], np.eye(4)[None]).tolist() == [same]


@pytest.mark.parametrize("share, same", [(0.49, True), (0.51, False)])
def test_a_large_thing_takes_a_large_place(share, same):
    points = 100.0 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    moved = naive.rigid(shift=[0, 0, 100 * share])
    assert share_place(points, moved[None], np.eye(4)[None]).tolist() == [same]


def test_no_places():
    points, one, none = shapes.line(5), np.eye(4)[None], np.zeros((0, 4, 4))
    assert share_place(points, none, one).shape == (0,)
    assert share_place(points, one, none).tolist() == [False]


# ---- the search


@pytest.mark.parametrize("seed", range(2))
def test_a_thing_beside_the_lattice_is_found(seed):
    rng = np.random.default_rng(seed)
    net, places, curves = scene(rng, [*ROW, BESIDE])
    search, region = search_in(net), np.concatenate(curves)
    every = np.ones(len(net.points), bool)
    kept = places.copy(), every.copy()
    found = search.find(pattern_of(curves), places[:3], every)
    assert len(found) == 1
    assert np.linalg.norm(naive.moved(found[0], region) - naive.moved(places[3], region), axis=1).mean() < 0.5
    assert np.array_equal(places, kept[0]) and np.array_equal(every, kept[1])
    # all known: nothing more is found; the samples not free: neither
    assert search.find(pattern_of(curves), places, every).shape == (0, 4, 4)
    assert search.find(pattern_of(curves), places[:3], ~of_thing(net, 3)).shape == (0, 4, 4)


def test_all_other_places_are_found_from_one(rng):
    net, places, curves = scene(rng, [*ROW, BESIDE])
    region = np.concatenate(curves)
    found = search_in(net).find(pattern_of(curves), places[:1], np.ones(len(net.points), bool))
    assert len(found) == 3
    home = []
    for m in found:
        away = [np.linalg.norm(naive.moved(m, region) - naive.moved(p, region), axis=1).mean() for p in places]
        home.append(int(np.argmin(away)))
        assert min(away) < 0.5
    assert sorted(home) == [1, 2, 3], "each once, none of them the known one"
    share, _ = shown(probe_of(net, curves), found, np.ones(len(net.points), bool))
    assert share[0] > share.max() - 0.02, "what is shown best comes first"


@pytest.mark.parametrize("seed", range(2))
def test_nothing_is_found_in_clutter(seed):
    net, places, curves = scene(np.random.default_rng(seed), ROW, clutter=10)
    found = search_in(net).find(pattern_of(curves), places, np.ones(len(net.points), bool))
    assert found.shape == (0, 4, 4)


def test_a_part_of_a_thing_is_not_the_thing(rng):
    """A third of the thing beside the row holds its pose, and does not show it all the same; most of it does."""
    row = [naive.rigid(shift=2 * k * STEP) for k in range(3)]
    net, places, curves = scene(rng, [*row, naive.rigid(shift=[20, 90, 35]) @ BESIDE], size=30)
    search = search_in(net)
    for kept, count in (([12], 0), ([12, 13, 14], 1)):
        there = np.isin(net.source[net.curve_of], kept) | ~of_thing(net, 3)
        (share,), (stiff,) = shown(probe_of(net, curves), places[3:], there)
        assert stiff > STIFF and (share > SEEN) == count
        found = search.find(pattern_of(curves), places[:3], there)
        assert len(found) == count


def test_a_straight_line_is_looked_for_in_vain(rng):
    """It would be at home anywhere along other straight lines."""
    lines = [shapes.line(60, [0, 30 * k, 5 * k], [1, 0.1 * k, 0]) for k in range(5)]
    net = shapes.network([c + 0.1 * rng.normal(size=c.shape) for c in lines], smoothing=1.5)
    own = [shapes.to_frame(net, lines[0])]
    assert search_in(net).find(pattern_of(own), np.eye(4)[None], np.ones(len(net.points), bool)).shape == (0, 4, 4)


def test_no_clusters_no_votes_and_nothing_free(rng):
    net, places, curves = scene(rng, [*ROW, BESIDE])
    whole = search_in(net)
    none = Clusters(np.zeros((0, 4, 4)), np.zeros(0), 0.0)
    every, pattern = np.ones(len(net.points), bool), pattern_of(curves)
    search = Search(net, whole.votes, none, whole.screen)
    assert len(search.find(pattern, places[:3], every)) == 1, "the votes are enough"
    votes = vote(net, feature_blast(net, np.zeros(0, int), l0=20.0, s=1.0, t=2.0, delta_l=5.0),
                 bin_translation=2.0, bin_rotation=1.5)  # fmt: skip
    assert len(votes) == 0 and Search(net, votes, none, whole.screen).find(pattern, places[:3], every).shape == (
        0,
        4,
        4,
    )
    assert whole.find(pattern, places[:3], ~every).shape == (0, 4, 4)


def test_a_doubtful_place_gives_way_to_a_better_one(rng):
    """A known pose that is half a turn off shows a part of the thing; a true one that others hide stays."""
    net, places, curves = scene(rng, [*ROW, BESIDE], clutter=2)
    region = np.concatenate(curves)
    search, every = search_in(net), np.ones(len(net.points), bool)
    wrong = places[3] @ naive.about([0.3, 0.5, 1], np.pi, region.mean(axis=0))
    keep, found = search.reconsider(pattern_of(curves), np.array([*places[:3], wrong]), every)
    assert keep.tolist() == [True, True, True, False] and len(found) == 1
    assert np.linalg.norm(naive.moved(found[0], region) - naive.moved(places[3], region), axis=1).mean() < 0.5
    keep, found = search.reconsider(pattern_of(curves), places, every)
    assert keep.all() and len(found) == 0
    keep, found = search.reconsider(pattern_of(curves), np.array([places[0], wrong]), every)
    assert keep.all(), "two stay at least"
