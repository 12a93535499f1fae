# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates that are rigid copies of each other become one, and one that holds a thing twice becomes that thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.copies import _grouped, congruent_parts, find_alike, same_figures, unite
from core.drafts import seen_share
from core.parameters import Parameters
from tests import naive
from tests.core import shapes

PARAMETERS = Parameters(l0=20.0)
RADIUS = 1.25 * PARAMETERS.epsilon
TURNED = naive.rigid(naive.turn([0.3, 1, 0.2], 1.1), [0, 130, 10])


def known(net, curves, steps, **more):
    """A draft of curves of the frame at motions of the world, and what the network shows of it."""
    poses = np.array([shapes.in_frame(net, m) for m in steps])
    return shapes.draft(curves, poses, evidence=seen_share(net, curves, poses, radius=RADIUS), **more)


def row(step, count, first=None):
    return [np.linalg.matrix_power(step, k) @ (np.eye(4) if first is None else first) for k in range(count)]


def scene(rng, things, *, noise=0.15):
    """A network of things, each a list of curves, at their places."""
    curves = [naive.moved(m, c) + noise * rng.normal(size=c.shape) for thing, places in things for m in places
              for c in thing]  # fmt: skip
    return shapes.network(curves, smoothing=1.5)


def frame(net, m, thing):
    """Clean curves of a thing at a place of the world, in the network's frame."""
    return [shapes.to_frame(net, naive.moved(m, naive.resample(c, 1.0))) for c in thing]


def homes(net, draft, thing, places):
    """For each place of the world the nearest occurrence, and how far off the draft's curves are there."""
    home, gaps = [], []
    own = np.concatenate(draft.curves)
    for m in places:
        truth = frame(net, m, thing)
        middles = [naive.moved(pose, own).mean(axis=0) for pose in draft.poses]
        k, _ = naive.nearest(middles, np.concatenate(truth).mean(axis=0))
        points = naive.moved(draft.poses[k], own[::6])
        home.append(k)
        gaps.append(np.mean([min(naive.distance_to_polyline(p, c) for c in truth) for p in points]))
    return home, np.array(gaps)


ALONG, ACROSS = naive.rigid(shift=[75, 5, 0]), naive.rigid(shift=[80, -8, 3])


def two_rows(rng, *, curves=4, lost=None, counts=(4, 3)):
    """Two rows of one thing with different steps, the second turned; a draft of each row, and of which places."""
    thing = shapes.ornament(rng, curves, size=24)
    first, second = row(ALONG, counts[0]), row(ACROSS, counts[1], TURNED)
    net = scene(rng, [(thing, first), (thing, second)])
    other = thing if lost is None else [c[lost:] for c in thing]
    back = [m @ np.linalg.inv(TURNED) for m in second]
    drafts = [known(net, frame(net, np.eye(4), thing), first, transformation=0),
              known(net, frame(net, TURNED, other), back, transformation=1)]  # fmt: skip
    return net, thing, first + second, drafts


@pytest.mark.parametrize("counts", [(4, 3), (2, 4)])
def test_drafts_of_rigid_copies_become_one(rng, counts):
    net, thing, places, drafts = two_rows(rng, counts=counts)
    kept = [d.poses.copy() for d in drafts]
    (one,) = unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.curves) == 4 and len(one.poses) == sum(counts) and one.evidence.shape == (sum(counts), 4)
    home, gaps = homes(net, one, thing, places)
    assert sorted(home) == list(range(sum(counts))) and gaps.max() < 0.2
    assert (one.evidence @ one.lengths / one.lengths.sum() > 0.9).all()
    # the cells of the longer row are still cells of its orbit, with their keys
    longer = int(np.argmax(counts))
    mine = home[: counts[0]] if longer == 0 else home[counts[0] :]
    assert one.transformation == longer and one.orbital.sum() == counts[longer]
    assert one.keys[mine, 0].tolist() == list(range(counts[longer])) and one.orbital[mine].all()
    assert all(map(np.array_equal, kept, (d.poses for d in drafts)))


def test_a_place_that_both_drafts_know_is_one(rng):
    net, thing, places, drafts = two_rows(rng)
    there = drafts[0].poses[2] @ shapes.in_frame(net, np.linalg.inv(TURNED))
    more = drafts[1].part(cells=[0, 1, 2, 2])
    poses = np.concatenate([more.poses[:3], there[None]])
    more = replace(more, poses=poses, orbital=np.array([True, True, True, False]))
    (one,) = unite(net, [drafts[0], more], np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.poses) == 7 and sorted(homes(net, one, thing, places)[0]) == list(range(7))


