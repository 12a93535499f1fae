# SPDX-License-Identifier: GPL-3.0-or-later
"""A curve that runs on through all cells of an orbit becomes one long curve, as far as the input shows it."""

from __future__ import annotations

import numpy as np
import pytest

from core.courses import find_courses
from core.drafts import seen_share
from tests import naive
from tests.core import shapes

RADIUS, SHORTEST, REACH = 2.5, 25.0, 3.0
# A course reaches beyond the last sample by as much as samples show it: the radius.


def draft_of(net, orbit, curves, keys, **more):
    """A draft in the network's frame, and what the network shows of it."""
    poses = orbit.power(keys)
    evidence = seen_share(net, curves, poses, radius=RADIUS)
    return shapes.draft(curves, poses, keys=keys, evidence=evidence, **more)


def courses_of(net, orbit, draft, free=None, shortest=SHORTEST):
    free = np.ones(len(net.points), bool) if free is None else free
    courses, left = find_courses(net, orbit, draft, free, radius=RADIUS, shortest=shortest)
    taken = [k for k, curve in enumerate(draft.curves) if not any(curve is c for c in left.curves)]
    return courses, np.array(taken, np.int64)


def broken(rng, curve, *, lost=3, pieces=4, noise=0.2):
    """Noisy pieces of a curve with small holes between them."""
    parts = np.array_split(curve, pieces)
    parts = [p[:-lost] for p in parts[:-1]] + parts[-1:]
    return [p + noise * rng.normal(size=p.shape) for p in parts]


STEP = np.array([30.0, 4, 0])
WAY = STEP / np.linalg.norm(STEP)


def facade(rng, cornices, *, cells=range(6), pieces=4):
    """A row of things with cornices between places along the row; orbit and draft of a thing and the first cornice."""
    thing = shapes.ornament(rng, 2)
    curves = [c + k * STEP - [0, 25, 0] for k in cells for c in thing]
    for begin, end in cornices:
        curves += broken(rng, np.arange(begin, end + 0.5)[:, None] * WAY, pieces=pieces)
    net = shapes.network([c + 0.1 * rng.normal(size=c.shape) for c in curves], smoothing=1.0)
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [len(cells) - 1])
    period = np.arange(-4.0, np.linalg.norm(STEP) - 3)[:, None] * WAY
    own = [shapes.to_frame(net, c) for c in (naive.resample(thing[0] - [0, 25, 0], 1.0), period)]
    return net, orbit, draft_of(net, orbit, own, np.asarray(cells)[:, None])


def ends_along(net, line):
    """Where a curve of the frame begins and ends along the row."""
    return sorted(float(p @ WAY) for p in net.to_world(line[[0, -1]]))


def off(net, line, truth, closed=False):
    """Mean distance of a curve of the frame from a curve of the world."""
    return float(np.mean([naive.distance_to_polyline(p, truth, closed) for p in net.to_world(line)]))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("begin, end", [(-11, 171), (6, 140), (-3, 126)])
def test_a_cornice_is_one_course_that_ends_where_the_input_ends(rng, begin, end, turned):
    """The ends lie somewhere in a cell, nowhere near the borders at which cells are cut."""
    net, orbit, draft = facade(rng, [(begin, end)])
    if turned:
        draft = draft_of(net, orbit, [draft.curves[0], draft.curves[1][::-1]], draft.keys)
    courses, taken = courses_of(net, orbit, draft)
    assert taken.tolist() == [1], "the thing is none"
    (course,) = courses
    assert not course.closed and 0.85 < course.support <= 1
    assert np.allclose(ends_along(net, course.points), [begin, end], atol=REACH)
    assert naive.length(course.points) == pytest.approx(end - begin, abs=2 * REACH)
    assert off(net, course.points, np.array([-50.0, 250])[:, None] * WAY) < 0.25
    steps = np.linalg.norm(np.diff(course.points, axis=0), axis=1)
    assert 0.8 < steps.min() and steps.max() < 1.1


def test_a_small_hole_is_bridged_and_a_large_one_parts_courses(rng):
    # two steps of a course without a sample part it: 60 edges here
    for hole, expected in ((40, [(-5, 190)]), (85, [(-5, 60), (145, 250)])):
        net, orbit, draft = facade(rng, [(-5, 60), (60 + hole, 60 + hole + (90 if hole < 60 else 105))], cells=range(9))
        courses, _ = courses_of(net, orbit, draft)
        got = sorted(ends_along(net, c.points) for c in courses)
        assert np.allclose(got, expected, atol=REACH)
        assert all(c.support > 0.7 for c in courses)


