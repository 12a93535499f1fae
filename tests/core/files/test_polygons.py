# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons as triangles: their area, their corners, and the way they face."""

import numpy as np
import pytest

from core.errors import InputError
from core.files.polygons import triangles_of_polygons

SHAPES = {
    "concave": ([(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)], 8),
    "arrow": ([(0, 0), (2, 1), (0, 2), (0.5, 1)], 1.5),
    "corners on straight sides": ([(0, 0), (1, 0), (2, 0), (2, 2), (1, 2), (0, 2)], 4),
    "a hole on a bridge": ([(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)], 12),
    "comb": ([(0, -1), (24, -1), (24, 0)]
             + [p for k in range(5, -1, -1) for p in [(4 * k + 2, 0), (4 * k + 2, 5), (4 * k, 5), (4 * k, 0)]], 84),
}  # fmt: skip


def areas(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("turn", [0, 1, 3])
def test_area_corners_and_side(name, turn):
    shape, area = SHAPES[name]
    frame = np.array([[0.6, 0.8, 0], [0, 0, 1.0]])  # a wall
    points = np.array(shape, float) @ frame + (5e5, 4e6, 100)
    order = np.roll(np.arange(len(points)), turn)
    for corners, sign in ((order, 1), (order[::-1], -1)):
        triangles = triangles_of_polygons(points, corners, np.array([0, len(corners)]))
        found = areas(points, triangles) @ np.cross(*frame) * sign
        assert len(triangles) == len(points) - 2
        assert found.min() > 1e-6
        assert found.sum() == pytest.approx(area, abs=1e-6)
        assert set(triangles.ravel()) == set(range(len(points)))


def test_many_polygons_keep_their_order():
    points = np.array([(0, 0, 0), (2, 1, 0), (0, 2, 0), (0.5, 1, 0), (3, 3, 0)], float)
    index, offsets = np.array([0, 1, 4, 0, 1, 2, 3, 4, 2, 1, 0, 1]), np.array([0, 3, 7, 10, 12])
    triangles = triangles_of_polygons(points, index, offsets)
    assert len(triangles) == 1 + 2 + 1
    assert triangles[0].tolist() == [0, 1, 4] and triangles[-1].tolist() == [4, 2, 1]


def test_a_ring_of_many_corners_has_no_slivers_about_one_corner():
    t = np.linspace(0, 2 * np.pi, 41)[:-1]
    points = np.column_stack([np.cos(t), np.sin(t), 0 * t])
    triangles = triangles_of_polygons(points, np.arange(40), np.array([0, 40]))
    assert areas(points, triangles)[:, 2].sum() == pytest.approx(20 * np.sin(2 * np.pi / 40))
    assert np.bincount(triangles.ravel()).max() < 20


@pytest.mark.parametrize("corners", [[0, 0, 0, 0], [0, 1, 0, 1], [0, 1, 1, 2], [0, 2, 1, 3]])
def test_polygons_that_are_none_end_all_the_same(corners):
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    triangles = triangles_of_polygons(points, np.array(corners), np.array([0, 4]))
    assert triangles.shape == (2, 3)


def test_a_polygon_of_too_many_corners_is_refused():
    t = np.linspace(0, 6, 30_000)
    with pytest.raises(InputError, match="a polygon of 30000 corners; triangulate"):
        triangles_of_polygons(np.column_stack([np.cos(t), np.sin(t), 0 * t]), np.arange(30_000), np.array([0, 30_000]))


def test_nothing_gives_nothing():
    assert triangles_of_polygons(np.zeros((0, 3)), np.zeros(0, int), np.zeros(1, int)).shape == (0, 3)