@pytest.mark.parametrize("first", [0, 1])
def test_the_longer_version_of_the_curves_is_kept_and_not_blurred(rng, first):
    """Of two drafts one has shorter curves, and both lie a little beside the truth."""
    net, thing, places, drafts = two_rows(rng, lost=4)
    off = [replace(d, curves=[c + 0.35 * rng.normal(size=(1, 3)) for c in d.curves]) for d in drafts]
    (one,) = unite(net, [off[first], off[1 - first]], np.ones(len(net.points), bool), PARAMETERS)
    assert one.lengths.sum() == pytest.approx(drafts[0].lengths.sum(), rel=0.06)
    home, gaps = homes(net, one, thing, places)
    assert sorted(home) == list(range(7)) and gaps.max() < 0.2


def test_a_draft_that_holds_a_thing_twice_becomes_that_thing(rng):
    thing = shapes.ornament(rng, 4, size=24)
    twin = naive.rigid(naive.turn([0, 0, 1], 0.8), [5, 70, 4])
    places = row(naive.rigid(shift=[80, 5, 0]), 3)
    net = scene(rng, [(thing, places), (thing, [m @ twin for m in places])])
    pair = frame(net, np.eye(4), thing) + frame(net, twin, thing)
    draft = known(net, pair, places, transformation=3)
    (one,) = unite(net, [draft], np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.curves) == 4 and len(one.poses) == 6 and one.transformation == 3
    home, gaps = homes(net, one, thing, [*places, *(m @ twin for m in places)])
    assert sorted(home) == list(range(6)) and gaps.max() < 0.2


def test_two_pairs_become_one_thing(rng):
    """Of a pair of pairs first the pair is found, and then what it consists of."""
    thing = shapes.ornament(rng, 4, size=24)
    twin, pair = (
        naive.rigid(naive.turn([0, 0, 1], 0.8), [5, 70, 4]),
        naive.rigid(naive.turn([1, 0, 0], 0.5), [0, 0, 90]),
    )
    four = [np.eye(4), twin, pair, pair @ twin]
    places = row(naive.rigid(shift=[85, 5, 0]), 2)
    net = scene(rng, [(thing, [m @ k for m in places for k in four])])
    draft = known(net, [c for m in four for c in frame(net, m, thing)], places)
    (one,) = unite(net, [draft], np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.curves) == 4 and len(one.poses) == 8


@pytest.mark.parametrize("first", [0, 1])
def test_a_place_that_is_spread_over_two_drafts_has_the_occurrences_of_both(rng, first):
    thing = shapes.ornament(rng, 4, size=24)
    twin = naive.rigid(naive.turn([0, 0, 1], 0.8), [5, 70, 4])
    places = row(naive.rigid(shift=[80, 5, 0]), 5)
    net = scene(rng, [(thing, places), (thing, [m @ twin for m in places])])
    one, other = frame(net, np.eye(4), thing), frame(net, twin, thing)
    drafts = [known(net, one + other[2:], places), known(net, other[:2], places[:2])]
    (both,) = unite(net, [drafts[first], drafts[1 - first]], np.ones(len(net.points), bool), PARAMETERS)
    assert len(both.curves) == 4 and len(both.poses) == 10
    home, gaps = homes(net, both, thing, [*places, *(m @ twin for m in places)])
    assert sorted(home) == list(range(10)) and gaps.max() < 0.2


def test_things_that_differ_stay_what_they_are(rng):
    first, second = shapes.ornament(rng, 4, size=24), shapes.ornament(rng, 4, size=24)
    net = scene(rng, [(first, row(ALONG, 3)), (second, row(ALONG, 3, TURNED))])
    drafts = [known(net, frame(net, np.eye(4), first), row(ALONG, 3)),
              known(net, frame(net, TURNED, second), row(ALONG, 3))]  # fmt: skip
    every = np.ones(len(net.points), bool)
    assert unite(net, drafts, every, PARAMETERS) is drafts
    assert unite(net, drafts[:1], every, PARAMETERS) == drafts[:1]


def test_two_alike_parts_of_one_thing_stay_two(rng):
    """The halves of an arch and things of their own: a window is not two halves of one."""
    half = shapes.circle(25)[:60] + [0, 0, 0.2]
    other = naive.about([0, 0, 1], np.pi, [-40, 0, 0])
    thing = [half, naive.moved(other, half), *(c + [-40, 0, 25] for c in shapes.ornament(rng, 2, size=24))]
    places = row(naive.rigid(shift=[0, 90, 8]), 3)
    net = scene(rng, [(thing, places)])
    drafts = [known(net, frame(net, np.eye(4), thing), places)]
    assert unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS) is drafts


