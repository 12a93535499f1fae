# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates that are rigid copies of each other become one, and one that holds a thing twice becomes that thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.copies import unite
from core.errors import Cancelled
from tests import naive
from tests.core import shapes
from tests.core.known_drafts import PARAMETERS, TURNED, frame, known, row, scene


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


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_it_can_be_stopped_between_its_steps(rng, share):
    net, _, _, drafts = two_rows(rng)
    every, ticks = np.ones(len(net.points), bool), []
    unite(net, drafts, every, PARAMETERS, tick=lambda: ticks.append(0))
    last = int(share * (len(ticks) - 1))
    assert len(ticks) > 5

    def stop():
        ticks.append(0)
        if len(ticks) > last:
            raise Cancelled

    ticks.clear()
    with pytest.raises(Cancelled):
        unite(net, drafts, every, PARAMETERS, tick=stop)


TWIN = naive.rigid(naive.turn([0, 0, 1], 0.8), [5, 70, 4])
CELLS = row(naive.rigid(shift=[80, 5, 0]), 5)
BOTH = [*CELLS, *(m @ TWIN for m in CELLS)]


def in_cells(net, curves, cells):
    return known(net, curves, [CELLS[k] for k in cells], keys=np.array(cells)[:, None])


def test_a_thing_and_its_twin_in_drafts_with_other_cells_are_one(rng):
    """Both stand in the cells of one orbit, and the draft of one of them lacks the first cell and has a curve more."""
    thing, more = shapes.ornament(rng, 4, size=24), shapes.ornament(rng, 1, size=24)[0] + [0, 0, 40]
    net = scene(rng, [([*thing, more], CELLS), (thing, [m @ TWIN for m in CELLS])])
    first, twin = frame(net, np.eye(4), [*thing, more]), frame(net, TWIN, thing)
    drafts = [in_cells(net, first, range(5)), in_cells(net, twin, (1, 2, 3, 4))]
    one, rest = unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS)
    assert len(one.curves) == 4 and len(one.poses) == 9 and len(rest.curves) == 1 and len(rest.poses) == 5
    home, gaps = homes(net, one, thing, [m for k, m in enumerate(BOTH) if k != 5])
    assert sorted(home) == list(range(9)) and gaps.max() < 0.2


@pytest.mark.parametrize("everywhere", [True, False])
def test_a_curve_that_one_draft_lacks_goes_to_all_places_that_show_it(rng, everywhere):
    thing, more = shapes.ornament(rng, 4, size=24), shapes.ornament(rng, 1, size=20)[0]
    whole = [*thing, more]
    net = scene(rng, [(whole if everywhere else thing, CELLS), (whole, [m @ TWIN for m in CELLS])])
    drafts = [in_cells(net, frame(net, np.eye(4), thing), range(5)), in_cells(net, frame(net, TWIN, whole), range(5))]
    found = unite(net, drafts, np.ones(len(net.points), bool), PARAMETERS)
    assert sorted((len(d.curves), len(d.poses)) for d in found) == ([(5, 10)] if everywhere else [(1, 5), (4, 10)])


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
