# SPDX-License-Identifier: GPL-3.0-or-later
"""Linking, doubled lines, spurs, sharp edges and closest points, each on a case made for it."""

import numpy as np
import pytest

from core.detection import TriangleMesh
from core.detection.curvature.tensor import curvature
from core.detection.lines.extremality import fold_angle
from core.detection.lines.lines import Lines
from core.detection.lines.linking import best_pairs, linked
from core.detection.lines.merging import without_doubles, without_spurs
from core.detection.lines.sharp import boundary_lines, dihedral_angles, sharp_lines
from core.detection.lines.surface import Surface
from tests.core.detection import surfaces


@pytest.fixture(scope="module")
def plane():
    v, f = surfaces.graph(41, lambda x, y: 0 * x, size=10, jitter=0.1)
    mesh = TriangleMesh.of(v, f)
    return mesh, curvature(mesh, mesh.edge_length)


def lines_of(*polylines, fold=1.0):
    """Polylines in the plane z = 0 as lines, every node with the same strength unless `fold` is a list."""
    folds = fold if isinstance(fold, list) else [fold] * len(polylines)
    points, segments, values = [], [], []
    for p, w in zip(polylines, folds):
        p = np.column_stack([np.array(p, float), np.zeros(len(p))])
        first = len(values)
        segments += [(first + i, first + i + 1) for i in range(len(p) - 1)]
        points.append(p)
        values += [w] * len(p)
    points = np.concatenate(points)
    normals = np.tile([0.0, 0, 1], (len(points), 1))
    return Lines(points, normals, np.array(values, float), np.array(values, float), np.array(segments))


def row(x0, x1, y=0.0, step=0.25):
    x = np.arange(x0, x1 + step / 2, step)
    return np.column_stack([x, np.full(len(x), y)])


def joined(lines, plane, gap=2.0, turn=0.7):
    return linked(lines, Surface(plane[0]), plane[1], gap=gap, turn=turn).chains()


def test_pieces_in_a_row_are_joined_up_to_the_gap(plane):
    assert len(joined(lines_of(row(-6, 0), row(1.75, 7)), plane)) == 1
    assert len(joined(lines_of(row(-6, 0), row(2.25, 7)), plane)) == 2


def test_only_a_surface_that_is_bent_their_way_joins_pieces(plane):
    mesh, field = plane
    pieces, surface = lines_of(row(-6, 0), row(1.75, 7)), Surface(mesh)
    fold = fold_angle(np.ones(len(mesh.vertices)), field.width, mesh.edge_length)
    options = {"gap": 2.0, "turn": 0.7, "least": 0.2}
    for bend, pieces_left in ((0.15, 2), (0.25, 1), (-0.5, 2), (0.0, 2)):
        value = bend / fold
        found = linked(pieces, surface, field, value=value, **options).chains()
        assert len(found) == pieces_left
    # bent in the middle only, but enough on average
    middle = np.abs(mesh.vertices[:, 0] - 0.875) < 0.5
    assert len(linked(pieces, surface, field, value=np.where(middle, 1.0, 0) / fold, **options).chains()) == 1


def test_the_bridge_lies_on_the_surface(plane):
    lines = linked(lines_of(row(-6, 0), row(1.75, 7)), Surface(plane[0]), plane[1], gap=2.0, turn=0.7)
    assert np.abs(lines.points[:, 2]).max() < 1e-12
    step = np.linalg.norm(lines.points[lines.segments[:, 0]] - lines.points[lines.segments[:, 1]], axis=1)
    assert step.max() < 1.5 * plane[0].edge_length


def test_pieces_side_by_side_or_round_a_corner_are_not_joined(plane):
    assert len(joined(lines_of(row(-6, 0), row(-6, 0, 1.2)), plane)) == 2
    corner = np.column_stack([np.full(20, 1.2), np.arange(1.2, 6.1, 0.25)])
    assert len(joined(lines_of(row(-6, 0), corner), plane)) == 2


def test_the_straighter_continuation_wins(plane):
    bent = [(1.0 + 0.25 * i, 0.55 + 0.12 * i) for i in range(16)]
    found = joined(lines_of(row(-6, 0), row(1.0, 6), bent), plane)
    nodes = max((found.nodes[a:b] for a, b in zip(found.offsets, found.offsets[1:])), key=len)
    assert 25 in nodes and len(found) == 2  # node 25 begins the straight one


