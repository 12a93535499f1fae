# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoothing scale that a scan chooses for itself: little on creases, more with noise and on wide roundings."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.detection import TriangleMesh, detect, measure
from core.detection.curvature.smoothing import Diffusion
from core.detection.curvature.tensor import curvature
from core.detection.scale import width_of_folds
from tests.core.detection import surfaces

SHARES = [0.0, 0.0005, 0.001]


def sheet(noise, angle=50.0):
    v, f, _ = surfaces.folded_sheet(90, 5, angle)
    return TriangleMesh.of(surfaces.noisy(v, noise), f)


def rounded(noise, n=48):
    clean = TriangleMesh.of(*surfaces.rounded_box(n))  # noise on the box as it is made would tear its seams
    return TriangleMesh.of(surfaces.noisy(clean.vertices, noise), clean.faces)


def width(mesh):
    return width_of_folds(mesh, curvature(mesh, 0.5 * mesh.edge_length), Diffusion.of(mesh))


@pytest.mark.parametrize("noise", SHARES)
def test_creases_are_narrow_and_roundings_are_wide(noise):
    assert width(sheet(noise)) == 0
    assert width(rounded(noise)) > 0.9


def test_the_width_does_not_depend_on_size():
    mesh = rounded(0.001)
    assert width(TriangleMesh.of(1e3 * mesh.vertices, mesh.faces)) == pytest.approx(width(mesh), abs=1e-6)


def test_without_folds_nothing_is_concluded():
    assert width(TriangleMesh.of(*surfaces.graph(40, lambda x, y: 0 * x))) == 0


def test_the_scale_grows_with_the_noise_and_on_roundings():
    h = sheet(0).edge_length
    scales = [measure(sheet(noise)).scale / h for noise in (0.0, 0.0005, 0.001, 0.002)]
    assert scales[0] == pytest.approx(0.35, abs=0.01)
    assert np.all(np.diff(scales) > 0.05) and scales[-1] < 1.2
    mesh = rounded(0)
    assert measure(mesh).scale == pytest.approx(mesh.edge_length, rel=0.05)
    assert detect(mesh).detail == pytest.approx(1, rel=0.05)


@pytest.mark.parametrize("noise", SHARES)
def test_the_edges_of_a_noisy_rounded_box_are_found_whole(noise):
    mesh = rounded(noise)
    h = mesh.edge_length
    found = detect(mesh)
    curves = [found.curves.curve(i) for i in range(len(found))]
    edges = surfaces.box_crests().reshape(12, -1, 3)
    assert (cKDTree(np.concatenate(curves)).query(edges.reshape(-1, 3))[0] < h).mean() > 0.99
    pieces = [sum((cKDTree(edge).query(c)[0] < h).sum() > 4 for c in curves) for edge in edges]
    assert np.mean(pieces) < 1.1


def test_fine_ornament_keeps_its_place():
    """Two ridges three edges apart, with a valley between them: a wide scale would move or lose them."""
    v, f = surfaces.graph(100, lambda x, y: 0.03 * np.exp(-(((np.abs(x) - 0.04) / 0.012) ** 2)), jitter=0.1)
    mesh = TriangleMesh.of(v, f)
    found = detect(mesh)
    ridges = np.flatnonzero((found.kind == 0) & (found.length > 1.5))
    at = sorted(np.median(found.curves.curve(i)[:, 0]) for i in ridges)
    assert at == pytest.approx([-0.04, 0.04], abs=0.5 * mesh.edge_length)
