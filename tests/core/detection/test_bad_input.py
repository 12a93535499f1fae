# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as they come: each gives what the sound mesh gives, or says what is wrong. Too large ones: test_limits.py."""

import numpy as np
import pytest

from core.detection import TriangleMesh, detect
from core.errors import InputError
from tests.core.detection import surfaces


@pytest.fixture(scope="module")
def box():
    return surfaces.rounded_box(24)


@pytest.fixture(scope="module")
def sound(box):
    return found(*box)


def found(v, f):
    return detect(TriangleMesh.of(v, f))


def same(a, b, loose=1e-9):
    assert len(a) == len(b) > 0 and sorted(a.kind) == sorted(b.kind)
    assert np.sort(a.length) == pytest.approx(np.sort(b.length), rel=max(loose, 1e-6))
    if loose < 1e-6:
        assert np.allclose(np.sort(a.curves.points, axis=0), np.sort(b.curves.points, axis=0), atol=1e-9)


def test_quads_are_cut_and_mapped_back(box, sound):
    v, f = box
    half = len(f) // 2
    quads = np.column_stack([f[:half], f[half:, 2]])
    assert np.array_equal(quads[:, [0, 2, 3]], f[half:])
    mesh = TriangleMesh.of(v, quads)
    assert len(mesh.faces) == len(TriangleMesh.of(v, f).faces)
    assert np.array_equal(np.bincount(mesh.face_source, minlength=half), np.full(half, 2))
    same(detect(mesh), sound)


def test_polygons_of_many_corners_are_cut_and_mapped_back():
    v, f, at = surfaces.folded_sheet(60, 3, 50.0, jitter=0.0)
    n = 60
    polygons = []
    for i in range(n - 1):
        for j in range(0, n - 3, 2):  # two squares in a row along the folds become one hexagon
            a = i * n + j
            polygons.append([a, a + n, a + n + 1, a + n + 2, a + 2, a + 1])
    mesh = TriangleMesh.of(v, polygons)
    assert set(np.bincount(mesh.face_source)) <= {2, 3, 4}
    got = detect(mesh)
    assert len(got) == len(at)
    x = sorted(np.median(got.curves.curve(i)[:, 0]) for i in range(len(got)))
    assert x == pytest.approx(at, abs=mesh.edge_length)


def test_what_is_not_a_number_is_named_where_it_is_used(box, sound):
    v, f = box
    bad = v.copy()
    bad[11] = np.nan
    with pytest.raises(InputError, match="vertex 11 has a coordinate that is not a finite number"):
        found(bad, f)
    same(found(np.concatenate([v, [[np.nan, np.inf, 0]]]), f), sound)


def test_faces_without_area_change_nothing(box, sound):
    v, f = box
    rng = np.random.default_rng(0)
    a, b = f[rng.choice(len(f), 30)].T[:2]
    flat = np.concatenate([np.stack([a, a, b], 1), np.stack([a, b, a], 1)])
    middle = len(v) + np.arange(30)
    needles = np.stack([a, b, middle], 1)
    same(found(np.concatenate([v, 0.5 * (v[a] + v[b])]), np.concatenate([f, flat, needles])), sound)


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_flipped_faces_are_turned_back(box, sound, share):
    v, f = box
    turned = np.random.default_rng(1).random(len(f)) < share
    same(found(v, np.where(turned[:, None], f[:, ::-1], f)), sound, loose=1e-4)


def test_repeated_faces_count_once(box, sound):
    v, f = box
    same(found(v, np.concatenate([f, f[::-1, [1, 2, 0]], f[:50, ::-1]])), sound)


def test_six_faces_on_one_edge():
    """Three folded sheets that share the line of one fold: two faces on each of its edges, three times."""
    v, f, at = surfaces.folded_sheet(50, 3, 60.0, jitter=0.0)
    on = np.abs(v[:, 0] - at[1]) < 1e-9
    if not on.any():  # put a line of vertices on the fold
        column = np.abs(v[:, 0] - at[1]) <= np.abs(v[:, 0] - at[1]).min() + 1e-9
        column = np.abs(v[:, 0] - v[column][0, 0]) < 1e-9
        v[column] = np.column_stack([np.full(column.sum(), at[1]), v[column, 1], np.zeros(column.sum())])
        on = column
    line = v[on].mean(axis=0)
    sheets, faces = [], []
    for k in range(3):
        angle = np.radians(40 * k)
        turn = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
        p = (v - line * [1, 0, 1]) @ turn.T
        p[on] = v[on] - line * [1, 0, 1]  # to the bit, so that they become one
        sheets.append(p)
        faces.append(f + k * len(v))
    mesh = TriangleMesh.of(np.concatenate(sheets), np.concatenate(faces))
    assert mesh.edge_faces.max() == 6
    got = detect(mesh, boundary=True, sharp=True)
    outer = [i for i in range(len(got)) if got.kind[i] < 2 and np.abs(got.curves.curve(i)[:, [0, 2]]).max() > 0.3]
    assert len(outer) == 6  # the other two folds of each sheet
    assert all(got.length[i] > 1.8 for i in outer)


def test_no_faces_are_said():
    for faces in (np.zeros((0, 3), int), [], None):
        with pytest.raises(InputError, match="no faces"):
            found(np.eye(3), faces)