def test_no_drafts_one_curve_and_one_occurrence(rng):
    net, thing, places, drafts = two_rows(rng)
    every = np.ones(len(net.points), bool)
    assert unite(net, [], every, PARAMETERS) == []
    single = [drafts[0].part([0])]
    assert unite(net, single, every, PARAMETERS) is single
    # one occurrence each: together they are two
    (one,) = unite(net, [d.part(cells=[1]) for d in drafts], every, PARAMETERS)
    home, gaps = homes(net, one, thing, [places[1], places[5]])
    assert len(one.poses) == 2 and sorted(home) == [0, 1] and gaps.max() < 0.2
    # what no free sample shows is no whole: the parts stay
    same = unite(net, drafts, ~every, PARAMETERS)
    assert same is drafts


# ---- figures that are cut into parts at other places


def wave(begin, order, *, radius=60.0, count=120):
    """One period, from an angle in radians on, of two waves of that order around the z axis."""
    a = begin + np.linspace(0, 2 * np.pi / order, count)
    turn = np.c_[np.cos(a), np.sin(a), np.zeros(count)]
    inner = 7 * np.sin(order * a) + 4 * np.cos(2 * order * a)
    outer = 24 + 5 * np.cos(order * a) - 3 * np.sin(3 * order * a)
    return [turn * (radius + way)[:, None] + np.c_[0 * a, 0 * a, way / 2] for way in (inner, outer)]


def two_rings(rng, order=6, *, lost=(), orders=None):
    """Two rings of waves, the second turned, cut half a period further; a draft of each without the `lost` cells."""
    orders = orders or (order, order)
    there = naive.rigid(naive.turn([0.2, 1, 0.1], 0.4), [40, 220, 15])
    steps = [[naive.about([0, 0, 1], 2 * np.pi * k / o, [0, 0, 0]) for k in range(o)] for o in orders]
    rings = [(wave(0.0, orders[0]), steps[0]), (wave(np.pi / orders[1], orders[1]), [there @ m for m in steps[1]])]
    net = scene(rng, rings)
    seen = [k for k in range(orders[1]) if k not in lost]
    drafts = [
        known(net, frame(net, np.eye(4), rings[0][0]), steps[0], transformation=0),
        known(net, frame(net, there, rings[1][0]), [there @ steps[1][k] @ np.linalg.inv(there) for k in seen],
              transformation=1),
    ]  # fmt: skip
    return net, rings, there, drafts


@pytest.mark.parametrize("lost", [(), (2,)])
def test_two_rings_cut_at_other_places_become_one_template(rng, lost):
    net, rings, there, drafts = two_rings(rng, lost=lost)
    (one,) = unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.poses) == 12 and one.orbital.sum() == 6 and one.keys.shape == (12, 1)
    truth = np.concatenate([np.concatenate(frame(net, m, thing)) for thing, places in rings for m in places])
    shown = np.concatenate([naive.moved(m, c) for m in one.poses for c in one.curves])
    assert (cKDTree(truth).query(shown)[0] < 0.6).mean() > 0.97
    assert (cKDTree(shown).query(truth)[0] < 1.5).mean() > 0.97


def test_the_motion_of_a_figure_is_that_of_the_whole(rng):
    """It begins as one that a part tells, and that is wrong far from it."""
    net, _, there, drafts = two_rings(rng)
    truth = shapes.in_frame(net, there @ naive.about([0, 0, 1], np.pi / 3, [0, 0, 0]))
    rough = truth @ naive.rigid(naive.turn([1, 2, 3], np.radians(1.0)), [0.5, -0.8, 0.3])
    other = shapes.in_frame(net, naive.rigid(shift=[0, 90, 0]))
    ((a, b, m),) = same_figures(drafts, np.array([other, rough]), radius=RADIUS)
    assert (a, b) in ((0, 1), (1, 0))
    points = naive.moved(drafts[a].poses[0], np.concatenate(drafts[a].curves))
    turned = [naive.moved(truth @ shapes.in_frame(net, naive.about([0, 0, 1], k * np.pi / 3, [0, 0, 0])), points)
              for k in range(6)]  # fmt: skip
    if a == 1:
        back = shapes.in_frame(net, np.linalg.inv(there))
        turned = [naive.moved(back @ shapes.in_frame(net, there @ naive.about([0, 0, 1], k * np.pi / 3, [0, 0, 0])
                                                     @ np.linalg.inv(there)), points) for k in range(6)]  # fmt: skip
    assert min(np.linalg.norm(naive.moved(m, points) - t, axis=1).max() for t in turned) < 0.3


