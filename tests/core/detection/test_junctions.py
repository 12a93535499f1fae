# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends that are led on to the line ahead of them."""

import numpy as np
import pytest

from core.detection import DetectionParameters, TriangleMesh, detect
from core.detection.curvature.tensor import curvature
from core.detection.lines.junctions import met
from core.detection.lines.surface import Surface
from core.detection.values import RIDGE, VALLEY
from tests.core.detection import surfaces
from tests.core.detection.test_lines import lines_of, row

TURN = np.radians(60)


@pytest.fixture(scope="module")
def flat():
    """A plane with an edge length of about one, its surface and curvature."""
    v, f = surfaces.graph(33, lambda x, y: 0 * x, size=16.0)
    mesh = TriangleMesh.of(v, f)
    return Surface(mesh), curvature(mesh, 0.0)


def joined(flat, *lines, kinds=None, reach=4.0, fold=0.0):
    kinds = kinds or [RIDGE] * len(lines)
    out = met(list(lines), kinds, *flat, reach=reach, turn=TURN, fold=fold)
    return [[x.points[c.nodes[a:b]] for a, b in zip(c.offsets, c.offsets[1:])] for x in out for c in [x.chains()]]


def standing(x, low, high):
    y = np.arange(low, high + 0.01, 0.5)
    return np.column_stack([np.full(len(y), x), y])


def ends(curve):
    return {tuple(np.round(curve[k, :2], 6)) for k in (0, -1)}


@pytest.mark.parametrize("kinds", [None, [RIDGE, VALLEY]])
def test_a_line_is_led_on_to_the_one_it_runs_into(flat, kinds):
    stem, bar = lines_of(row(-8, -3)), lines_of(standing(0.0, -5, 5))
    first, second = joined(flat, stem, bar, kinds=kinds)
    assert ends(first[0]) == {(-8.0, 0.0), (0.0, 0.0)}
    assert len(second) == 1 and len(second[0]) == 21  # the line that is met stays whole
    assert np.linalg.norm(np.diff(first[0], axis=0), axis=1).max() < 1.0


def test_the_reach_is_inclusive_and_nothing_lies_behind(flat):
    bar = lines_of(standing(0.0, -5, 5))
    assert ends(joined(flat, lines_of(row(-8, -4)), bar)[0][0]) == {(-8.0, 0.0), (0.0, 0.0)}
    assert ends(joined(flat, lines_of(row(-8, -4.5)), bar)[0][0]) == {(-8.0, 0.0), (-4.5, 0.0)}
    along = lines_of(standing(-3.6, 8, 12))  # runs past the bar; the way to it would turn by more than 60 degrees
    assert ends(joined(flat, along, lines_of(standing(0.0, 0, 14)))[0][0]) == {(-3.6, 8.0), (-3.6, 12.0)}


def test_of_two_ends_that_aim_at_each_other_one_moves(flat):
    one, two = joined(flat, lines_of(row(-8, -2)), lines_of(standing(0.0, 1.5, 8)))
    assert {(0.0, 1.5)} == ends(one[0]) & ends(two[0])
    assert len(two[0]) == 14 or len(one[0]) == 13


def test_a_line_meets_itself_far_along(flat):
    turn = np.linspace(0, 1.85 * np.pi, 80)
    hook = np.concatenate([standing(6.0, -8, -0.5), 6 * np.column_stack([np.cos(turn), np.sin(turn)])])
    (curve,) = joined(flat, lines_of(hook))[0]
    off = [np.linalg.norm(curve[8:-8] - end, axis=1).min() for end in (curve[0], curve[-1])]
    assert min(off) < 1e-9 and len(curve) > len(hook)  # the far end runs into the stem below the ring


def test_no_way_leads_across_what_is_not_bent(flat):
    stem, bar = lines_of(row(-8, -3)), lines_of(standing(0.0, -5, 5))
    assert ends(joined(flat, stem, bar, fold=0.01)[0][0]) == {(-8.0, 0.0), (-3.0, 0.0)}


@pytest.mark.parametrize("n", [24, 36, 48])
def test_the_edges_of_a_box_meet_at_its_corners(n):
    v, f = surfaces.rounded_box(n)
    mesh = TriangleMesh.of(v, f)
    found = detect(mesh, parameters=DetectionParameters(detail=0.7, junction=4.0))
    assert not found.curves.closed.any()
    for i in range(len(found)):
        p = found.curves.curve(i)
        for end, rest in ((p[0], p[8:]), (p[-1], p[:-8])):
            others = np.concatenate([rest, *(found.curves.curve(j) for j in range(len(found)) if j != i)])
            assert np.linalg.norm(others - end, axis=1).min() < 1e-9
    apart = detect(mesh, detail=0.7)
    assert len(apart) == len(found) and apart.length.sum() < found.length.sum()
