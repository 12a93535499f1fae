# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from core.fitting import Arc, Bezier, Circle, Line, recognised
from tests.core.fitting import drawings


def arc(radius, first, last, centre=(0.0, 0.0, 0.0)):
    angles = np.array([first, (first + last) / 2, last])
    points = radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1) + centre
    return Arc(*points)


def path(*pieces):
    """As Blender keeps it: in single precision."""
    return np.concatenate([p.beziers() for p in pieces]).astype(np.float32)


def moved(pieces, motion):
    return [p.moved(motion) for p in pieces]


@pytest.mark.parametrize("away", [0.0, 40.0])
@pytest.mark.parametrize("last", [0.3, 1.4, 2.5, 4.0, 6.0])
def test_an_arc_of_any_angle_comes_back_as_one(last, away):
    (given,) = moved([arc(2.0, 0.1, 0.1 + last)], drawings.motion())
    given = given.moved(np.block([[np.eye(3), np.full((3, 1), away)], [np.zeros((1, 3)), 1.0]]))
    (found,) = recognised(path(given), tolerance=2e-5 if away else None)
    assert found.kind == "arc"
    assert found.angle == pytest.approx(last, abs=1e-3)
    assert found.radius == pytest.approx(2.0, abs=3e-3)
    t = np.linspace(-last / 2, last / 2, 9)
    assert found.at(t) == pytest.approx(given.at(t), abs=2e-3 if last < 1 else 1e-3)


def test_a_circle_comes_back_as_one():
    given = Circle(np.array([3.0, 4, 5]), np.array([0, 0.6, 0.8]), 1.5, np.array([4.5, 4, 5]))
    (found,) = recognised(path(given), True)
    assert found.kind == "circle" and found.radius == pytest.approx(1.5, abs=1e-4)
    assert found.centre == pytest.approx(given.centre, abs=1e-4)
    assert found.normal == pytest.approx(given.normal, abs=1e-4)


def test_a_window_keeps_its_lines_its_arcs_and_its_corners():
    right, left = arc(2.0, 0, np.pi / 3, (-1, 0, 0)), arc(2.0, 2 * np.pi / 3, np.pi, (1, 0, 0))
    given = [Line(np.array([1.0, -2, 0]), right.start), right, left, Line(left.end, np.array([-1.0, -2, 0]))]
    found = recognised(path(*given))
    assert [p.kind for p in found] == ["line", "arc", "arc", "line"]
    for p, q in zip(found, given):
        assert p.start == pytest.approx(q.start, abs=1e-6) and p.end == pytest.approx(q.end, abs=1e-6)


def test_lines_that_go_on_are_one_and_a_corner_parts_them():
    a, b, c, d = np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0], [3, 2, 0]])
    found = recognised(path(Line(a, b), Line(b, c), Line(c, d)))
    assert [p.kind for p in found] == ["line", "line"]
    assert found[0].end.tolist() == c.tolist()


@pytest.mark.parametrize("by", [0.01, 0.2])
def test_an_arc_with_a_handle_that_was_moved_is_no_arc_any_more(by):
    segments = path(arc(2.0, 0.0, 1.2))
    segments[0, 1] += (0, 0, by)
    (found,) = recognised(segments)
    assert isinstance(found, Bezier) and np.array_equal(found.control, segments[0].astype(float))


def test_a_line_that_turns_back_is_no_line():
    (found,) = recognised(np.array([[[0, 0, 0], [2, 0, 0], [-1, 0, 0], [1.0, 0, 0]]]))
    assert found.kind == "bezier"


def test_what_has_no_length_is_left_out():
    dot = np.zeros((1, 4, 3))
    assert recognised(dot) == () and recognised(np.zeros((0, 4, 3))) == ()
    (line,) = recognised(np.concatenate([dot, Line(np.zeros(3), np.ones(3)).beziers()]))
    assert line.kind == "line"


def test_a_quarter_of_an_ellipse_is_no_arc():
    quarter = path(arc(1.0, 0.0, np.pi / 2)) * np.array([2.0, 1, 1])
    assert [p.kind for p in recognised(quarter)] == ["bezier"]
