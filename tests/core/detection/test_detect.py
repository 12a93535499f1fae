# SPDX-License-Identifier: GPL-3.0-or-later
"""Detection as a whole: exact crest lines, nothing where nothing is, invariances, noise, cancelling."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.detection import KINDS, DetectionParameters, TriangleMesh, detect, measure
from core.errors import Cancelled, InputError
from tests.core.detection import surfaces

GENTLE = DetectionParameters(strong_fold=2.0, weak_fold=0.5)
"""For smooth analytic surfaces, which bend little over an edge."""


def dense(found, step):
    """Points along all curves, `step` apart or closer."""
    out = []
    for i in range(len(found)):
        p = found.curves.curve(i)
        p = np.concatenate([p, p[:1]]) if found.curves.closed[i] else p
        for a, b in zip(p, p[1:]):
            n = max(1, int(np.ceil(np.linalg.norm(b - a) / step)))
            out.append(a + np.linspace(0, 1, n + 1)[:, None] * (b - a))
    return np.concatenate(out)


@pytest.mark.parametrize("level", [4, 5])
def test_an_ellipsoid_has_one_ridge_at_its_rim(level):
    v, f = surfaces.ellipsoid(level)
    rng = np.random.default_rng(level)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    mesh = TriangleMesh.of(v @ turn.T, f)
    found = detect(mesh, parameters=GENTLE)
    assert [KINDS[k] for k in found.kind] == ["ridge"] and found.curves.closed.tolist() == [True]
    p = dense(found, 0.1 * mesh.edge_length) @ turn
    assert np.abs(p[:, 2]).max() < 0.5 * mesh.edge_length
    angle = np.linspace(0, 2 * np.pi, 500)
    rim = np.column_stack([3 * np.cos(angle), 2 * np.sin(angle), 0 * angle])
    assert cKDTree(p).query(rim)[0].max() < 0.5 * mesh.edge_length


def test_the_strength_on_the_rim_is_the_curvature():
    v, f = surfaces.ellipsoid(5)
    found = detect(TriangleMesh.of(v, f), parameters=GENTLE, detail=0.7)
    x, y, _ = found.curves.points.T
    across = 1 / np.sqrt((x / 9) ** 2 + (y / 4) ** 2)  # with c = 1 it is 1 / (c^2 |gradient / 2|)
    assert found.curves.strength == pytest.approx(across, rel=0.06)


@pytest.mark.parametrize("n", [24, 36])
def test_a_rounded_box_has_its_edges(n):
    v, f = surfaces.rounded_box(n)
    mesh = TriangleMesh.of(v, f)
    h = mesh.edge_length
    found = detect(mesh)
    assert set(found.kind) == {KINDS.index("ridge")}
    p = dense(found, 0.05 * h)
    edges = surfaces.box_crests()
    assert cKDTree(p).query(edges)[0].max() < 0.5 * h
    inner = np.array([1.0, 0.8, 0.6]) - 0.2
    off_corner = (np.abs(p) < inner - h).any(axis=1)
    assert off_corner.sum() > 1000 and cKDTree(edges).query(p[off_corner])[0].max() < 0.5 * h


@pytest.mark.parametrize("parameters", [DetectionParameters(), GENTLE, replace(GENTLE, detail=1.5)])
@pytest.mark.parametrize(
    "make",
    [
        lambda: surfaces.sphere(4),
        lambda: surfaces.sphere(5),
        lambda: surfaces.graph(50, lambda x, y: 0 * x),
        lambda: surfaces.graph(50, lambda x, y: 0.3 * x - 0.2 * y),
    ],
)
def test_nothing_is_found_where_nothing_is(make, parameters):
    assert len(detect(TriangleMesh.of(*make()), parameters=parameters)) == 0


@pytest.mark.parametrize("parameters", [DetectionParameters(), GENTLE])
def test_a_torus_has_no_crest(parameters):
    v, f, _ = surfaces.torus(120)
    assert len(detect(TriangleMesh.of(v, f), parameters=parameters)) == 0


def test_noise_on_a_plane_and_a_sphere_is_no_feature():
    for v, f in (surfaces.graph(80, lambda x, y: 0 * x), surfaces.sphere(4)):
        assert len(detect(TriangleMesh.of(surfaces.noisy(v, 0.0005), f))) == 0


@pytest.mark.parametrize("detail", [0, 0.2, 0.7, 1.0])
def test_a_fold_shows_its_angle_and_kind(detail):
    v, f, at = surfaces.folded_sheet(70, 3, 40.0)
    mesh = TriangleMesh.of(v, f)
    found = detect(mesh, detail=detail)
    assert sorted(found.kind) == [0, 0, 1]
    x = [np.median(found.curves.curve(i)[:, 0]) for i in range(3)]
    assert sorted(x) == pytest.approx(at.tolist(), abs=0.5 * mesh.edge_length)
    assert [KINDS[k] for k in found.kind[np.argsort(x)]] == ["ridge", "valley", "ridge"]
    assert found.mean_fold == pytest.approx(40, rel=0.1)
    turned = detect(TriangleMesh.of(v, f[:, ::-1]))
    assert sorted(turned.kind) == [0, 1, 1]


@pytest.mark.parametrize("noise", [0.0005, 0.001])
def test_noise_does_not_break_the_folds_of_a_sheet(noise):
    v, f, at = surfaces.folded_sheet(90, 5, 50.0)
    mesh = TriangleMesh.of(surfaces.noisy(v, noise), f)
    found = detect(mesh, detail=1.0)
    assert len(at) <= len(found) <= len(at) + 1
    assert found.length.sum() > 0.9 * len(at) * 2.0


def turned_and_scaled(v, seed, scale=1.0):
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    return scale * (v @ turn.T) + rng.normal(0, 5, 3), turn


def sheet():
    v, f, _ = surfaces.folded_sheet(40, 3, 60.0, seed=3)
    return surfaces.noisy(v, 0.001, seed=4), f


def same(a, b, shift):
    """Curves of two results as sets of points, after `shift` takes those of a to those of b."""
    assert len(a) == len(b) and np.array_equal(np.sort(a.kind), np.sort(b.kind))
    p, q = shift(dense(a, a.edge_length / 4)), dense(b, b.edge_length / 4)
    assert max(cKDTree(p).query(q)[0].max(), cKDTree(q).query(p)[0].max()) < 0.3 * b.edge_length
    assert np.sort(a.length / a.edge_length) == pytest.approx(np.sort(b.length / b.edge_length), rel=1e-4)


@pytest.mark.parametrize("scale", [1.0, 1e-4, 1e5])
def test_moving_and_scaling_changes_nothing(scale):
    v, f = sheet()
    moved, _ = turned_and_scaled(v, 7, scale)
    fit = np.linalg.lstsq(np.column_stack([v, np.ones(len(v))]), moved, rcond=None)[0]
    first, second = detect(TriangleMesh.of(v, f)), detect(TriangleMesh.of(moved, f))
    same(first, second, lambda p: np.column_stack([p, np.ones(len(p))]) @ fit)
    assert second.mean_strength * scale == pytest.approx(first.mean_strength, rel=1e-3)


def test_the_order_of_vertices_and_faces_changes_nothing():
    v, f = sheet()
    rng = np.random.default_rng(0)
    order = rng.permutation(len(v))
    place = np.empty(len(v), int)
    place[order] = np.arange(len(v))
    shuffled = place[f][rng.permutation(len(f))]
    shuffled = np.stack([np.roll(t, k) for t, k in zip(shuffled, rng.integers(0, 3, len(f)))])
    same(detect(TriangleMesh.of(v, f)), detect(TriangleMesh.of(v[order], shuffled)), lambda p: p)


def test_the_points_lie_on_the_surface_and_input_is_kept():
    from core.detection.lines.surface import Surface

    v, f = sheet()
    kept = v.copy(), f.copy()
    mesh = TriangleMesh.of(v, f)
    found = detect(mesh, boundary=True, sharp=True)
    assert Surface(mesh).closest(found.curves.points)[2].max() < 1e-9
    assert np.array_equal(v, kept[0]) and np.array_equal(f, kept[1])
    assert (np.diff(found.length) <= 0).all() and (found.curves.strength >= 0).all()
    assert KINDS.index("boundary") in found.kind


def test_several_parts_holes_and_a_fin_are_taken_together():
    v, f = surfaces.rounded_box(24)
    far = v + [10.0, 0, 0]
    holes = f[np.linalg.norm(v[f].mean(axis=1) - [0, 0, 0.6], axis=1) > 0.3]
    fin = np.array([[0.0, 0, 0.61], [0.1, 0, 2.0]])
    both = np.concatenate([v, far, fin])
    edge = holes[0, :2]
    faces = np.concatenate([holes, f + len(v), [[edge[0], edge[1], 2 * len(v)]]])
    found = detect(TriangleMesh.of(both, faces))
    x = np.array([found.curves.curve(i)[:, 0].mean() for i in range(len(found))])
    assert (x > 5).any() and (x < 5).any()


def test_thresholds_are_tried_on_a_measured_field():
    v, f = sheet()
    mesh = TriangleMesh.of(v, f)
    field = measure(mesh)
    assert np.array_equal(detect(mesh, field=field).curves.points, detect(mesh).curves.points)
    assert len(detect(mesh, field=field, parameters=DetectionParameters(strong_fold=150))) == 0


def test_the_margin_keeps_lines_off_the_boundary():
    v, f = sheet()
    mesh = TriangleMesh.of(v, f)
    rim = cKDTree(mesh.vertices[mesh.boundary_vertices])
    near = [
        rim.query(detect(mesh, parameters=DetectionParameters(margin=m)).curves.points)[0].min() / mesh.edge_length
        for m in (0.0, 3.0)
    ]
    assert near[0] < 1 and near[1] >= 3


def test_selecting_answers_from_what_was_found():
    v, f = sheet()
    found = detect(TriangleMesh.of(v, f), boundary=True)
    bound = np.median(found.mean_fold)
    kept = found.at_least(fold=bound)
    assert len(kept) == ((found.mean_fold >= bound) | (found.kind == 3)).sum()
    assert len(found.at_least(length=found.length.max() / found.edge_length)) == 1
    index = np.flatnonzero((found.mean_fold >= bound) | (found.kind == 3))
    for i, j in enumerate(index):
        assert np.array_equal(kept.curves.curve(i), found.curves.curve(j))


def test_progress_is_told_and_may_stop():
    v, f = sheet()
    mesh = TriangleMesh.of(v, f)
    told = []
    detect(mesh, progress=lambda stage, part: told.append((stage, part)))
    assert {s for s, _ in told} == {"curvature", "lines"} and all(0 <= p <= 1 for _, p in told)
    assert told[-1] == ("lines", 1.0)

    def stop(stage, part):
        if stage == "lines":
            raise Cancelled

    with pytest.raises(Cancelled):
        detect(mesh, progress=stop)


@pytest.mark.parametrize(
    "change, message",
    [
        ({"detail": -1}, "detail is -1: give a number from 0 to 20"),
        ({"detail": float("nan")}, "detail is nan"),
        ({"strong_fold": "x"}, "strong_fold is 'x'"),
        ({"strong_fold": 181}, "strong_fold is 181"),
        ({"strong_fold": 3.0}, "weak_fold is 7: give at most strong_fold, 3"),
        ({"gap": True}, "gap is True"),
    ],
)
def test_wrong_parameters_are_named(change, message):
    with pytest.raises(InputError, match=message):
        replace(DetectionParameters(), **change).validate()


def test_a_wrong_call_is_named():
    v, f = sheet()
    mesh = TriangleMesh.of(v, f)
    with pytest.raises(InputError, match="no kind"):
        detect(mesh, ridges=False, valleys=False)
    other = measure(TriangleMesh.of(*surfaces.sphere(1)))
    with pytest.raises(InputError, match="measure this mesh"):
        detect(mesh, field=other)


def test_too_little_memory_is_told():
    def full(stage, part):
        raise MemoryError

    v, f = sheet()
    with pytest.raises(InputError, match="not enough memory for [0-9]+ faces: decimate"):
        detect(TriangleMesh.of(v, f), progress=full)


def test_memory_stays_below_a_kilobyte_a_face():
    v, f, _ = surfaces.folded_sheet(200, 7, 50.0)
    tracemalloc.start()
    detect(TriangleMesh.of(v, f))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak / len(f) < 1000


def test_one_triangle_gives_nothing_but_its_boundary():
    mesh = TriangleMesh.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert len(detect(mesh)) == 0
    assert detect(mesh, boundary=True).curves.closed.tolist() == [True]
