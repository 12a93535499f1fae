# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that are seen in the same cells become one template, and each sample is evidence once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.grouping import at_their_borders, group, kinds_of_cells
from tests import naive
from tests.core import shapes

RADIUS = 2.5
STEP = np.array([60.0, 8, 0])


def row(rng, cells, *, holes=(), clutter=4, noise=0.2, count=6):
    """A row of cells and a draft of all its curves, none of which is known to be seen anywhere.

    cells : for each curve the cells that show it; holes : (curve, cell, share) of what is lost there
    """
    thing = [line + [0, 0, 25 * c] for c, line in enumerate(shapes.ornament(rng, len(cells), size=20))]
    curves = []
    for c, (line, where) in enumerate(zip(thing, cells)):
        for k in where:
            lost = sum(share for curve, cell, share in holes if (curve, cell) == (c, k))
            part = line[int(round(lost * len(line))) :]
            if len(part) > 1:
                curves.append(part + k * STEP + noise * rng.normal(size=part.shape))
    curves += [shapes.wiggle(rng, 40) + rng.uniform(0, 1, size=3) * [60.0 * count, 20, 10] for _ in range(clutter)]
    net = shapes.network(curves, smoothing=1.5)
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [count - 1])
    keys = np.arange(count)[:, None]
    clean = [shapes.to_frame(net, naive.resample(c, 1.0)) for c in thing]
    return net, shapes.draft(clean, orbit.power(keys), keys=keys, evidence=np.zeros((count, len(cells))))


def parts(drafts, draft):
    """The groups as {(curves, cells)}, by the curves' and the cells' numbers in the whole draft."""
    out = set()
    for one in drafts:
        # of a curve that is two a group may have a part
        members = frozenset(next(k for k, c in enumerate(draft.curves) if np.shares_memory(c, x)) for x in one.curves)
        out.add((members, frozenset(one.keys[:, 0].tolist())))
    return out


@pytest.mark.parametrize("seed", range(3))
def test_curves_of_the_same_cells_are_one_template(seed):
    rng = np.random.default_rng(seed)
    every, some, others = range(6), (0, 3), (1, 4)
    net, draft = row(rng, [every, every, some, some, others, (2,), ()])
    drafts, free = group(net, draft, np.ones(len(net.points), bool), radius=RADIUS)
    expected = {((0, 1), every), ((2, 3), some), ((4,), others)}
    assert parts(drafts, draft) == {(frozenset(a), frozenset(b)) for a, b in expected}
    shown_by = np.isin(net.source[net.curve_of], range(18))
    assert free[shown_by].mean() < 0.03, "what they explain is taken away"
    assert free[net.source[net.curve_of] == 18].mean() > 0.5, "a curve that is seen once explains nothing"


@pytest.mark.parametrize("seed", range(5))
def test_what_holds_for_any_groups(seed):
    """Curves that are seen here and there, by halves and among clutter."""
    rng = np.random.default_rng(seed)
    cells = [np.flatnonzero(rng.random(6) < rng.choice([0.3, 0.6, 1.0])) for _ in range(7)]
    holes = [(c, k, rng.uniform(0, 0.9)) for c in range(7) for k in range(6) if rng.random() < 0.3]
    net, draft = row(rng, cells, holes=holes)
    before = rng.random(len(net.points)) < 0.9
    kept = before.copy(), draft.poses.copy(), [c.copy() for c in draft.curves]
    drafts, free = group(net, draft, before, radius=RADIUS)
    groups = parts(drafts, draft)
    members = [(line.ctypes.data, len(line)) for one in drafts for line in one.curves]
    assert len(groups) == len(drafts) and len(members) == len(set(members)), "no curve is in two templates"
    assert len({where for _, where in groups}) == len(groups), "nor are two templates in the same cells"
    for one in drafts:
        assert len(one.poses) >= 2 and one.transformation == draft.transformation
        assert np.array_equal(one.poses, draft.poses[one.keys[:, 0]])
        assert one.evidence.shape == (len(one.poses), len(one.curves)) == (len(one.orbital), len(one.closed))
        share = naive.seen_share(net.points[before], net.tangents[before], one.curves, one.poses, radius=RADIUS)
        assert (one.evidence <= share + 0.1).all(), "evidence is what the free samples show, or less"
    longest = [max(map(len, one.curves)) for one in drafts]
    assert longest == sorted(longest, reverse=True)
    assert not (free & ~before).any()
    lines = [naive.placed(one.curves, one.poses) for one in drafts]
    for i in np.flatnonzero(before & ~free):
        near = [naive.lies_along(net.points[i], net.tangents[i], *x, radius=RADIUS, cosine=0.7, most=4) for x in lines]
        assert max(k for k, _ in near) >= 0, "what is taken away lies along a template"
    assert np.array_equal(before, kept[0]) and np.array_equal(draft.poses, kept[1])
    assert all(map(np.array_equal, draft.curves, kept[2]))


