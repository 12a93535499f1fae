# SPDX-License-Identifier: GPL-3.0-or-later
"""Curvature tensors against a loop version and against surfaces that are known exactly."""

import numpy as np
import pytest

from core.detection import TriangleMesh
from core.detection.curvature.smoothing import Diffusion
from core.detection.curvature.tensor import cubic as applied
from core.detection.curvature.tensor import (
    curvature,
    principal,
    tangent_frames,
    vertex_derivatives,
    vertex_normals,
    vertex_tensors,
)
from core.detection.lines.extremality import _DOMINANT, _PROMINENT, crest_lines
from tests.core.detection import oracle, surfaces


def full(t):
    return t[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)


@pytest.mark.parametrize("seed", range(3))
def test_tensors_and_derivatives_equal_the_loop_version(seed):
    rng = np.random.default_rng(seed)
    v, f = surfaces.graph(9, lambda x, y: 0.4 * np.sin(2 * x + seed) * np.cos(3 * y), seed=seed)
    mesh = TriangleMesh.of(v + rng.normal(0, 0.01, v.shape), f)
    points, faces = mesh.vertices, mesh.faces
    normals = vertex_normals(points, mesh)
    tensor = vertex_tensors(points, normals, mesh)
    expected = oracle.vertex_forms(points, normals, faces)
    assert np.allclose(full(tensor), expected, atol=1e-9 * np.abs(expected).max())
    high, low, direction, _ = principal(tensor, *tangent_frames(normals))
    slope = applied(vertex_derivatives(points, tensor, mesh), direction)
    wanted = oracle.slopes(points, normals, faces, expected, direction)
    assert np.allclose(slope, wanted, atol=1e-6 * np.abs(wanted).max())
    assert (high >= low).all()


@pytest.mark.parametrize("seed", range(3))
def test_crest_segments_equal_the_loop_version(seed):
    v, f, _ = surfaces.folded_sheet(14, 2, 60, seed=seed)
    mesh = TriangleMesh.of(v, f)
    field = curvature(mesh, 0.8 * mesh.edge_length)
    lines, sound, _ = crest_lines(mesh, field, 0, 0.0)
    found, is_sound = oracle.crest_segments(
        mesh, field.high, field.low, field.high_direction, field.high_slope, _PROMINENT, _DOMINANT, field.width,
        field.points,
    )  # fmt: skip
    # name each crest point by the edge it lies on
    at = np.full(len(lines.points), -1)
    a, b = mesh.vertices[mesh.edges[:, 0]], mesh.vertices[mesh.edges[:, 1]]
    for i, p in enumerate(lines.points):
        off = np.linalg.norm(p - a, axis=1) + np.linalg.norm(p - b, axis=1) - np.linalg.norm(b - a, axis=1)
        at[i] = off.argmin()
    got = {frozenset(tuple(mesh.edges[at[i]]) for i in s) for s in lines.segments}
    assert got == found and len(got) > 20
    expected = np.array([is_sound.get(tuple(e), False) for e in mesh.edges[at]])
    assert np.array_equal(sound, expected) and sound.any()


def error(v, f, k, scale, within=None):
    mesh = TriangleMesh.of(v, f)
    field = curvature(mesh, scale * mesh.edge_length)
    exact = k[mesh.vertex_source]
    inner = np.ones(len(exact), bool) if within is None else np.abs(mesh.vertices[:, :2]).max(axis=1) < within
    off = np.stack([field.high, field.low], axis=1)[inner] - exact[inner]
    return np.sqrt(np.mean(off**2)) / np.abs(exact).max()


def test_a_sphere_is_exact_without_smoothing():
    v, f = surfaces.sphere(3, 2.0)
    assert error(v, f, np.full((len(v), 2), 0.5), 0.0) < 1e-12


@pytest.mark.parametrize("scale", [0.0, 1.0])
def test_the_error_on_a_torus_falls_with_the_resolution(scale):
    coarse, fine = (error(*surfaces.torus(n), scale) for n in (48, 96))
    assert fine < 0.35 * coarse < 0.02


@pytest.mark.parametrize("make", [surfaces.saddle, surfaces.monkey_saddle])
def test_the_error_on_saddles_falls_with_the_resolution(make):
    # an uneven mesh turns its normals by an angle that does not fall, so the scale must grow in edges, but slower
    # than the edges shrink
    coarse, fine = (error(*make(n), 1.5 * np.sqrt(n / 31), within=0.6) for n in (31, 61))
    assert fine < 0.6 * coarse < 0.02


@pytest.mark.parametrize("make", [surfaces.saddle, surfaces.monkey_saddle])
def test_uneven_saddles_stay_within_two_percent(make):
    assert error(*make(61), 1.0, within=0.7) < 0.02


def test_smoothing_spreads_by_the_width_asked_for():
    v, f = surfaces.graph(61, lambda x, y: 0 * x, jitter=0.2)
    mesh = TriangleMesh.of(v, f)
    diffusion = Diffusion.of(mesh)
    h = mesh.edge_length
    blob = np.exp(-0.5 * (mesh.vertices[:, 0] ** 2 + mesh.vertices[:, 1] ** 2) / (3 * h) ** 2)[:, None]
    spread = diffusion.smooth(blob, np.full(len(blob), 4 * h))[:, 0] * diffusion.mass
    assert spread.sum() == pytest.approx((blob[:, 0] * diffusion.mass).sum(), rel=0.02)
    spread /= spread.sum()
    for axis in range(2):  # variances add up: 9 + 16 = 25
        assert np.sqrt((spread * mesh.vertices[:, axis] ** 2).sum()) == pytest.approx(5 * h, rel=0.05)


def test_smoothing_keeps_a_plane_far_from_the_origin():
    v, f = surfaces.graph(21, lambda x, y: 0.3 * x)
    mesh = TriangleMesh.of(v + 1e6, f)
    assert np.abs(curvature(mesh, 2 * mesh.edge_length).high * mesh.edge_length).max() < 1e-6


def test_input_is_not_modified():
    v, f = surfaces.sphere(2)
    kept = v.copy(), f.copy()
    curvature(TriangleMesh.of(v, f), 0.1)
    assert np.array_equal(v, kept[0]) and np.array_equal(f, kept[1])