def test_rings_of_another_order_are_not_the_same(rng):
    net, _, there, drafts = two_rings(rng, orders=(6, 8))
    motions = np.array([shapes.in_frame(net, there)])
    assert same_figures(drafts, motions, radius=RADIUS) == []
    assert same_figures(drafts, np.zeros((0, 4, 4)), radius=RADIUS) == []


# ---- curves that are copies of each other


def congruent(curves, owner):
    p = PARAMETERS
    alike = find_alike(curves, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, epsilon=p.epsilon)
    return congruent_parts(alike, owner, l0=p.l0)


def test_motions_lead_from_the_first_place_to_the_others(rng):
    thing = shapes.ornament(rng, 3, size=24)
    places = [np.eye(4), TURNED, naive.rigid(naive.turn([1, 0, 0], 2.0), [110, 0, 20])]
    curves = [naive.moved(m, c) + 0.1 * rng.normal(size=c.shape) for m in places for c in thing]
    curves += [c + [0, 0, 150] for c in shapes.ornament(rng, 2, size=24)]
    order = rng.permutation(len(curves))
    (one,) = congruent([curves[k] for k in order], [int(k) // 3 for k in order])
    assert np.allclose(one[0][0], np.eye(4)) and len(one) == 3
    sets = [sorted(int(order[k]) for k in members) for _, members in one]
    assert sorted(sets) == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    start = places[sets[0][0] // 3]
    for (motion, _), members in zip(one, sets):
        truth = places[members[0] // 3] @ np.linalg.inv(start)
        at = np.concatenate([curves[k] for k in sets[0]])
        assert np.linalg.norm(naive.moved(motion, at) - naive.moved(truth, at), axis=1).mean() < 0.3


@pytest.mark.parametrize("count, owners, groups", [(3, 1, 1), (2, 1, 0), (2, 2, 1), (1, 2, 1)])
def test_how_many_curves_make_a_copy(rng, count, owners, groups):
    """Within one template three; between two they must be nearly all of both."""
    thing = shapes.ornament(rng, count, size=24)
    rest = [c + [0, 0, 60] for c in shapes.ornament(rng, 2, size=24)] if owners == 1 else []
    curves = thing + [naive.moved(TURNED, c) for c in thing] + rest
    owner = [0] * count + [owners - 1] * count + [0] * len(rest)
    assert len(congruent(curves, owner)) == groups


def test_templates_that_have_a_part_in_common_are_not_one(rng):
    thing, more, other = (shapes.ornament(rng, n, size=24) for n in (3, 2, 2))
    curves = thing + [c + [0, 0, 30] for c in more]
    curves += [naive.moved(TURNED, c) for c in [*thing, *(c + [0, 0, 30] for c in other)]]
    assert congruent(curves, [0] * 5 + [1] * 5) == []


def test_places_are_chained_by_the_motions_between_them(rng):
    """Five places of one thing and two of another, known by the motions between some pairs of them."""
    places = [shapes.random_motion(rng) for _ in range(5)]
    pairs = [(1, 3), (3, 4), (0, 1), (2, 4)]
    found = [(places[b] @ np.linalg.inv(places[a]), [a], [b]) for a, b in pairs]
    other = shapes.random_motion(rng)
    # what would join two places that are known already, or two groups, tells nothing new
    found += [(other, [7], [8]), (shapes.random_motion(rng), [0], [2]), (shapes.random_motion(rng), [7], [3])]
    one, two = _grouped(found)
    assert sorted(members[0] for _, members in one) == [0, 1, 2, 3, 4]
    start = places[one[0][1][0]]
    for motion, members in one:
        assert np.allclose(motion @ start, places[members[0]])
    assert [members for _, members in two] == [[7], [8]] and np.allclose(two[1][0], other)
    assert _grouped([]) == []


def test_curves_that_are_too_few_or_too_short(rng):
    assert congruent([shapes.wiggle(rng, 40)], [0]) == []
    short = shapes.wiggle(rng, 8, bend=0.4)
    assert congruent([short, naive.moved(TURNED, short)], [0, 1]) == []
