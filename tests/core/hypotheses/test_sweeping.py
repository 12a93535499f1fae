# SPDX-License-Identifier: GPL-3.0-or-later
"""A known thing is found wherever it stands; what is symmetric is turned as all say; what pays is kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.evidence.field import Field, Probe
from core.geometry.motions import apply
from core.hypotheses.completing import with_empty_cells
from core.hypotheses.deciding import Growth, left_over
from core.hypotheses.hypothesis import Hypothesis, explained
from core.hypotheses.seeding import Seeds
from core.hypotheses.splitting import parted
from core.hypotheses.sweeping import Crowd, PointPairs, features
from core.hypotheses.symmetry import oriented
from core.transformations.description import saving, worth_saying
from tests.core.shapes import circle, line, network, ornament, random_motion, to_frame, wiggle


def standing(rng, count):
    """Poses (k, 4, 4) that stand apart, turned each its own way."""
    poses = np.array([random_motion(rng, reach=1.0) for _ in range(count)])
    poses[:, :3, 3] = [[90.0 * k, 25.0 * (k % 3), 0] for k in range(count)]
    return poses


def placed(curves, poses):
    return [apply(pose[None], c)[0] for pose in poses for c in curves]


def thing_at(net, curves, poses):
    """The thing of curves in their own frame, at poses, in the frame of a network."""
    origin = to_frame(net, np.zeros((1, 3)))[0]
    axes = to_frame(net, np.eye(3)) - origin
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = axes.T, origin
    alone = network(curves)
    points = alone.points @ (alone.rotation).T * alone.unit + alone.centre
    tangents = alone.tangents @ alone.rotation.T
    probe = Probe(points[::2], tangents[::2])
    k = len(poses)
    return Hypothesis(probe, np.full(len(probe), 0.1), frame @ poses, np.full(k, 30.0), np.zeros(k))


def test_a_thing_is_led_to_everywhere_though_half_is_hidden(rng):
    curves = ornament(rng, 5, size=25, count=60)
    poses = standing(rng, 7)
    shown = [c[10:40] if k % 2 else c[: len(c) // 2 + 8] for k, c in enumerate(placed(curves, poses))]
    net = network([*shown, *(wiggle(rng, 60) + rng.uniform(-50, 600, 3) * [1, 0.2, 0.2] for _ in range(6))])
    thing = thing_at(net, curves, poses)
    found = PointPairs(Field(net, radius=2.0)).poses(thing.at(np.zeros(1, int)))
    assert thing.differences(thing.poses, found).min(axis=1).max() < 4.0


def test_the_features_of_a_pair_are_its_own(rng):
    points, lines = rng.normal(size=(20, 3)) * 15, rng.normal(size=(20, 3))
    lines /= np.linalg.norm(lines, axis=1)[:, None]
    pair = np.stack([np.arange(10), np.arange(10, 20)], axis=1)
    feature, bent = features(points, lines, pair)
    motion = random_motion(rng)
    turned = features(apply(motion[None], points)[0], -lines @ motion[:3, :3].T, pair)
    assert np.allclose(feature, turned[0]) and (bent == turned[1]).all()
    swapped = features(points, lines, pair[:, ::-1])[0]
    assert np.allclose(feature[:, [0, 2, 1, 3]], swapped)


def test_a_crowd_is_counted_within_one_and_a_half_tolerances(rng):
    features = rng.uniform(0, 6, (400, 4))
    asked = rng.uniform(0, 6, (60, 4))
    count = Crowd(features).about(asked)
    cell = np.floor(asked)[:, None] - np.floor(features)[None]
    assert (count == (np.abs(cell) <= 1).all(axis=2).sum(axis=1)).all()
    gap = np.abs(asked[:, None] - features[None]).max(axis=2)
    assert ((gap <= 1).sum(axis=1) <= count).all() and (count <= (gap <= 2).sum(axis=1)).all()


def row_of_ornaments(rng, count, step=60.0):
    """A row of one ornament, its network, the poses in the row, and its curves."""
    curves = ornament(rng, 4, size=20, count=50)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, 3] = [[step * k, 0, 0] for k in range(count)]
    return network([c + 0.1 * rng.normal(size=c.shape) for c in placed(curves, poses)]), poses, curves


def test_a_thing_that_reaches_over_its_neighbours_is_cut(rng):
    net, poses, curves = row_of_ornaments(rng, 6)
    field, taken = Field(net, radius=2.0), np.zeros(sum(np.diff(net.offsets)), bool)
    double = thing_at(net, placed(curves, poses[:2]), poses[::2])
    none = np.zeros(0, np.int64)
    seeds = Seeds(np.zeros((0, 4, 4)), none, none, none.reshape(0, 9), np.zeros(0), np.zeros(0))
    out = parted(field, double, seeds, taken, PointPairs(field))
    assert len(out) == 6 and len(out.points) < 0.7 * len(double.points)
    whole = thing_at(net, curves, poses)
    assert parted(field, whole, seeds, taken, PointPairs(field)) is whole


def test_cells_that_an_orbit_predicts_are_asked_and_empty_ones_stay_empty(rng):
    net, poses, curves = row_of_ornaments(rng, 7)
    there = np.setdiff1d(np.arange(7), [3])
    kept = [i for i in range(len(net)) if net.source[i] // len(curves) != 3]
    field = Field(net.part(np.array(kept)), radius=2.0)
    taken = np.zeros(len(field), bool)
    thing = thing_at(net, curves, poses[[0, 1, 2, 5, 6]])
    full = with_empty_cells(field, thing, thing.orbit, taken)
    wanted = thing_at(net, curves, poses)
    gap = wanted.differences(wanted.poses, full.poses).min(axis=1)
    assert (gap[there] < 2.0).all() and gap[3] > 10.0 and len(full) == 6


def test_a_thing_that_is_taken_leaves_what_it_shares_little_with(rng):
    net, poses, curves = row_of_ornaments(rng, 14)
    field, thing = Field(net, radius=2.0), thing_at(net, curves, poses)
    growths = {0: [Growth(thing.at(np.arange(12)))], 1: [Growth(thing.at([12, 13]))], 2: [Growth(thing.at([0, 1]))]}
    new = explained(field, thing, thing.poses[:1])
    left = left_over(field, growths, new, new)
    assert left[1] == growths[1] and 2 not in left
    assert len(left[0][0].thing) == 11


def test_a_pose_alone_is_no_orbit_and_saves_nothing(rng):
    net, poses, curves = row_of_ornaments(rng, 2)
    field, thing = Field(net, radius=2.0), thing_at(net, curves, poses[:1])
    assert thing.orbit.kind == "single" and len(thing.orbit.empty_poses()) == 0 and saving(thing) == 0.0
    assert with_empty_cells(field, thing, thing.orbit, np.zeros(len(field), bool)) is thing


def test_a_straight_line_leads_nowhere():
    net = network([line(80), line(80, start=(0, 60, 0))])
    thing = thing_at(net, [line(40)], np.eye(4)[None])
    assert len(PointPairs(Field(net, radius=2.0)).poses(thing)) == 0


def flat_ring_with_a_mark():
    """Two rails and a bar, which half a turn takes onto themselves, and a ring that it does not."""
    rails = [line(80, start=(-40, y, 0)) for y in (-8, 8)]
    return [*rails, line(16, start=(0, -8, 0), way=(0, 1, 0)), circle(5.0, (25, 0, 0), n=32)]


def test_a_symmetric_thing_is_turned_as_all_say(rng):
    curves = flat_ring_with_a_mark()
    poses = np.tile(np.eye(4), (6, 1, 1))
    poses[:, :3, 3] = [[0, 45.0 * k, 0] for k in range(6)]
    half = np.diag([-1.0, -1.0, 1.0, 1.0])
    net = network([c + 0.15 * rng.normal(size=c.shape) for c in placed(curves, poses)])
    mixed = poses.copy()
    mixed[[1, 4]] = poses[[1, 4]] @ half
    thing = thing_at(net, curves[:3], mixed)
    field = Field(net, radius=2.0)
    out = oriented(field, thing, np.zeros(len(field), bool), by_all=True)
    turns = out.poses[:, :3, :3] @ np.swapaxes(out.poses[:1, :3, :3], 1, 2)
    assert np.trace(turns, axis1=1, axis2=2).min() > 2.9


def test_where_nothing_tells_no_pose_is_turned(rng):
    curves = flat_ring_with_a_mark()[:3]
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, :3, 3] = [[0, 45.0 * k, 0] for k in range(4)]
    net = network([c + 0.15 * rng.normal(size=c.shape) for c in placed(curves, poses)])
    field = Field(net, radius=2.0)
    thing = thing_at(net, curves, poses)
    assert oriented(field, thing, np.zeros(len(field), bool), by_all=True) is thing


@pytest.mark.parametrize("score, kept", [(14.0, 6), (40.0, 7)])
def test_a_pose_beside_an_orbit_must_pay_for_itself(rng, score, kept):
    curves = ornament(rng, 3, size=15, count=40)
    poses = np.tile(np.eye(4), (7, 1, 1))
    poses[:, :3, 3] = [[60.0 * k, 0, 0] for k in range(7)]
    poses[6] = random_motion(rng, reach=1.0)
    poses[6, :3, 3] = [100.0, 80.0, 30.0]
    thing = thing_at(network(curves), curves, poses)
    scores = np.full(7, 14.0)
    scores[6] = score
    assert len(worth_saying(replace(thing, scores=scores))) == kept
