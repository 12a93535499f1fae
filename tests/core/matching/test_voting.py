# SPDX-License-Identifier: GPL-3.0-or-later
"""Votes are the maxima of the voting space, counted vote by vote."""

from __future__ import annotations

import numpy as np
import pytest

from core.matching.blast import Matches, feature_blast
from core.matching.voting import vote
from tests import naive
from tests.core import shapes

BINS = {"bin_translation": 2.0, "bin_rotation": 1.5}


def naive_votes(net, matches, *, bin_translation, bin_rotation):
    """The strongest vote of a pair opens a bin and takes in all within it, then the next one of those left."""
    pairs = {}
    for k in range(len(matches)):
        pairs.setdefault(tuple(matches.curve[k]), []).append(k)
    out = []
    for (i, j), left in pairs.items():
        weight = {k: matches.affinity[k] * (0.05 + matches.stiffness[k]) for k in left}
        middle = net.curve(i).mean(axis=0)
        while left:
            lead = max(left, key=lambda k: weight[k])
            inside = []
            for k in left:
                m, n = matches.motions[k], matches.motions[lead]
                gap = np.linalg.norm(naive.moved(m, [middle])[0] - naive.moved(n, [middle])[0])
                if gap <= bin_translation and naive.angle_of(m[:3, :3] @ n[:3, :3].T) <= bin_rotation + 1e-6:
                    inside.append(k)
            out.append(((i, j), lead, sum(weight[k] for k in inside)))
            left = [k for k in left if k not in inside]
    return out


@pytest.mark.parametrize("translation, rotation", [(2.0, 1.5), (5.0, 20.0), (20.0, 45.0)])
def test_the_maxima_are_those_of_the_loop(rng, translation, rotation):
    base = [shapes.wiggle(rng, 40, bend=0.4) for _ in range(3)]
    copies = [naive.moved(shapes.random_motion(rng), c) + 0.1 * rng.normal(size=c.shape) for c in base]
    net = shapes.network(base + copies, smoothing=1.0)
    matches = feature_blast(net, np.arange(6), l0=20.0, s=1.0, t=2.0, delta_l=5.0)
    bins = {"bin_translation": translation, "bin_rotation": rotation}
    got = vote(net, matches, **bins)
    expected = naive_votes(net, matches, **bins)
    assert len(got) == len(expected) > 20 and (len(got) < len(matches) or translation == 2)
    assert (np.diff(got.weight) <= 0).all()
    expected = {(pair, round(float(w), 6)): matches.motions[k] for pair, k, w in expected}
    for motion, weight, pair in zip(got.motions, got.weight, got.pair):
        assert np.allclose(motion, expected[tuple(pair), round(float(weight), 6)])


def planted(motions, affinity, stiffness=1.0, curve=(0, 1)):
    """Matches with given motions."""
    k, none = len(motions), np.zeros(0)
    return Matches(
        np.broadcast_to(curve, (k, 2)), np.zeros((k, 2), int), np.ones(k, int), np.full(k, 25), none,
        np.array(affinity, float), np.broadcast_to(np.asarray(stiffness, float), k), np.array(motions), 0,
    )  # fmt: skip


@pytest.mark.parametrize("off, bins", [(0.0, 1), (1.99, 1), (2.01, 2)])
def test_the_bin_in_translation_is_inclusive_of_its_size(rng, off, bins):
    net = shapes.network([shapes.wiggle(rng, 30), shapes.wiggle(rng, 30)])
    motions = [np.eye(4), naive.rigid(shift=[off, 0, 0])]
    votes = vote(net, planted(motions, [3, 1]), **BINS)
    assert len(votes) == bins
    assert votes.weight.sum() == pytest.approx(4 * 1.05) and np.allclose(votes.motions[0], np.eye(4))


@pytest.mark.parametrize("angle, bins", [(1.49, 1), (1.51, 2)])
def test_the_bin_in_rotation_is_about_the_middle_of_the_curve(rng, angle, bins):
    net = shapes.network([shapes.wiggle(rng, 30) + 500, shapes.wiggle(rng, 30)])
    middle = net.curve(0).mean(axis=0)
    turned = naive.about([1, 2, 3], np.radians(angle), middle)
    votes = vote(net, planted([np.eye(4), turned], [1, 1]), **BINS)
    assert len(votes) == bins


def test_q_and_minus_q_are_one_rotation_and_borders_split_no_peak(rng):
    net = shapes.network([shapes.wiggle(rng, 30), shapes.wiggle(rng, 30)])
    middle = net.curve(0).mean(axis=0)
    # half a turn, a little less and a little more of it: where quaternions and angles jump
    motions = [naive.about([0, 0, 1], np.pi + np.radians(a), middle) for a in (0.0, 0.7, -0.7)]
    # votes on both sides of where a fixed lattice of 2 edges would have its border
    motions += [naive.rigid(shift=[20 + x, 0, 0]) for x in (0.0, 0.9, -0.9)]
    votes = vote(net, planted(motions, [5, 1, 1, 4, 1, 1]), **BINS)
    assert len(votes) == 2 and votes.weight == pytest.approx([7 * 1.05, 6 * 1.05])


def test_pairs_do_not_share_bins_and_stiff_votes_weigh_more(rng):
    net = shapes.network([shapes.wiggle(rng, 30) for _ in range(3)])
    four = planted([np.eye(4)] * 4, [1, 1, 1, 1], [0, 0, 1, 1], [[0, 1], [0, 2], [0, 2], [1, 2]])
    votes = vote(net, four, **BINS)
    assert votes.weight == pytest.approx([1.1, 1.05, 0.05])
    assert votes.pair.tolist() == [[0, 2], [1, 2], [0, 1]]


def test_no_match_no_vote(rng):
    net = shapes.network([shapes.line(10)])
    matches = feature_blast(net, np.array([0]), l0=20.0, s=1.0, t=2.0, delta_l=5.0)
    votes = vote(net, matches, **BINS)
    assert len(votes) == 0 and votes.motions.shape == (0, 4, 4)