def test_the_order_of_the_curves_does_not_matter(rng):
    net, draft = row(rng, [range(6), range(6), (0, 3), (0, 3), (1, 4)], holes=[(1, 2, 0.6), (0, 4, 0.3)])
    free = np.ones(len(net.points), bool)
    first = parts(group(net, draft, free, radius=RADIUS)[0], draft)
    for _ in range(3):
        order, cells = rng.permutation(5), rng.permutation(6)
        drafts, _ = group(net, draft.part(order, cells), free, radius=RADIUS)
        assert parts(drafts, draft) == first


def test_a_hole_does_not_take_a_curve_out_of_its_template(rng):
    net, draft = row(rng, [range(6)] * 3, holes=[(1, 2, 1.0), (1, 3, 0.7), (2, 4, 0.8), (0, 5, 0.5)])
    (one,), _ = group(net, draft, np.ones(len(net.points), bool), radius=RADIUS)
    assert len(one.curves) == 3 and len(one.poses) == 6
    assert one.evidence[2, [k for k in range(3) if one.curves[k] is draft.curves[1]][0]] < 0.3


def test_a_curve_of_which_a_third_is_seen_belongs_to_what_is_seen_in_its_cells(rng):
    net, draft = row(rng, [range(6)] * 3, holes=[(2, k, 0.65) for k in range(6)], clutter=0)
    (one,), _ = group(net, draft, np.ones(len(net.points), bool), radius=RADIUS)
    assert len(one.curves) == 3 and len(one.poses) == 6
    assert 0.25 < one.evidence[:, 2].mean() < 0.5 and one.evidence[:, :2].min() > 0.9


def test_a_sample_is_evidence_once(rng):
    net, draft = row(rng, [range(6), (0, 3)], clutter=0)
    every = np.ones(len(net.points), bool)
    drafts, left = group(net, draft, every, radius=RADIUS)
    again, still = group(net, draft, left, radius=RADIUS)
    assert len(drafts) == 2 and again == [] and np.array_equal(still, left)


def test_what_is_seen_beside_its_places_as_well_is_no_curve(rng):
    """A line that crosses a dense bundle of others at a flat angle: two thirds of it are seen, wherever it is."""
    thing = shapes.ornament(rng, 1, size=30)[0]
    step = np.array([45.0, 5, 0])
    places = [naive.rigid(shift=k * step) for k in range(3)]
    bundle = [shapes.line(230, [-50, y, z], step) for y in range(-45, 60, 6) for z in range(30, 90, 6)]
    net = shapes.network([naive.moved(m, thing) for m in places] + bundle)
    poses = [shapes.in_frame(net, m) for m in places]
    line = shapes.line(40, [-8, 0, 60], [60, 30, 12])
    draft = shapes.draft([shapes.to_frame(net, c) for c in (naive.resample(thing, 1.0), line)], poses)
    shown = naive.seen_share(net.points, net.tangents, draft.curves, poses, radius=RADIUS)
    assert shown[:, 1].min() > 0.5, "by what is seen at its places alone it would stay"
    (one,), _ = group(net, draft, np.ones(len(net.points), bool), radius=RADIUS)
    assert len(one.curves) == 1 and one.curves[0] is draft.curves[0]


def test_no_curves_no_samples_and_one_occurrence(rng):
    net, draft = row(rng, [range(6), range(6)])
    every = np.ones(len(net.points), bool)
    for one, free in ((draft.part([]), every), (draft, ~every), (draft.part(cells=[2]), every)):
        drafts, left = group(net, one, free, radius=RADIUS)
        assert drafts == [] and np.array_equal(left, free)


