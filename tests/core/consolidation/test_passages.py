# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pieces the input's curves lead over, run by run, and pieces that several curves share."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from core.consolidation.joining import bend_of_ends
from core.consolidation.passages import (
    NEAR_END,
    OFTEN,
    PASSAGE,
    STEADY,
    find_passages,
    part_shared,
    split_where_none_pass,
)
from tests import naive
from tests.core import shapes

NONE = np.zeros((0, 2), np.int64)


def trails(lines):
    """Points, tangents and runs of lines."""
    run = np.repeat(np.arange(len(lines)), [len(p) for p in lines])
    return np.concatenate(lines), np.concatenate([naive.directions(p) for p in lines]), run


def naive_passages(pieces, points, tangents, run, radius=1.8, cosine=0.7):
    """Counts of pairs {(a, b): n}, routes {(piece, a, b): n} and arrivals {a: n}, one sample of a run at a time."""
    line = np.concatenate(pieces)
    way = np.concatenate([naive.directions(p) for p in pieces])
    home = [(i, k) for i, p in enumerate(pieces) for k in range(len(p))]
    pairs, routes, arrivals = {}, {}, {}
    for number in dict.fromkeys(run.tolist()):
        visits = []  # piece, and the samples and places on it in order
        for i in np.flatnonzero(run == number).tolist():
            near, _ = naive.lies_along(points[i], tangents[i], line, way, radius=radius, cosine=cosine, most=4)
            if near < 0:
                continue
            piece, place = home[near]
            stays = visits and visits[-1][0] == piece and i - visits[-1][1][-1] <= 16
            if stays and abs(place - visits[-1][2][-1]) <= 16:
                visits[-1][1].append(i)
                visits[-1][2].append(place)
            else:
                visits.append((piece, [i], [place]))
        visits = [v for v in visits if len(v[1]) >= min(4, len(pieces[v[0]]))]
        for piece, _, places in visits:
            for end in (end_at(pieces, piece, places, 3), end_at(pieces, piece, places[::-1], 3)):
                if end is not None:
                    arrivals[end] = arrivals.get(end, 0) + 1
        before = None
        for one, two in zip(visits[:-1], visits[1:]):
            goes_on = two[1][0] - one[1][-1] <= 16
            goes_on &= one[0] != two[0] or abs(two[2][0] - one[2][-1]) > 16
            left = end_at(pieces, one[0], one[2]) if goes_on else None
            entered = end_at(pieces, two[0], two[2][::-1]) if goes_on else None
            step = None if left is None or entered is None else (left, entered)
            if step:
                for pair in (step, step[::-1]):
                    pairs[pair] = pairs.get(pair, 0) + 1
                if before and before[1] // 2 == left // 2 and before[1] != left:
                    key = (left // 2, *sorted((before[0], entered)))
                    routes[key] = routes.get(key, 0) + 1
            before = step
    return pairs, routes, arrivals


def end_at(pieces, piece, places, near=8):
    """The end of a piece towards which places lead, if the last of them is near it."""
    last = len(pieces[piece]) - 1
    if places[-1] > places[0]:
        return 2 * piece + 1 if last - places[-1] <= near else None
    if places[-1] == places[0] and last >= 4:
        return None
    return 2 * piece if places[-1] <= near else None


@pytest.mark.parametrize("seed", range(8))
def test_passages_are_those_of_the_loop(seed):
    """Broken and noisy runs over pieces of curves that cross each other, and over a ring."""
    rng = np.random.default_rng(seed)
    roads = [shapes.wiggle(rng, 70, bend=0.1) * [1, 1, 0.1] for _ in range(4)]
    roads = [r - r[35] + rng.uniform(-6, 6, size=3) * [1, 1, 0] for r in roads] + [shapes.circle(9, [5, 5, 0])]
    pieces, runs = [], []
    for road in roads:
        cuts = np.sort(rng.choice(np.arange(6, len(road) - 6), 3, replace=False))
        gaps = rng.integers(0, 12, size=3)
        parts = np.split(road, cuts)
        parts = [parts[0], *[p[g:] for p, g in zip(parts[1:], gaps)]]
        pieces += [p[:: rng.choice([1, -1])] for p in parts if len(p) >= 2]
        for _ in range(6):
            line = road[:: rng.choice([1, -1])] + 0.4 * rng.normal(size=road.shape)
            hole = int(rng.integers(0, 60))
            line = np.delete(line, np.arange(hole, min(hole + int(rng.integers(0, 20)), len(line))), axis=0)
            runs.append(line)
    given_ = trails(runs)
    got = find_passages(pieces, *given_)
    pairs, routes, arrivals = naive_passages(pieces, *given_)
    assert got.pairs.shape == (2 * len(pieces),) * 2 and np.array_equal(got.pairs, got.pairs.T)
    assert {(a, b): int(got.pairs[a, b]) for a, b in np.argwhere(got.pairs).tolist()} == pairs
    assert {(int(t), a, b): n for t, (a, b, n) in zip(got.through, got.routes.tolist())} == routes
    assert got.arrivals.tolist() == [arrivals.get(end, 0) for end in range(2 * len(pieces))]
    assert len(pairs) > 10 and len(routes) > 3 and len(arrivals) > 10


@pytest.mark.parametrize("turned", [False, True])
def test_curves_lead_from_one_piece_to_the_next(rng, turned):
    road = shapes.circle(40)[:90]
    pieces = [road[:40], road[45:][::-1] if turned else road[45:]]
    runs = [road + 0.2 * rng.normal(size=road.shape) for _ in range(3)] + [road[::-1], road[:43]]
    got = find_passages(pieces, *trails(runs))
    expected = np.zeros((4, 4), int)
    expected[1, 2 + turned] = expected[2 + turned, 1] = 4
    assert np.array_equal(got.pairs, expected)
    assert len(got.routes) == len(got.through) == 0


@pytest.mark.parametrize("lost, passes", [(PASSAGE, 1), (PASSAGE + 1, 0)])
def test_how_many_samples_may_lie_between_two_pieces(lost, passes):
    # a sample one edge beyond a piece still lies on it
    pieces = [shapes.line(20), shapes.line(20, [20 + lost + 1, 0, 0])]
    got = find_passages(pieces, *trails([shapes.line(80)]), radius=1.5)
    assert got.pairs[1, 2] == passes and got.pairs.sum() == 2 * passes


@pytest.mark.parametrize("over, passes", [(NEAR_END, 1), (NEAR_END + 1, 0)])
def test_how_near_to_its_end_a_piece_must_be_left(over, passes):
    # the run comes along the bar, turns off before its end and goes on along the branch
    corner = 20 - int(over)
    bar, branch = shapes.line(21), shapes.line(20, [corner, 3, 0], [0, 1, 0])
    path = np.concatenate([shapes.line(corner + 1), shapes.line(22, [corner, 1, 0], [0, 1, 0])])
    points, _, run = trails([path])
    ways = np.repeat([[1.0, 0, 0], [0, 1.0, 0]], [corner + 1, 22], axis=0)
    assert find_passages([bar, branch], points, ways, run).pairs[1, 2] == passes


@pytest.mark.parametrize("samples, passes", [(STEADY, 1), (STEADY - 1, 0)])
def test_how_long_a_run_must_stay_on_a_piece(samples, passes):
    pieces = [shapes.line(20), shapes.line(20, [25, 0, 0])]
    road = shapes.line(60)
    run = road[: int(25 + samples - 1)]  # the first sample of the second piece is seen from one edge before it
    got = find_passages(pieces, *trails([run]), radius=1.5)
    assert got.pairs[1, 2] == passes


def test_a_run_over_the_two_ends_of_one_piece_closes_it():
    ring = shapes.circle(15)
    got = find_passages([ring[2:-2]], *trails([np.roll(ring, len(ring) // 2, axis=0)] * 2))
    assert got.pairs.tolist() == [[0, 2], [2, 0]]


def test_what_only_crosses_a_piece_does_not_pass_it(rng):
    pieces = [shapes.line(20), shapes.line(20, [24, 0, 0])]
    across = [shapes.line(40, [k, -20, 0], [0, 1, 0]) for k in (5, 19, 22, 30)]
    assert find_passages(pieces, *trails(across)).pairs.sum() == 0
    # nor do two curves of which each shows one of the pieces
    assert find_passages(pieces, *trails([shapes.line(21), shapes.line(21, [23, 0, 0])])).pairs.sum() == 0


def test_of_nothing_comes_nothing():
    points, ways, run = trails([shapes.line(10)])
    for pieces, given_ in (([], (points, ways, run)), ([shapes.line(9)], (points[:0], ways[:0], run[:0]))):
        got = find_passages(pieces, *given_)
        assert got.pairs.shape == (2 * len(pieces),) * 2 and not got.pairs.any()
        assert got.routes.shape == (0, 3) and got.through.shape == (0,)
        assert got.arrivals.tolist() == [0] * 2 * len(pieces) and not got.parted.any()
        assert len(split_where_none_pass(pieces, *given_)) == len(pieces)
        parted, forced = part_shared(pieces, got, NONE, lambda a, b: 0.0)
        assert len(parted) == len(pieces) and forced.shape == (0, 2)
    far = find_passages([shapes.line(9)], points + [0, 0, 50], ways, run)
    assert not far.pairs.any() and len(far.routes) == 0


# ---- curves that end at one place


@pytest.mark.parametrize("through, parted", [(0, True), (1, False)])
def test_ends_that_many_runs_come_to_and_none_leads_between_are_parted(rng, through, parted):
    pieces = [shapes.line(30), shapes.line(30, [31, 0, 0])]
    runs = [shapes.line(30), shapes.line(30, [31, 0, 0])] * OFTEN + [shapes.line(61)] * through
    runs = [c + 0.2 * rng.normal(size=c.shape) for c in runs]
    got = find_passages(pieces, *trails(runs))
    assert got.arrivals[[1, 2]].tolist() == [OFTEN + through] * 2
    assert got.parted[1, 2] == got.parted[2, 1] == parted
    few = find_passages(pieces, *trails(runs[2:]))
    assert not few.parted.any() or through, "two may have ended by chance"


def ends(rng, count, *, through=0, size=60):
    """Noisy runs along a line that end in its middle, `count` from either side, and some that pass it."""
    line, middle = shapes.line(size), size // 2
    runs = [line[: middle + 1], line[middle:]] * count + [line] * through
    return line, trails([c + 0.15 * rng.normal(size=c.shape) for c in runs])


@pytest.mark.parametrize("count, through, cut", [(OFTEN, 0, True), (OFTEN - 1, 0, False), (4, 1, False), (12, 1, True)])
def test_a_piece_is_cut_where_runs_end_from_both_sides(rng, count, through, cut):
    line, given_ = ends(rng, count, through=through)
    other = shapes.line(20, [0, 30, 0])
    parts = split_where_none_pass([other, line], *given_)
    assert np.array_equal(parts[0], other) and np.array_equal(np.concatenate(parts[1:]), line)
    cuts = np.cumsum([len(p) for p in parts[1:-1]])
    assert (len(cuts) > 0) == cut and (np.abs(cuts - 30) <= 4).all()


def test_runs_that_end_from_one_side_or_at_other_places_cut_nothing(rng):
    line = shapes.line(60)
    cases = [[line[:31]] * 5, [line[:25]] * 4 + [line[38:]] * 4, [line[: 20 + 3 * k] for k in range(10)]]
    for runs in cases:
        (part,) = split_where_none_pass([line], *trails([c + 0.15 * rng.normal(size=c.shape) for c in runs]))
        assert np.array_equal(part, line)


# ---- shared pieces


def crossing(flat=4.0):
    """Two bows that share their middle: the shared piece and four arms; 0 and 1 are the ends of one bow."""
    t = np.arange(-40.0, 41)
    rise = np.sign(t) * np.maximum(np.abs(t) - 8, 0) / flat
    one, two = np.c_[t, rise, 0 * t], np.c_[t, -rise, 0 * t]
    middle = np.abs(t) <= 10
    arms = [one[t < -13], one[t > 13], two[t < -13], two[t > 13]]
    return one, two, [*arms, one[middle]]


@pytest.mark.parametrize("crosses", [True, False])
def test_a_piece_that_two_curves_share_is_there_twice(rng, crosses):
    one, two, pieces = crossing()
    if not crosses:  # the curves touch and part again on the side that they came from
        t = one[:, 0]
        swap = (t > 0)[:, None]
        one, two = np.where(swap, two, one), np.where(swap, one, two)
    runs = [c + 0.2 * rng.normal(size=c.shape) for c in (one, two) for _ in range(3)]
    runs = [c[::-1] if k % 2 else c for k, c in enumerate(runs)]
    passages = find_passages(pieces, *trails(runs))
    through = {(a, b): n for (a, b, n), t in zip(passages.routes.tolist(), passages.through) if t == 4}
    partner = (2, 6) if crosses else (6, 2)
    assert through == {(1, partner[0]): 3, tuple(sorted((5, partner[1]))): 3}
    parted, forced = part_shared(pieces, passages, NONE, partial(bend_of_ends, pieces))
    assert len(pieces) == 5 and len(parted) == 6, "the given list stays as it is"
    assert all(p is q for p, q in zip(parted, [*pieces, pieces[4]]))
    joined = {}
    for a, b in forced.tolist():
        joined.setdefault(b // 2, {})[b % 2] = a
    ways = {(way[0], way[1]) for way in joined.values()}
    assert sorted(joined) == [4, 5] and ways == {(1, partner[0]), (5, partner[1])}


def test_where_no_run_shows_it_arms_are_paired_as_they_bend_least():
    t = np.arange(-40.0, 41)
    one, two = np.c_[t, t / 6, 0 * t], np.c_[t, -t / 6, 0 * t]
    pieces = [one[t < -13], one[t > 13], two[t < -13], two[t > 13], np.c_[t, 0 * t, 0 * t][np.abs(t) <= 10]]
    nothing = find_passages(pieces, *(x[:0] for x in trails(pieces)))
    smooth, bend = np.array([[1, 8], [5, 8], [2, 9], [6, 9]]), partial(bend_of_ends, pieces)
    # runs outweigh the bend
    shown = replace(nothing, routes=np.array([[1, 6, 2], [2, 5, 2]]), through=np.array([4, 4]))
    for passages, expected in ((nothing, {(1, 2), (5, 6)}), (shown, {(1, 6), (2, 5)})):
        parted, forced = part_shared(pieces, passages, smooth, bend)
        assert len(parted) == 6 and sorted(forced[:, 1]) == [8, 9, 10, 11]
        assert {tuple(sorted(forced[forced[:, 1] // 2 == copy, 0].tolist())) for copy in (4, 5)} == expected


def test_a_piece_with_one_arm_at_an_end_is_not_shared(rng):
    one, two, pieces = crossing()
    stump = two[two[:, 0] < 10]
    runs = [c + 0.2 * rng.normal(size=c.shape) for c in (one, stump) for _ in range(3)]
    passages = find_passages(pieces, *trails(runs))
    assert passages.pairs[8].sum() == 6 and passages.pairs[9].sum() == 3
    parted, forced = part_shared(pieces, passages, NONE, partial(bend_of_ends, pieces))
    assert len(parted) == 5 and len(forced) == 0
    # a single run makes no arm
    runs = [one, one, two]
    parted, _ = part_shared(pieces, find_passages(pieces, *trails(runs)), NONE, partial(bend_of_ends, pieces))
    assert len(parted) == 5