def test_short_ones_are_left_out(rng):
    net, orbit, draft = facade(rng, [(-5, 60), (145, 200)], cells=range(8))
    assert len(courses_of(net, orbit, draft, shortest=50.0)[0]) == 2
    courses, taken = courses_of(net, orbit, draft, shortest=60.0)
    assert len(courses) == 1 and taken.tolist() == [1]
    courses, taken = courses_of(net, orbit, draft, shortest=90.0)
    assert courses == [] and taken.tolist() == [1], "it is none of the thing's curves all the same"


def test_cornices_of_a_grid_are_one_course_a_row(rng):
    first, second = np.array([30.0, 0, 0]), np.array([5.0, 45, 0])
    rows = {0: (-9, 130), 1: (12, 147), 2: (-20, 100)}
    curves = [c + i * first + j * second + [15, 20, 0] for i in range(5) for j in rows for c in shapes.ornament(rng, 1)]
    for j, (begin, end) in rows.items():
        curves += broken(rng, shapes.line(end - begin + 1, [begin, 0, 0]) + j * second)
    net = shapes.network(curves, smoothing=1.0)
    orbit = shapes.orbit(net, "grid", [naive.rigid(shift=first), naive.rigid(shift=second)], [4, 2])
    keys = [(i, j) for i in range(5) for j in rows]
    period = shapes.to_frame(net, shapes.line(30))
    courses, taken = courses_of(net, orbit, draft_of(net, orbit, [period], keys))
    assert taken.tolist() == [0] and len(courses) == 3
    got = {}
    for course in courses:
        world = net.to_world(course.points)
        j = int(round(world[:, 1].mean() / 45))
        got[j] = sorted(world[[0, -1], 0] - j * second[0])
    assert sorted(got) == sorted(rows)
    for j in rows:
        assert np.allclose(got[j], rows[j], atol=REACH)


def ring(rng, shown, *, fold=8, radius=30.0, height=12.0, slide=0.0):
    """Things about an axis with a ring, or a helix, of which a share is shown; orbit, draft and the true curve."""
    step = naive.about([0, 0, 1], 2 * np.pi / fold, [0, 0, 0], along=slide)
    turns = 1 if not slide else 2
    cells = range(fold * turns)
    angle = np.arange(0, turns * 2 * np.pi * radius * shown) / radius
    line = np.c_[radius * np.cos(angle), radius * np.sin(angle), height + slide * fold * angle / (2 * np.pi)]
    thing = [c + [45, 0, 0] for c in shapes.ornament(rng, 1)]
    curves = [naive.moved(np.linalg.matrix_power(step, k), c) for k in cells for c in thing] + broken(rng, line)
    net = shapes.network(curves, smoothing=1.0)
    kind = "screw" if slide else "rotation"
    orbit = shapes.orbit(net, kind, [step], [len(cells) - 1], closed=not slide)
    period = np.linspace(0, 2 * np.pi / fold, int(2 * np.pi * radius / fold) + 1)[:-1] + 0.1
    part = np.c_[radius * np.cos(period), radius * np.sin(period), height + slide * fold * period / (2 * np.pi)]
    own = [shapes.to_frame(net, c) for c in (part, naive.resample(thing[0], 1.0))]
    return net, orbit, draft_of(net, orbit, own, np.array(cells)[:, None]), line


@pytest.mark.parametrize("shown", [1.0, 0.7])
def test_a_ring_about_the_axis_is_one_closed_course(rng, shown):
    net, orbit, draft, _ = ring(rng, shown)
    courses, taken = courses_of(net, orbit, draft)
    assert taken.tolist() == [0]
    (course,) = courses
    assert course.closed and course.support == pytest.approx(shown, abs=0.1)
    assert naive.length(course.points, closed=True) == pytest.approx(2 * np.pi * 30, rel=0.02)
    assert off(net, course.points, shapes.circle(30, [0, 0, 12]), closed=True) < 0.8, "what is steadied may move by 0.6"


def test_of_a_ring_that_is_hardly_there_an_arc_is_left(rng):
    net, orbit, draft, line = ring(rng, 0.3)
    (course,), _ = courses_of(net, orbit, draft)
    assert not course.closed and naive.length(course.points) == pytest.approx(naive.length(line), abs=2 * REACH)
    assert off(net, course.points, line) < 0.4


