# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimate of a scan's noise, and thresholds that follow it."""

import numpy as np
import pytest

from core.detection import DetectionParameters, TriangleMesh, detect, measure
from core.detection.curvature.noise import noise_level
from core.detection.curvature.tensor import vertex_normals
from core.detection.lines.extremality import fold_angle
from tests.core.detection import oracle, surfaces


def whole(made):
    """Its seams closed: noise would tear vertices apart that only lie in one place."""
    mesh = TriangleMesh.of(*made)
    return mesh.vertices, mesh.faces


SHAPES = {
    "plane": lambda: surfaces.graph(60, lambda x, y: 0.2 * x),
    "sphere": lambda: surfaces.sphere(4),
    "box": lambda: whole(surfaces.rounded_box(36)),
    "sheet": lambda: surfaces.folded_sheet(70, 5, 50.0)[:2],
}


def level(v, f):
    mesh = TriangleMesh.of(v, f)
    return noise_level(mesh.vertices, vertex_normals(mesh.vertices, mesh), mesh) / mesh.edge_length


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("noise", [0.05, 0.15])
def test_the_noise_is_estimated_whatever_the_shape(shape, noise):
    v, f = SHAPES[shape]()
    h = TriangleMesh.of(v, f).edge_length
    moved = v + np.random.default_rng(5).normal(0, noise * h, v.shape)
    # noise shakes the normals too, which makes it look a little larger
    assert level(moved, f) == pytest.approx(noise, rel=0.25)
    assert level(v, f) < 0.1 * noise


def test_the_estimate_equals_the_loop_version():
    v, f = surfaces.graph(12, lambda x, y: 0.3 * x * y, seed=1)
    mesh = TriangleMesh.of(surfaces.noisy(v, 0.01), f)
    normals = vertex_normals(mesh.vertices, mesh)
    expected = oracle.noise(mesh.vertices, normals, mesh.faces)
    assert noise_level(mesh.vertices, normals, mesh) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("detail", [0.3, 0.7, 1.4, 3.0])
@pytest.mark.parametrize("jitter", [0.0, 0.25, 0.4])
def test_the_fold_that_noise_makes_is_foretold(detail, jitter):
    v, f = surfaces.graph(80, lambda x, y: 0 * x, jitter=jitter)
    mesh = TriangleMesh.of(v + np.random.default_rng(2).normal(0, 0.002, v.shape), f)
    field = measure(mesh, parameters=DetectionParameters(detail=detail))
    inner = np.abs(mesh.vertices[:, :2]).max(axis=1) < 0.85
    seen = np.median(fold_angle(field.strength, field.width, mesh.edge_length)[inner])
    assert field.noise == pytest.approx(seen, rel=0.3)


def test_thresholds_follow_the_noise():
    p = DetectionParameters(strong_fold=15, weak_fold=5, noise=4)
    assert np.degrees(p.folds(0.0)) == pytest.approx([15, 5])
    assert np.degrees(p.folds(np.radians(3.75))) == pytest.approx([15, 5])
    assert np.degrees(p.folds(np.radians(7.5))) == pytest.approx([30, 10])
    assert DetectionParameters(strong_fold=0, weak_fold=0).folds(0.1) == (0.5, 0.0)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("share", [0.0005, 0.001])
def test_the_defaults_find_the_folds_of_a_noisy_sheet_whole_and_little_else(share, seed):
    v, f, at = surfaces.folded_sheet(110, 7, 50.0)
    mesh = TriangleMesh.of(surfaces.noisy(v, share, seed), f)
    found = detect(mesh)
    assert sum(found.length > 1.9) == len(at) and len(found) <= len(at) + 1
    without = detect(mesh, parameters=DetectionParameters(noise=0))
    assert len(without) > len(found) or share < 0.001


def test_noise_on_a_plane_is_no_feature_at_the_defaults():
    v, f = surfaces.graph(110, lambda x, y: 0 * x)
    mesh = TriangleMesh.of(surfaces.noisy(v, 0.002), f)
    assert len(detect(mesh, parameters=DetectionParameters(noise=0, detail=0.7))) > 50
    assert len(detect(mesh)) == len(detect(mesh, detail=0.7)) == 0
