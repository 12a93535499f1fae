# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions in bulk agree with one motion at a time."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.motions import (
    apply,
    best_rotation,
    embed,
    exponential,
    invariants,
    inverse,
    largest_overlap,
    motion,
    rotation_between,
    screw_velocity,
)
from tests import naive
from tests.core.shapes import random_motion


def covariances(rng, n):
    """Random, planar, straight, mirrored and tiny cross-covariances."""
    full = rng.normal(size=(n, 3, 3)) * 10 ** rng.uniform(-3, 3, size=(n, 1, 1))
    planar = rng.normal(size=(n, 3, 2)) @ rng.normal(size=(n, 2, 3))
    straight = rng.normal(size=(n, 3, 1)) @ rng.normal(size=(n, 1, 3))
    mirrored = np.array([naive.turn(v, 1.0) * [1, 1, -1] for v in rng.normal(size=(n, 3))])
    return np.concatenate([full, planar, straight, mirrored])


def test_invariants_are_those_of_the_singular_values(rng):
    m = covariances(rng, 50)
    e1, e2, det = invariants(np.moveaxis(m, 0, -1))
    s = np.linalg.svd(m, compute_uv=False) ** 2
    scale = s[:, 0]
    assert np.allclose(e1 / scale, s.sum(axis=1) / scale)
    assert np.allclose(e2 / scale**2, (s[:, 0] * s[:, 1] + s[:, 1] * s[:, 2] + s[:, 0] * s[:, 2]) / scale**2)
    assert np.allclose(det / scale**1.5, np.linalg.det(m) / scale**1.5)


def test_largest_overlap_is_that_of_the_svd(rng):
    m = covariances(rng, 200)
    u, s, vt = np.linalg.svd(m)
    truth = s[:, 0] + s[:, 1] + np.sign(np.linalg.det(u) * np.linalg.det(vt)) * s[:, 2]
    for bound in (s.sum(axis=1), s.sum(axis=1) * 3):
        got = largest_overlap(m, bound)
        assert (got >= truth - 1e-7 * s[:, 0]).all(), "Newton's steps from above never pass the root"
        # Steps towards a root that is nearly a double or a triple one are slow.
        assert np.allclose(got, truth, rtol=0.03)
        simple = s[:, 1] + np.sign(np.linalg.det(m)) * s[:, 2] > 0.1 * s[:, 0]
        assert simple.sum() > 300
        assert np.allclose(got[simple], truth[simple], rtol=1e-6)


@pytest.mark.parametrize("noise", [0.0, 1e-6, 0.03, 0.7])
@pytest.mark.parametrize("count", [25, 100, 400, 1000])
def test_the_residual_that_follows_is_right_on_straight_stretches(rng, noise, count):
    for _ in range(20):
        way = rng.normal(size=(2, 3))
        way /= np.linalg.norm(way, axis=1)[:, None]
        a, b = (np.arange(count)[:, None] * w + noise * rng.normal(size=(count, 3)) for w in way)
        a, b = a - a.mean(axis=0), b - b.mean(axis=0)
        energy = (a**2).sum() + (b**2).sum()
        got = energy - 2 * largest_overlap((b.T @ a)[None], np.array([energy / 2]))[0]
        truth = ((a @ naive.fit_rotation(a, b).T - b) ** 2).sum()
        assert np.sqrt(max(got, 0) / count) == pytest.approx(np.sqrt(truth / count), abs=0.1)


def test_no_rotation_overlaps_more_than_the_best_one(rng):
    m = covariances(rng, 10)
    best, _ = best_rotation(m)
    assert np.allclose(np.linalg.det(best), 1)
    # trace(R m^T) for covariances sum of b a^T
    overlap = np.einsum("kij,kij->k", best, m)
    for _ in range(300):
        other = naive.turn(rng.normal(size=3), rng.uniform(0, np.pi))
        assert (np.einsum("ij,kij->k", other, m) <= overlap + 1e-9 * np.abs(overlap)).all()