def test_a_helix_along_a_screw_is_one_course(rng):
    net, orbit, draft, line = ring(rng, 1.0, slide=5.0)
    courses, taken = courses_of(net, orbit, draft)
    assert taken.tolist() == [0]
    (course,) = courses
    assert not course.closed and off(net, course.points, line) < 0.4
    assert naive.length(course.points) == pytest.approx(naive.length(line), rel=0.03)


def test_whole_rings_and_things_are_no_courses(rng):
    """A closed curve of a cell, and one that does not go on as its own image."""
    thing = [shapes.circle(9, n=57), shapes.line(20), *shapes.ornament(rng, 2)]
    curves = [c + k * STEP for k in range(6) for c in thing]
    net = shapes.network(curves, closed=[True, False, False, False] * 6)
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [5])
    own = [shapes.to_frame(net, c) for c in thing]
    draft = draft_of(net, orbit, own, np.arange(6)[:, None], closed=[True, False, False, False])
    courses, taken = courses_of(net, orbit, draft)
    assert courses == [] and len(taken) == 0


def test_arcades_are_no_courses(rng):
    """Each arch begins where the one before ends, and goes the other way there."""
    a = np.linspace(0, np.pi, 48)
    span = np.linalg.norm(STEP)
    arch = (span / 2 * (1 - np.cos(a)))[:, None] * WAY + np.c_[0 * a, 0 * a, span / 2 * np.sin(a)]
    net = shapes.network([arch + k * STEP for k in range(6)])
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [5])
    draft = draft_of(net, orbit, [shapes.to_frame(net, arch)], np.arange(6)[:, None])
    courses, taken = courses_of(net, orbit, draft)
    assert courses == [] and len(taken) == 0


def test_a_small_ring_about_the_axis_is_whole_already(rng):
    """Its beginning comes to lie near its end after one step, as that of a course would."""
    ring = shapes.circle(6, [0, 0, 5])
    step = naive.about([0, 0, 1], np.pi / 6, [0, 0, 0])
    things = [naive.moved(np.linalg.matrix_power(step, k), c + [50, 0, 0]) for k in range(12)
              for c in shapes.ornament(rng, 1)]  # fmt: skip
    net = shapes.network([ring, *things], closed=[True] + [False] * len(things))
    orbit = shapes.orbit(net, "rotation", [step], [11], closed=True)
    for closed, count in ((True, 0), (False, 1)):
        draft = draft_of(net, orbit, [shapes.to_frame(net, ring)], np.arange(12)[:, None], closed=[closed])
        assert len(courses_of(net, orbit, draft)[1]) == count


def test_what_is_not_free_makes_no_course(rng):
    net, orbit, draft = facade(rng, [(-11, 171)])
    cornice = net.source[net.curve_of] >= 12
    courses, taken = courses_of(net, orbit, draft, ~cornice)
    assert courses == [] and taken.tolist() == [1]
    courses, _ = courses_of(net, orbit, draft, cornice)
    assert len(courses) == 1
    courses, taken = courses_of(net, orbit, draft, np.zeros(len(cornice), bool))
    assert courses == [] and taken.shape == (0,) and taken.dtype.kind == "i"
    courses, taken = courses_of(net, orbit, draft.part([]))
    assert courses == [] and len(taken) == 0


def test_one_occurrence_is_as_long_as_it_is(rng):
    """A single cell that shows the curve gives its stretch, and what the input shows beside it."""
    net, orbit, draft = facade(rng, [(-20, 50)], pieces=2)
    (course,), _ = courses_of(net, orbit, draft.part(cells=[0]))
    low, high = ends_along(net, course.points)
    assert low == pytest.approx(-20, abs=REACH) and 26 < high < 60


def test_the_draft_and_the_network_stay_as_they_are(rng):
    net, orbit, draft = facade(rng, [(-11, 171)])
    kept = [c.copy() for c in draft.curves], net.points.copy(), orbit.twists.copy()
    courses_of(net, orbit, draft)
    assert all(map(np.array_equal, draft.curves, kept[0]))
    assert np.array_equal(net.points, kept[1]) and np.array_equal(orbit.twists, kept[2])


