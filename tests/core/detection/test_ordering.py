# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear-time sorting and the edges made with it, against numpy's sorts."""

import numpy as np
import pytest

from core.detection import TriangleMesh
from core.detection.mesh import mesh
from core.detection.mesh.blocks import gather, parts, sums
from core.detection.mesh.edges import edge_table, face_pairs
from core.detection.mesh.ordering import group_starts, order_by
from tests.core.detection import surfaces


@pytest.mark.parametrize("size, count", [(0, 1), (1, 1), (50, 3), (500, 40), (500, 5000)])
@pytest.mark.parametrize("columns", [1, 2, 3])
def test_the_order_is_that_of_a_stable_sort(size, count, columns):
    keys = np.random.default_rng(size + columns).integers(0, count, (columns, size))
    order = order_by(*keys, count=count)
    assert np.array_equal(order, np.lexsort(keys[::-1]))
    starts = group_starts(*keys[:, order])
    assert starts.sum() == len(np.unique(keys, axis=1).T)


def test_edges_are_the_distinct_pairs_of_the_faces():
    rng = np.random.default_rng(3)
    faces = np.array([rng.choice(40, 3, replace=False) for _ in range(200)])  # edges with many faces among them
    edges, face_edges = edge_table(faces, 40)
    ends = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    expected, inverse = np.unique(ends, axis=0, return_inverse=True)
    assert np.array_equal(edges, expected) and np.array_equal(face_edges.ravel(), inverse.ravel())
    one, two = face_pairs(face_edges, np.bincount(face_edges.ravel()))
    flat = face_edges.ravel()
    twice = [e for e in range(len(edges)) if (flat == e).sum() == 2]
    assert [tuple(np.flatnonzero(flat == e)) for e in twice] == list(zip(one, two))


def test_equal_points_are_found_though_unequal_ones_are_mixed_alike(monkeypatch):
    v, f = surfaces.sphere(2)
    v, f = v[f].reshape(-1, 3), np.arange(3 * len(f)).reshape(-1, 3)
    v[7] = np.where(v[7] == 0, -0.0, v[7])
    made = TriangleMesh.of(v, f)
    monkeypatch.setattr(mesh, "_mixed", lambda bits: np.zeros(len(bits), np.uint64))
    again = TriangleMesh.of(v, f)
    assert len(made.vertices) == 162
    assert np.array_equal(made.faces, again.faces) and np.array_equal(made.vertex_source, again.vertex_source)


@pytest.mark.parametrize("count", [0, 1, 1 << 14, (1 << 18) + 1, 1_000_001])
def test_parts_cover_everything_once(count):
    made = parts(count)
    assert sum(len(range(*p.indices(count))) for p in made) == count
    assert all(a.stop == b.start for a, b in zip(made, made[1:])) and len(made) <= 16


def test_gathering_adds_up_rows():
    rng = np.random.default_rng(0)
    at, values = rng.integers(10, 60, 300), rng.normal(size=(300, 2))
    total, expected = sums(80, 2), np.zeros((80, 2))
    gather(total, at, values)
    np.add.at(expected, at, values)
    assert np.allclose(total, expected)