def test_best_rotation_takes_a_onto_b(rng):
    for _ in range(20):
        a, r = rng.normal(size=(12, 3)), naive.turn(rng.normal(size=3), rng.uniform(0, np.pi))
        b = a @ r.T
        got = best_rotation((b.T @ a)[None])[0][0]
        assert np.allclose(got, r) and np.allclose(got, naive.fit_rotation(a, b))


def test_rotation_between_is_the_smallest(rng):
    a = rng.normal(size=(60, 3))
    b = rng.normal(size=(60, 3))
    b[40:50] = a[40:50]
    b[50:] = -a[50:]
    a, b = (v / np.linalg.norm(v, axis=1)[:, None] for v in (a, b))
    r = rotation_between(a, b)
    assert np.allclose(np.einsum("kij,kj->ki", r, a), b, atol=1e-6)
    assert np.allclose(r @ np.swapaxes(r, 1, 2), np.eye(3), atol=1e-6) and np.allclose(np.linalg.det(r), 1, atol=1e-6)
    between = np.degrees(np.arccos(np.clip((a * b).sum(axis=1), -1, 1)))
    assert np.allclose([naive.angle_of(m) for m in r], between, atol=1e-3)


def test_motions_are_applied_inverted_and_made(rng):
    motions = np.array([random_motion(rng) for _ in range(5)])
    points = rng.normal(size=(7, 3))
    for m, got in zip(motions, apply(motions, points)):
        assert np.allclose(got, naive.moved(m, points))
    assert np.allclose(inverse(motions), np.linalg.inv(motions))
    assert np.allclose(motion(motions[:, :3, :3], motions[:, :3, 3]), motions)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-7, 2e-6, 1e-3, 0.3, 2.0, 3.0, np.pi - 1e-4])
def test_screw_velocity_and_exponential_are_inverses(rng, angle):
    w = rng.normal(size=(20, 3))
    w *= angle / np.linalg.norm(w, axis=1)[:, None]
    u = rng.normal(size=(20, 3)) * 30
    motions = exponential(np.concatenate([w, u], axis=1))
    assert np.allclose(motions[:, :3, :3] @ np.swapaxes(motions[:, :3, :3], 1, 2), np.eye(3))
    back_w, back_u = screw_velocity(motions)
    assert np.allclose(back_w, w, atol=1e-8) and np.allclose(back_u, u, rtol=1e-5, atol=1e-4)


def test_the_screw_velocity_is_that_of_the_integral(rng):
    for angle in (0.02, 0.7, 2.5):
        m = naive.about(rng.normal(size=3), angle, rng.normal(size=3) * 10, along=4.0)
        (w,), (u,) = screw_velocity(m[None])
        expected_w, expected_u = naive.log_motion(m)
        assert np.allclose(w, expected_w, atol=1e-6) and np.allclose(u, expected_u, atol=1e-3)


def test_powers_are_repeated_motions(rng):
    m = naive.about(rng.normal(size=3), 0.4, [5, 1, 2], along=3.0)
    twist = np.concatenate(screw_velocity(m[None]), axis=1)
    for k in range(-3, 4):
        assert np.allclose(exponential(twist * k)[0], np.linalg.matrix_power(m, k), atol=1e-8)


def test_embedding_distances_are_the_rms_distances_on_the_curves(rng):
    p = rng.normal(size=(500, 3)) * [40, 10, 2]
    p -= p.mean(axis=0)
    p = p @ np.linalg.eigh(p.T @ p)[1]
    motions = np.array([random_motion(rng, 5) for _ in range(6)])
    e = embed(motions, p.std(axis=0))
    for i in range(6):
        for j in range(6):
            way = naive.moved(motions[i], p) - naive.moved(motions[j], p)
            assert np.isclose(np.linalg.norm(e[i] - e[j]), np.sqrt((way**2).sum(axis=1).mean()))