def wings(rng, sills, *, left=(0, 1, 2, 3), right=(5, 6, 7), both=(), noise=0.2):
    """Two wings on one row of cells, each with curves of its own, and a sill 50 long of which each shows a part.

    sills : part (begin, end) of the sill that the left and the right wing show; both : lengths of curves that all have
    """
    own = [line + [0, 0, 25 * c] for c, line in enumerate(shapes.ornament(rng, 4, size=20))]
    shared = [shapes.wiggle(rng, n) + [0, -30 - 10 * i, 0] for i, n in enumerate(both)]
    sill = shapes.line(51, [-5, -15, 5])
    curves, of_right = [], []
    for wing, (cells, (begin, end)) in enumerate(zip((left, right), sills)):
        for k in cells:
            for line in [*own[2 * wing : 2 * wing + 2], *shared, sill[begin:end]]:
                curves.append(line + k * STEP + noise * rng.normal(size=line.shape))
                of_right.append(wing == 1)
    net = shapes.network(curves, smoothing=1.5)
    count = max(*left, *right) + 1
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [count - 1])
    keys = np.arange(count)[:, None]
    clean = [shapes.to_frame(net, naive.resample(c, 1.0)) for c in [*own, *shared, sill]]
    draft = shapes.draft(clean, orbit.power(keys), keys=keys)
    groups, _ = group(net, draft, np.ones(len(net.points), bool), radius=RADIUS)
    return net, draft, groups, np.array(of_right)[net.source][net.curve_of]


@pytest.mark.parametrize("sills", [((0, 35), (15, 51)), ((10, 40), (0, 51)), ((0, 51), (20, 51)), ((0, 25), (26, 51))])
@pytest.mark.parametrize("seed", range(2))
def test_cells_of_two_kinds_are_told_apart_by_a_curve_that_they_show_in_part(seed, sills):
    net, draft, groups, of_right = wings(np.random.default_rng(seed), sills)
    kinds = kinds_of_cells(net, draft, groups, radius=RADIUS)
    assert set(kinds) == {0, 1}
    # The larger wing is the first kind.
    assert (kinds == of_right).mean() > 0.95


@pytest.mark.parametrize(
    "options",
    [
        {"sills": ((0, 51), (0, 51))},
        {"sills": ((0, 51), (0, 0))},
        {"sills": ((0, 35), (15, 51)), "both": (80,)},
        {"sills": ((0, 35), (15, 51)), "right": (5, 6)},
    ],
    ids=["both show it whole", "one shows it", "they share more", "two cells"],
)
def test_cells_need_not_be_told_apart(rng, options):
    net, draft, groups, _ = wings(rng, **options)
    assert kinds_of_cells(net, draft, groups, radius=RADIUS) is None


def at_borders(net, draft):
    """The one group of a row, ended where its curves are seen last, by numbers of curves and cells."""
    free = np.ones(len(net.points), bool)
    found, _ = group(net, draft, free, radius=RADIUS)
    return [parts(at_their_borders(net, draft, one, free, radius=RADIUS), draft) for one in found]


def test_arches_end_before_the_last_column(rng):
    columns, arches = range(7), range(6)
    net, draft = row(rng, [columns, columns, columns, arches, arches], count=7, clutter=2)
    expected = {(frozenset({0, 1, 2}), frozenset(columns)), (frozenset({3, 4}), frozenset(arches))}
    assert at_borders(net, draft) == [expected]


def test_curves_of_a_cell_that_shows_nothing_else(rng):
    """A cell that is cut so that only a part of the thing is in it: too little for an occurrence of the whole."""
    short, long_ = range(6), range(7)
    net, draft = row(rng, [short] * 5 + [long_] * 2, count=7, clutter=2)
    whole = draft.part(cells=range(7))
    free = np.ones(len(net.points), bool)
    one = whole.part(cells=range(6))
    one = replace(one, evidence=np.ones((6, 7)))
    got = parts(at_their_borders(net, whole, one, free, radius=RADIUS), draft)
    assert got == {(frozenset(range(5)), frozenset(short)), (frozenset({5, 6}), frozenset(long_))}
    # What others explain is no evidence.
    gone = ~np.isin(net.source[net.curve_of], np.arange(30, 44))
    got = parts(at_their_borders(net, whole, one, gone, radius=RADIUS), draft)
    assert got == {(frozenset(range(7)), frozenset(short))}


@pytest.mark.parametrize("holes", [[(1, 5, 1.0)], [(1, 2, 1.0), (2, 2, 1.0)], [(1, 5, 0.7), (2, 5, 0.7)]])
def test_holes_end_nothing(rng, holes):
    """One curve is hidden by chance, two in the middle of a row stay, and so does what is seen a little."""
    net, draft = row(rng, [range(6)] * 5, holes=holes, clutter=2)
    assert at_borders(net, draft) == [{(frozenset(range(5)), frozenset(range(6)))}]
