# SPDX-License-Identifier: GPL-3.0-or-later
"""The example scan, and real scans where they are at hand."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.detection import polylines, sampled
from core.detection import KINDS, TriangleMesh, detect
from core.files.formats import read_surface
from examples import make_scan

DATA = Path(__file__).resolve().parents[4] / "shared" / "data"


@pytest.fixture(scope="module")
def example():
    made = make_scan.scan()
    mesh = TriangleMesh.of(made.vertices, made.faces)
    return made, mesh, detect(mesh)


def test_the_example_is_of_the_size_said_and_the_same_each_time(example, tmp_path):
    made, mesh, _ = example
    assert 60_000 <= len(made.faces) <= 120_000
    again = make_scan.scan()
    assert np.array_equal(again.vertices, made.vertices) and np.array_equal(again.faces, made.faces)
    make_scan.main([str(tmp_path / "a.ply")])
    points, faces = read_surface(tmp_path / "a.ply")
    assert np.array_equal(points, made.vertices.astype(np.float32)) and np.array_equal(faces, made.faces)
    other = make_scan.scan(seed=1)
    assert hashlib.sha1(other.vertices.tobytes()).digest() != hashlib.sha1(made.vertices.tobytes()).digest()


@pytest.mark.parametrize("kind", ["ridge", "valley"])
def test_the_creases_of_the_example_are_found(example, kind):
    made, mesh, found = example
    h = mesh.edge_length
    built = [(c, z) for c, z, k in zip(made.curves, made.closed, made.kinds) if k == kind]
    truth = sampled([np.concatenate([c, c[:1]]) if closed else c for c, closed in built], h / 4)
    ours = sampled(polylines(found, KINDS.index(kind)), h / 4)
    assert (cKDTree(ours).query(truth)[0] < h).mean() > 0.94
    assert (cKDTree(truth).query(ours)[0] < h).mean() > 0.88
    assert (found.length > 25 * h).sum() >= 60


@pytest.mark.skipif(not (DATA / "fluted_vase_scan.ply").exists(), reason="the scan is not at hand")
def test_the_flutes_of_the_vase_are_unbroken():
    mesh = TriangleMesh.of(*read_surface(DATA / "fluted_vase_scan.ply"))
    found = detect(mesh)
    tall = np.array([np.ptp(found.curves.curve(i), axis=0).max() for i in range(len(found))]) > 20 * mesh.edge_length
    assert (tall & (found.kind == 0)).sum() >= 20 and (tall & (found.kind == 1)).sum() >= 20
