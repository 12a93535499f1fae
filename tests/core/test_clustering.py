# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of motions: complete linkage as partitions, and the planted motions among the votes."""

from __future__ import annotations

import numpy as np
import pytest

from core.clustering import chance_support, cluster_votes, group_motions, perturbed
from core.errors import Cancelled
from core.matching.blast import feature_blast
from core.matching.voting import Votes, vote
from core.orbits import detect_orbits
from core.support import Screen
from tests import naive
from tests.core import shapes


def gap(a, b, translation, rotation):
    """How far two motions are apart, 1 where they are just one cluster; the angle by its half chord."""
    angle = np.radians(naive.angle_of(a[:3, :3] @ b[:3, :3].T))
    chord = np.sin(angle / 2) / np.sin(np.radians(rotation) / 2)
    return max(chord, np.linalg.norm(a[:3, 3] - b[:3, 3]) / translation)


@pytest.mark.parametrize("seed", range(12))
def test_groups_are_those_of_complete_linkage(seed):
    rng = np.random.default_rng(seed)
    seeds = [shapes.random_motion(rng, 10) for _ in range(4)]
    motions = []
    for _ in range(30):
        m = seeds[rng.integers(4)]
        motions.append(naive.about(rng.normal(size=3), np.radians(rng.uniform(0, 2)), rng.normal(size=3)) @ m)
    motions = np.array(motions)
    labels = group_motions(motions, 2.0, 1.5)
    gaps = [[gap(a, b, 2.0, 1.5) for b in motions] for a in motions]
    expected = naive.complete_linkage(gaps, 1.0)
    assert naive.partition(labels) == expected
    assert 4 <= len(expected) < 30
    order = rng.permutation(30)
    moved = {
        frozenset(int(order[i]) for i in group) for group in naive.partition(group_motions(motions[order], 2.0, 1.5))
    }
    assert moved == expected


@pytest.mark.parametrize(
    "shift, angle, groups", [(1.99, 0, 1), (2.01, 0, 2), (0, 1.49, 1), (0, 1.51, 2), (2.5, 180, 2)]
)
def test_the_limits_of_a_cluster(shift, angle, groups):
    motions = np.array([np.eye(4), naive.rigid(naive.turn([1, 1, 0], np.radians(angle)), [0, shift, 0])])
    assert len(set(group_motions(motions, 2.0, 1.5))) == groups


def test_few_motions_and_equal_ones():
    assert group_motions(np.zeros((0, 4, 4)), 2.0, 1.5).shape == (0,)
    assert group_motions(np.eye(4)[None], 2.0, 1.5).shape == (1,)
    assert len(set(group_motions(np.tile(np.eye(4), (6, 1, 1)), 2.0, 1.5))) == 1


def scene(rng, motions, *, noise=0.1):
    """A thing and its images, apart from each other and from a thing of its own."""
    thing = shapes.ornament(rng, 4)
    curves = [naive.moved(m, c) for m in motions for c in thing]
    curves += [c + [0, 0, 80] for c in shapes.ornament(rng, 3)]
    return shapes.network([c + noise * rng.normal(size=c.shape) for c in curves], smoothing=1.0)


def clusters(net, **more):
    matches = feature_blast(net, np.arange(len(net)), l0=20.0, s=1.0, t=2.0, delta_l=5.0)
    votes = vote(net, matches, bin_translation=2.0, bin_rotation=1.5)
    screen = Screen(net, radius=2.0)
    return cluster_votes(net, votes, screen, cluster_translation=2.0, cluster_rotation=1.5, **more), screen


def test_planted_motions_lead_and_are_exact(rng):
    there = naive.about([0.2, 1, 0.1], 1.1, [40, 0, 10], along=5)
    far = naive.rigid(naive.turn([1, 0, 0], 0.4), [60, 30, 0])
    net = scene(rng, [np.eye(4), there, far])
    found, screen = clusters(net)
    assert (np.diff(found.support) <= 1e-9).all() and found.chance >= 0
    truths = [shapes.in_frame(net, m) for m in (there, far, far @ np.linalg.inv(there))]
    size = np.linalg.norm(net.points, axis=1).max()
    for truth in truths:
        both = truth, np.linalg.inv(truth)
        away = [min(gap(m, w, 1.0, 1.0) for w in both) for m in found.motions[:4]]
        assert min(away) < 1.0, "the planted motion leads, to an edge length and a degree"
        best = found.motions[int(np.argmin(away))]
        turned = min(naive.angle_of(best[:3, :3] @ w[:3, :3].T) for w in both)
        assert np.radians(turned) * size < 2.5
    assert found.support[2] > 3 * max(found.chance, found.support[4:].max(initial=0))
    # one of T and its inverse is listed, not both
    for k, m in enumerate(found.motions):
        for n in found.motions[k + 1 :]:
            assert gap(m, np.linalg.inv(n), 2.0, 1.5) > 0.9
    # what supports a motion is what it, or its inverse, brings onto the network
    both = screen.score(found.motions), screen.score(np.linalg.inv(found.motions))
    assert (found.support >= both[0] - 1e-6).all() and (found.support <= np.maximum(*both) + 1e-6).all()


def test_clusters_of_no_votes_and_a_stop(rng):
    net = shapes.network([shapes.wiggle(rng, 15)])
    found, _ = clusters(net)
    assert len(found) == 0 and found.chance == 0

    def stop(stage, fraction):
        assert stage == "clustering"
        raise Cancelled

    with pytest.raises(Cancelled):
        clusters(scene(rng, [np.eye(4), naive.rigid(shift=[50, 0, 0])]), progress=stop)


def test_votes_that_nothing_supports(rng):
    net = shapes.network([shapes.wiggle(rng, 60), shapes.wiggle(rng, 60) + [200, 0, 0]])
    far = naive.rigid(naive.turn(rng.normal(size=3), 1.0), [0, 900, 0])
    votes = Votes(np.array([far, far]), np.ones(2), np.array([[0, 1], [1, 0]]))
    screen = Screen(net, radius=2.0)
    clusters = cluster_votes(net, votes, screen, cluster_translation=2.0, cluster_rotation=1.5)
    assert len(clusters) == 0 and clusters.motions.shape == (0, 4, 4) and clusters.chance == 0
    assert detect_orbits(net, clusters, screen) == []


def test_what_lies_beside_a_motion(rng):
    motions = np.array([shapes.random_motion(rng) for _ in range(200)])
    off = perturbed(motions, np.array([20.0, 20.0, 0.0])) @ np.linalg.inv(motions)
    angle = np.array([naive.angle_of(m[:3, :3]) for m in off])
    assert angle.min() >= 4 - 1e-6 and angle.max() <= 8 + 1e-6
    shift = np.linalg.norm(off[:, :3, 3], axis=1)
    assert shift.min() > 6.9 and shift.max() < 13.1
    assert np.abs(off[:, 2, 3]).max() < 2, "a flat network stays in its plane"
    assert np.array_equal(perturbed(motions, np.ones(3), 3), perturbed(motions, np.ones(3), 3))


def test_chance_is_less_than_truth(rng):
    there = naive.rigid(shift=[45, 5, 0])
    net = scene(rng, [np.eye(4), there])
    screen = Screen(net, radius=2.0)
    truth = shapes.in_frame(net, there)[None]
    assert chance_support(screen, truth, tries=30) < 0.25 * screen.score(truth)[0]
    assert chance_support(screen, np.zeros((0, 4, 4))) == 0
