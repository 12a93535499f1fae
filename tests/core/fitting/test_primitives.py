# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from core.fitting import Arc, Bezier, Circle, Line
from tests.core.fitting import drawings

ARC = Arc(np.array([1.0, 0, 0]), np.array([np.cos(2), np.sin(2), 0.0]), np.array([np.cos(4), np.sin(4), 0.0]))
ALL = [
    Line(np.zeros(3), np.array([1.0, 2, 3])),
    ARC,
    Circle(np.array([1.0, 2, 3]), np.array([0, 0.6, 0.8]), 2.0, np.array([3.0, 2, 3])),
    Bezier(np.zeros(3), np.array([1.0, 0, 0]), np.array([1.0, 1, 0]), np.array([0, 1, 1.0])),
]


def on_beziers(primitive, count=40):
    t = np.linspace(0, 1, count)[:, None]
    s = 1 - t
    parts = [s**3 * a + 3 * s * s * t * b + 3 * s * t * t * c + t**3 * d for a, b, c, d in primitive.beziers()]
    return np.concatenate(parts)


def test_an_arc_knows_its_circle():
    assert ARC.angle == pytest.approx(4)
    assert ARC.radius == pytest.approx(1)
    assert ARC.centre == pytest.approx(np.zeros(3), abs=1e-12)
    assert ARC.normal == pytest.approx([0, 0, 1])
    assert ARC.length == pytest.approx(4)
    assert ARC.tangents() == pytest.approx(np.array([[0, 1, 0], [-np.sin(4), np.cos(4), 0]]), abs=1e-12)


@pytest.mark.parametrize("shape", [ARC, ALL[2]])
def test_the_handles_of_an_arc_stay_within_its_radius_times_three_ten_thousandths(shape):
    off = np.linalg.norm(on_beziers(shape) - shape.centre, axis=1) - shape.radius
    assert np.abs(off).max() < 3e-4 * shape.radius


@pytest.mark.parametrize("shape", ALL)
def test_all_forms_of_a_primitive_agree(shape):
    points = shape.points(0.01)
    ring = np.concatenate([points, points[:1]]) if shape.kind == "circle" else points
    assert np.linalg.norm(np.diff(ring, axis=0), axis=1).max() < 0.0101 if shape.kind != "bezier" else True
    assert np.linalg.norm(np.diff(ring, axis=0), axis=1).sum() == pytest.approx(shape.length, rel=1e-3)
    assert (points[0] == shape.start).all() or np.allclose(points[0], shape.start)
    assert on_beziers(shape)[0] == pytest.approx(shape.start) and on_beziers(shape)[-1] == pytest.approx(shape.end)
    first = shape.points(1e-3)[1] - shape.points(1e-3)[0]
    assert shape.tangents()[0] == pytest.approx(first / np.linalg.norm(first), abs=2e-3)


@pytest.mark.parametrize("shape", ALL)
def test_moved_and_reversed(shape):
    m = drawings.motion()
    assert shape.moved(m).points(0.1) == pytest.approx(drawings.moved(shape.points(0.1), m), abs=1e-9)
    back = shape.reversed()
    assert back.start == pytest.approx(shape.end) and back.length == pytest.approx(shape.length)
    assert back.tangents()[0] == pytest.approx(-shape.tangents()[1])
    assert back.reversed().points(0.1) == pytest.approx(shape.points(0.1))