def sills(rng, *, length, gap_shown, cells=range(6)):
    """A row of things over sills of this length; the gaps between the sills are shown or not."""
    line = shapes.line(int(np.linalg.norm(STEP)) + 1, [0, -20, 0], WAY)
    curves = [c + k * STEP + [15, 0, 6] for k in cells for c in shapes.ornament(rng, 2)]
    for k in cells:
        curves.append((line if gap_shown else line[:length]) + k * STEP)
    net = shapes.network([c + 0.2 * rng.normal(size=c.shape) for c in curves], smoothing=1.0)
    orbit = shapes.orbit(net, "translation", [naive.rigid(shift=STEP)], [len(cells) - 1])
    return net, orbit, line, np.array(cells)[:, None]


def test_what_no_cell_shows_joins_no_sills(rng):
    net, orbit, line, keys = sills(rng, length=18, gap_shown=False)
    joined = shapes.to_frame(net, line)
    draft = draft_of(net, orbit, [joined], keys)
    courses, left = find_courses(net, orbit, draft, np.ones(len(net.points), bool), radius=RADIUS, shortest=SHORTEST)
    assert courses == [] and len(left.curves) == 1
    assert len(left.curves[0]) == pytest.approx(18, abs=2 * RADIUS)
    steps = [np.linalg.matrix_power(naive.rigid(shift=STEP), k) for k in (-1, 0, 1)]
    sill = np.concatenate([naive.moved(m, line[:18]) for m in steps])
    away = [min(np.linalg.norm(sill - p, axis=1)) for p in net.to_world(left.curves[0])]
    assert max(away) < 2 * RADIUS and np.mean(away) < 1
    # Nor does a sill that was drafted as what it is change.
    short = draft_of(net, orbit, [joined[:18]], keys)
    courses, left = find_courses(net, orbit, short, np.ones(len(net.points), bool), radius=RADIUS, shortest=SHORTEST)
    assert courses == [] and left.curves[0] is short.curves[0]


def test_a_piece_whose_gap_is_shown_is_a_course(rng):
    net, orbit, line, keys = sills(rng, length=18, gap_shown=True)
    draft = draft_of(net, orbit, [shapes.to_frame(net, line[:18])], keys)
    courses, taken = courses_of(net, orbit, draft)
    (course,) = courses
    assert taken.tolist() == [0]
    assert naive.length(course.points) == pytest.approx(6 * np.linalg.norm(STEP), abs=2 * REACH)
    assert course.support > 0.9


def test_a_short_gap_that_many_cells_have_is_no_hole(rng):
    net, orbit, line, keys = sills(rng, length=20, gap_shown=False, cells=range(8))
    draft = draft_of(net, orbit, [shapes.to_frame(net, line)], keys)
    courses, left = find_courses(net, orbit, draft, np.ones(len(net.points), bool), radius=RADIUS, shortest=SHORTEST)
    assert courses == [] and len(left.curves[0]) == pytest.approx(20, abs=2 * RADIUS)


def test_a_cornice_over_rows_of_sills_is_a_course_and_they_are_none(rng):
    up = np.array([0, 45.0, 0])
    line = shapes.line(int(np.linalg.norm(STEP)) + 1, [0, -20, 0], WAY)
    keys = np.array([(k, row) for k in range(6) for row in range(3)])
    curves = [c + k * STEP + row * up + [15, 0, 6] for k, row in keys for c in shapes.ornament(rng, 2)]
    curves += [(line if row == 2 else line[:20]) + k * STEP + row * up for k, row in keys]
    net = shapes.network([c + 0.2 * rng.normal(size=c.shape) for c in curves], smoothing=1.0)
    orbit = shapes.orbit(net, "grid", [naive.rigid(shift=STEP), naive.rigid(shift=up)], [5, 2])
    draft = draft_of(net, orbit, [shapes.to_frame(net, line)], keys)
    (course,), left = find_courses(net, orbit, draft, np.ones(len(net.points), bool), radius=RADIUS, shortest=SHORTEST)
    height = net.to_world(course.points) - 2 * up
    assert naive.length(course.points) == pytest.approx(6 * np.linalg.norm(STEP), abs=2 * REACH)
    away = np.linalg.norm(np.cross(height - line[0], STEP / np.linalg.norm(STEP)), axis=1)
    assert away.max() < 1
    assert len(left.curves) == 1 and len(left.curves[0]) == pytest.approx(20, abs=2 * RADIUS)
