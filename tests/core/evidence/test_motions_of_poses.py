# SPDX-License-Identifier: GPL-3.0-or-later
"""Alignment against a solver of scipy, screws against the closed forms of the geometry, decoys and sliding."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from core.evidence.alignment import ALONG, _step, align
from core.evidence.decoys import OTHERS, SHIFT, SHIFTS, decoys
from core.evidence.field import Field
from core.evidence.odds import log_odds, sliding
from core.evidence.screws import moment, screws, turned
from core.geometry.motions import apply, exponential, screw_velocity
from tests.core.shapes import circle, line, network, ornament, random_motion


def test_screws_are_those_of_the_geometry_up_to_half_turns(rng):
    way = rng.normal(size=(60, 3))
    angle = np.r_[0.0, 1e-7, rng.uniform(0, np.pi, 40), np.linspace(3.0, np.pi - 1e-6, 18)]
    twists = np.concatenate(
        [way / np.linalg.norm(way, axis=1)[:, None] * angle[:, None], rng.normal(size=(60, 3)) * 50], axis=1
    )
    motions = exponential(twists)
    assert np.allclose(moment(twists[:, :3], twists[:, 3:]), motions, atol=1e-10)
    assert np.allclose(turned(twists[:, :3]), Rotation.from_rotvec(twists[:, :3]).as_matrix(), atol=1e-12)
    for ours, theirs in zip(screws(motions), screw_velocity(motions)):
        assert np.allclose(ours, theirs, atol=1e-6)


def test_a_step_is_the_least_squares_solution(rng):
    """Small gaps, so that one step of Gauss and Newton is the whole way, up to its damping."""
    points = rng.normal(size=(200, 3)) * 20
    lines = rng.normal(size=(200, 3))
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    true = exponential(np.r_[0.01, -0.02, 0.015, 0.3, -0.2, 0.4][None])[0]
    targets = apply(true, points) + rng.normal(size=points.shape) * 0.05

    def residuals(x):
        at = Rotation.from_rotvec(x[:3]).apply(points) + x[3:]
        gap = targets - at
        share = (gap * lines).sum(axis=1)
        across = gap - share[:, None] * lines
        return np.concatenate([across.ravel(), np.sqrt(ALONG) * share])

    x = least_squares(residuals, np.zeros(6)).x
    step = _step(points[None], targets[None], lines[None], np.ones((1, 200), bool))[0]
    solved = np.eye(4)
    solved[:3, :3], solved[:3, 3] = Rotation.from_rotvec(x[:3]).as_matrix(), x[3:]
    assert np.abs(apply(step, points) - apply(solved, points)).max() < 0.1
    assert np.abs(apply(step, points) - apply(true, points)).max() < 0.1


def test_alignment_brings_a_pose_home_whatever_is_aligned_beside_it(rng):
    net = network(ornament(rng, 5))
    field = Field(net, radius=2.0)
    probe = field.probe(np.arange(len(field)))
    off = exponential(np.concatenate([rng.normal(size=(4, 3)) * 0.01, rng.normal(size=(4, 3)) * 0.7], axis=1))
    home = align(field, off, probe, radii=(4.0, 3.0, 2.0, 2.0))
    error = np.linalg.norm(apply(home, net.points) - net.points, axis=2)
    assert np.sqrt((error**2).mean(axis=1)).max() < 0.3
    assert np.allclose(align(field, off[1:2], probe, radii=(4.0, 3.0, 2.0, 2.0))[0], home[1])


def test_decoys_move_away_and_are_the_same_every_time(rng):
    poses = np.stack([random_motion(rng) for _ in range(3)])
    points, tangents = rng.normal(size=(50, 3)) * 10, rng.normal(size=(50, 3))
    centre = points.mean(axis=0)
    wrong = decoys(poses, centre, tangents)
    assert wrong.shape == (3, SHIFTS + OTHERS, 4, 4)
    assert (wrong == decoys(poses, centre, tangents)).all()
    way = np.linalg.norm(apply(wrong, centre[None])[:, :, 0] - apply(poses, centre[None])[:, None, 0], axis=-1)
    assert np.allclose(way[:, :SHIFTS], SHIFT) and (way[:, SHIFTS:] > 5).all()
    # A decoy belongs to its pose: another pose beside it changes nothing.
    assert np.allclose(wrong[1], decoys(poses[1:2], centre, tangents)[0])


def test_log_odds_of_hits_and_misses():
    p, q = 0.6, 0.1
    hits = np.array([True, False, True])
    expected = [np.log(p / q) if h else np.log((1 - p) / (1 - q)) for h in hits]
    assert log_odds(hits, p, q) == pytest.approx(expected)


def test_a_cornice_slides_and_a_sill_does_not():
    net = network([line(200), line(20, start=(0, 30, 0)), line(20, start=(100, 30, 0))])
    field = Field(net, radius=2.0)
    probe = field.probe(np.arange(len(field)))
    shift = np.eye(4)[None].copy()
    shift[0, 0, 3] = 100.0
    way = (net.points[net.offsets[1] :] - net.points[net.offsets[1] :].mean(axis=0))[0]
    shift[0, :3, 3] = (
        -100.0 * way / np.linalg.norm(way) if abs(net.tangents[0] @ way) > 0.9 * np.linalg.norm(way) else 0
    )
    out = sliding(field, shift, type(probe)(probe.points[None], probe.tangents[None]))[0]
    long, short = out[net.curve_of == 0], out[net.curve_of > 0]
    assert long[len(long) // 2 + 10 : -5].all() or long[5 : len(long) // 2 - 10].all()
    assert not short.any()


def test_a_ring_slides_about_its_axis(rng):
    net = network([circle(40.0)], closed=[True])
    field = Field(net, radius=2.0)
    probe = field.probe(np.arange(len(field)))
    centre = net.points.mean(axis=0)
    axis = np.linalg.svd(net.points - centre)[2][2]
    r = Rotation.from_rotvec(axis).as_matrix()
    m = np.eye(4)
    m[:3, :3], m[:3, 3] = r, centre - r @ centre
    assert sliding(field, m[None], type(probe)(probe.points[None], probe.tangents[None])).all()
