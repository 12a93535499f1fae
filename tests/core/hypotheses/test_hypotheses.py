# SPDX-License-Identifier: GPL-3.0-or-later
"""What a pose is worth, what belongs to a thing, what chance gives, and things found in small scenes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.evidence.field import Field
from core.evidence.odds import UNIT
from core.geometry.motions import apply
from core.hypotheses.extent import along_curves, chance_at, spread
from core.hypotheses.finding import find_things
from core.hypotheses.growth import closures, rescored
from core.hypotheses.hypothesis import SHARES, SPACING, Hypothesis, beside, distinct, explained, pose_scores
from core.hypotheses.seeding import find_seeds
from core.matching.blast import feature_blast
from core.matching.strong import strong_curves
from core.parameters import Parameters
from core.threads import single_threaded
from tests.core.shapes import line, network, ornament, random_motion, to_frame, wiggle


def scene(rng, places, clutter=0):
    """The network of an ornament at places apart, turned each its own way, among curves that do not recur."""
    thing = ornament(rng, 4, size=25, count=60)
    poses = [random_motion(rng, reach=1.0) for _ in range(places)]
    for k, pose in enumerate(poses):
        pose[:3, 3] = [90.0 * k, 10.0 * (k % 2), 0]
    curves = [apply(pose[None], c)[0] for pose in poses for c in thing]
    curves += [wiggle(rng, 60) + rng.uniform(-100, 200, 3) for _ in range(clutter)]
    return network(curves), poses


def things_of(net, **options):
    p = Parameters()
    with single_threaded():
        return _things_of(net, p, options)


def _things_of(net, p, options):
    field = Field(net, radius=p.epsilon)
    strong = strong_curves(net, l0=p.l0, strong_curvature=p.strong_curvature)
    matches = feature_blast(net, strong, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l)
    seeds, _ = find_seeds(field, [matches], epsilon=p.epsilon)
    return field, seeds, find_things(field, seeds, significance=p.significance, **options)


def a_thing(rng, poses=1):
    net = network(ornament(rng, 4, size=20))
    field = Field(net, radius=2.0)
    probe = field.probe(np.arange(0, len(field), 2))
    chance = np.full(len(probe), 0.1)
    zero = np.zeros(poses)
    return field, Hypothesis(probe, chance, np.stack([np.eye(4)] * poses), zero, zero)


def test_pose_scores_are_those_of_the_loop(rng):
    field, thing = a_thing(rng)
    poses = np.stack([np.eye(4), random_motion(rng, reach=8.0)])
    owned = rng.random(len(field)) < 0.3
    thing = replace(thing, chance=np.where(np.arange(len(thing.points)) % 3, 0.1, 1.0))
    scores, terms, near = pose_scores(field, thing, poses, owned)
    for k in range(len(poses)):
        best = -np.inf
        for p in SHARES:
            total = 0.0
            for i in range(len(thing.points)):
                hit = near[k, i] >= 0
                if (hit and owned[near[k, i]]) or thing.chance[i] == 1.0:
                    continue
                odds = np.log(p / 0.1) if hit else np.log((1 - p) / 0.9)
                total += odds * SPACING / UNIT
            best = max(best, total)
        assert scores[k] == pytest.approx(best - np.log(len(SHARES)))
        assert terms[k].sum() == pytest.approx(best)


def test_no_pose_is_beside_itself_though_another_stands_there(rng):
    centres = rng.normal(size=(6, 3))
    centres[3] = centres[1]
    found = beside(centres)
    assert (found != np.arange(6)).all() and found[3] == 1 and found[1] == 3


def test_what_runs_on_from_pose_to_pose_tells_nothing_where_it_is_missing(rng):
    thing = ornament(rng, 3, size=20, count=50)
    row = [c + [70.0 * k, 0, 0] for k in range(5) for c in thing]
    net = network([*row, line(420, start=(-60, 25, 0))])
    field = Field(net, radius=2.0)
    curve = net.source[net.curve_of]
    first = np.flatnonzero((curve < 3) | (curve == 15))
    first = first[np.linalg.norm(net.points[first] - net.points[curve < 3].mean(axis=0), axis=1) < 40][::2]
    origin = to_frame(net, np.zeros((1, 3)))[0]
    step = to_frame(net, np.array([[70.0, 0, 0]]))[0] - origin
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[:, :3, 3] = np.arange(5)[:, None] * step
    chance = chance_at(field, poses, field.probe(first))
    moulding = curve[first] == 15
    assert moulding.sum() > 10 and (chance[moulding] == 1.0).all()
    assert (chance[~moulding] < 1.0).mean() > 0.95


def test_a_pose_that_is_there_already_explains_nothing_new(rng):
    field, thing = a_thing(rng, poses=2)
    assert len(rescored(field, thing, np.zeros(len(field), bool))) == 1
    assert explained(field, thing).all()


def test_spread_keeps_points_apart_and_leaves_none_out(rng):
    points = rng.uniform(0, 20, (300, 3))
    kept = spread(points, rng.random(300), 4.0)
    gap = np.linalg.norm(points[:, None] - points[kept][None], axis=2)
    assert (gap.min(axis=1) <= 4.0).all()
    apart = gap[kept]
    assert (apart[~np.eye(len(kept), dtype=bool)] > 4.0).all()


def test_means_along_curves_leave_out_the_curve_beside():
    net = network([line(30), line(30, start=(0, 3, 0))])
    field = Field(net, radius=2.0)
    values = (net.curve_of == 0).astype(float)
    assert np.allclose(along_curves(values, field.probe(np.arange(len(field))), 6.0), values)


def test_closures_predict_the_next_step_of_a_row(rng):
    _, thing = a_thing(rng)
    row = np.stack([np.eye(4)] * 4)
    row[:, 0, 3] = 100.0 * np.arange(4)
    thing = Hypothesis(thing.probe, thing.chance, row, np.zeros(4), np.zeros(4))
    predicted, agree = closures(thing)
    shifts = {-300: 0, 400: 0}
    for pose, many in zip(predicted, agree):
        if round(pose[0, 3]) in shifts:
            shifts[round(pose[0, 3])] = many
    assert shifts[400] >= 3


def test_distinct_poses_are_apart_and_the_best_stay(rng):
    _, thing = a_thing(rng)
    poses = np.stack([np.eye(4)] * 5)
    poses[:, 0, 3] = [0, 1, 2, 50, 51]
    assert sorted(distinct(thing, poses, np.array([1.0, 3, 2, 1, 5]), gap=6.0)) == [1, 4]


@pytest.fixture(scope="module")
def found():
    """A small scene, its true poses, its field and seeds, its things, and how often the search asked to go on."""
    net, true = scene(np.random.default_rng(4), 3)
    ticks = []
    return net, true, *things_of(net, tick=lambda over=None: ticks.append(over)), ticks


def test_things_are_found_where_they_are(found):
    net, true, _, _, things, ticks = found
    assert things and len(things[0]) == 3 and things[0].expected < 1e-4 and len(ticks) > 10
    motions = net.motion_from_world(np.stack([b @ np.linalg.inv(a) for a in true for b in true]))
    poses = things[0].poses
    for a in poses:
        at = things[0].points @ a[:3, :3].T + a[:3, 3]
        for b in poses:
            there = things[0].points @ b[:3, :3].T + b[:3, 3]
            assert np.linalg.norm(apply(motions, at) - there, axis=2).mean(axis=1).min() < 1.5


def test_poses_are_rigid(found):
    r = found[4][0].poses[:, :3, :3]
    assert np.allclose(r @ np.swapaxes(r, 1, 2), np.eye(3), atol=1e-9) and np.allclose(np.linalg.det(r), 1)


def test_the_same_things_are_found_every_time(found):
    _, _, field, seeds, things, _ = found
    with single_threaded():
        again = find_things(field, seeds, significance=Parameters().significance)
    assert len(again) == len(things)
    assert all((x.poses == y.poses).all() and (x.points == y.points).all() for x, y in zip(again, things))


def test_cancelling_ends_the_search(found):
    class Cancelled(Exception):
        pass

    def tick():
        raise Cancelled

    with pytest.raises(Cancelled):
        find_things(found[2], found[3], significance=0.05, tick=tick)


def test_nothing_is_found_where_nothing_recurs(rng):
    net = network([wiggle(rng, 60) + rng.uniform(-60, 60, 3) for _ in range(6)])
    assert things_of(net)[2] == []
