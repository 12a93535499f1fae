# SPDX-License-Identifier: GPL-3.0-or-later
"""What is made of meshes that are not as they should be, and which are refused."""

import numpy as np
import pytest

from core.detection import TriangleMesh
from core.detection.mesh.mesh import triangulate
from core.errors import InputError
from tests.core.detection import surfaces

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TWO = np.array([[0, 1, 2], [0, 2, 3]])


def volume(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def test_polygons_become_fans_and_know_their_source():
    triangles, source = triangulate([[0, 1, 2, 3], [4, 5, 6], [7, 8, 9, 10, 11]])
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6], [7, 8, 9], [7, 9, 10], [7, 10, 11]]
    assert source.tolist() == [0, 0, 1, 2, 2, 2]
    assert np.array_equal(triangulate(np.array([[0, 1, 2, 3]]))[0], TWO)


def test_duplicates_unused_vertices_and_flat_faces_go():
    vertices = np.concatenate([[[np.nan, 0, 0]], SQUARE, SQUARE[[2]], [[2.0, 2, 0]]])
    faces = [[1, 2, 3], [1, 5, 4], [1, 3, 6], [1, 1, 2], [3, 1, 2], [1, 3, 5]]
    mesh = TriangleMesh.of(vertices, faces)  # [1, 3, 6] lies on a line, [3, 1, 2] repeats, 5 is a copy of 3
    assert len(mesh.vertices) == 4 and len(mesh.faces) == 2
    assert np.array_equal(vertices[mesh.vertex_source], mesh.vertices)
    assert mesh.face_source.tolist() == [0, 1]
    assert len(mesh.edges) == 5 and mesh.edge_faces.tolist().count(1) == 4


@pytest.mark.parametrize("seed", range(4))
def test_turned_faces_are_turned_back(seed):
    v, f = surfaces.sphere(2)
    turned = np.random.default_rng(seed).random(len(f)) < 0.4
    mesh = TriangleMesh.of(v, np.where(turned[:, None], f[:, ::-1], f))
    assert volume(mesh) == pytest.approx(volume(TriangleMesh.of(v, f)))


def test_a_closed_shell_faces_outwards_and_a_cavity_inwards():
    v, f = surfaces.sphere(2)
    outer = TriangleMesh.of(v, f[:, ::-1])
    assert volume(outer) > 0
    both = TriangleMesh.of(np.concatenate([v, 0.5 * v]), np.concatenate([f, f[:, ::-1] + len(v)]))
    assert volume(both) == pytest.approx(volume(outer) * (1 - 0.5**3))


def test_an_open_surface_keeps_the_side_it_was_given():
    up = TriangleMesh.of(SQUARE, TWO)
    down = TriangleMesh.of(SQUARE, TWO[:, ::-1])
    for mesh, z in ((up, 1), (down, -1)):
        a, b, c = mesh.vertices[mesh.faces[0]]
        assert np.cross(b - a, c - a)[2] == z


def test_three_faces_on_one_edge_are_kept():
    vertices = np.concatenate([SQUARE, [[0.5, 0.5, 1]]])
    mesh = TriangleMesh.of(vertices, np.array([[0, 1, 2], [0, 2, 3], [0, 2, 4]]))
    assert mesh.edge_faces.max() == 3 and len(mesh.faces) == 3


@pytest.mark.parametrize(
    "vertices, faces, message",
    [
        (SQUARE, np.zeros((0, 3), int), "no faces"),
        (SQUARE, [], "no faces"),
        (SQUARE, None, "no faces"),
        (SQUARE, [[0, 1]], "face 0 has 2 vertices"),
        (SQUARE, [[0, 1, 7]], "names vertex 7, but there are 4"),
        (SQUARE, [[0, 1, -1]], "names vertex -1"),
        (SQUARE, [[0.5, 1, 2]], "whole numbers"),
        (np.where(SQUARE == 1, np.nan, SQUARE), TWO, "vertex 1 has a coordinate that is not a finite number"),
        (np.where(SQUARE == 1, np.inf, SQUARE), TWO, "vertex 1 has"),
        (SQUARE * [1, 0, 0], TWO, "zero area"),
        (SQUARE[:, :2], TWO, r"shape \(4, 2\)"),
        ([["a", "b", "c"]], TWO, "not numbers"),
    ],
)
def test_what_cannot_be_used_is_named(vertices, faces, message):
    with pytest.raises(InputError, match=message):
        TriangleMesh.of(vertices, faces)