def test_a_bridge_does_not_cross_a_third_piece(plane):
    wall = np.column_stack([np.full(33, 0.9), np.arange(-4, 4.1, 0.25)])
    assert len(joined(lines_of(row(-6, 0), row(1.75, 7), wall), plane)) == 3


def test_an_almost_closed_ring_is_closed(plane):
    turn = np.linspace(0.15, 2 * np.pi - 0.15, 80)
    found = joined(lines_of(4 * np.column_stack([np.cos(turn), np.sin(turn)])), plane)
    assert found.closed.tolist() == [True]


def test_best_pairs_are_each_others_cheapest_first():
    pairs = np.array([[0, 1], [1, 2], [2, 3]])
    assert sorted(map(tuple, best_pairs(pairs, np.array([2.0, 1.0, 2.0]), 4))) == [(1, 2)]
    assert sorted(map(tuple, best_pairs(pairs, np.array([1.0, 2.0, 1.0]), 4))) == [(0, 1), (2, 3)]


def test_the_weaker_of_two_lines_side_by_side_goes():
    lines = without_doubles(lines_of(row(-6, 6), row(-2, 5, 0.4), fold=[1.0, 0.5]), 0.5)
    assert lines.chains().lengths(lines.points).tolist() == pytest.approx([12.0])
    apart = lines_of(row(-6, 6), row(-2, 5, 0.6), fold=[1.0, 0.5])
    assert len(without_doubles(apart, 0.5).chains()) == 2


def test_crossing_lines_are_no_doubles():
    across = np.column_stack([np.zeros(25), np.arange(-3, 3.1, 0.25)])
    assert len(without_doubles(lines_of(row(-6, 6), across), 0.5).chains()) == 2


def test_spurs_go_and_long_branches_stay():
    base = lines_of(row(-6, 6))
    for length, left in ((1.0, 1), (5.0, 3)):
        n = round(length / 0.25)
        points = np.column_stack([np.zeros(n), 0.25 * np.arange(1, n + 1), np.zeros(n)])
        chain = np.r_[24, 49 + np.arange(n)]
        branch = base.extended(
            points, np.tile([0.0, 0, 1], (n, 1)), np.ones(n), np.ones(n), np.stack([chain[:-1], chain[1:]], 1)
        )
        assert len(without_spurs(branch, 2.0).chains()) == left


def test_closest_points_against_dense_sampling():
    rng = np.random.default_rng(0)
    v, f = surfaces.graph(12, lambda x, y: 0.3 * np.sin(3 * x), seed=2)
    mesh = TriangleMesh.of(v, f)
    queries = np.column_stack([rng.uniform(-1.1, 1.1, (60, 2)), rng.uniform(-0.3, 0.3, 60)])
    face, weight, distance = Surface(mesh).closest(queries)
    assert (weight >= 0).all() and np.allclose(weight.sum(axis=1), 1)
    feet = np.einsum("kc,kcd->kd", weight, mesh.vertices[mesh.faces[face]])
    assert np.allclose(np.linalg.norm(feet - queries, axis=1), distance)
    s, t = np.meshgrid(np.linspace(0, 1, 13), np.linspace(0, 1, 13))
    inside = s + t <= 1 + 1e-9
    s, t = s[inside], t[inside]
    dense = np.einsum("wc,mcd->mwd", np.stack([1 - s - t, s, t], 1), mesh.vertices[mesh.faces]).reshape(-1, 3)
    best = np.array([np.linalg.norm(dense - q, axis=1).min() for q in queries])
    assert (distance <= best + 1e-12).all() and (distance >= best - 0.02).all()


def cube():
    return np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)]), [
        [0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3],
    ]  # fmt: skip


def test_sharp_edges_of_a_cube():
    mesh = TriangleMesh.of(*cube())
    assert sorted(np.degrees(dihedral_angles(mesh)).round(9)) == [0.0] * 6 + [90.0] * 12
    field = curvature(mesh, 0.0)
    assert len(sharp_lines(mesh, field, np.radians(90)).segments) == 12
    assert len(sharp_lines(mesh, field, np.radians(90.001)).segments) == 0
    assert len(boundary_lines(mesh, field).segments) == 0


def test_the_boundary_of_an_open_box_is_one_loop():
    v, f = cube()
    mesh = TriangleMesh.of(v, f[:-1])
    found = boundary_lines(mesh, curvature(mesh, 0.0)).chains()
    assert found.closed.tolist() == [True] and len(found.nodes) == 4
