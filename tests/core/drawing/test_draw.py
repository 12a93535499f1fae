# SPDX-License-Identifier: GPL-3.0-or-later
"""Known things, drawn: all of their curves, nothing else, whatever the frame and the order of the poses."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from core.drawing import draw
from core.geometry.motions import apply, inverse, motion
from core.geometry.polylines import resample_polyline
from core.parameters import Parameters
from tests.core.drawing import known_things


def drawn_at(drafts):
    """All drawn points in the network's frame."""
    return np.concatenate(
        [
            apply(d.poses, resample_polyline(c, 0.5, ring)).reshape(-1, 3)
            for d in drafts
            for c, ring in zip(d.curves, d.closed)
        ]
    )


def true_at(truth, poses):
    return np.concatenate([apply(poses, c).reshape(-1, 3) for c in truth])


def coverage(points, by, radius=2.0):
    return float((cKDTree(by).query(points)[0] < radius).mean())


def drawn(rng, poses, *, off=True, **more):
    network, truth, closed, inside = known_things.scene(rng, poses, **more)
    given = known_things.shaken(rng, inside, truth[0].mean(axis=0)) if off else inside
    return network, truth, closed, inside, known_things.thing(given, truth[0])


@pytest.mark.parametrize("layout", ["row", "free", "mirrored", "three", "two"])
def test_all_curves_of_a_thing_and_nothing_else(rng, layout):
    poses = {
        "row": known_things.row(6),
        "free": known_things.free_poses(rng, 6),
        "mirrored": known_things.free_poses(rng, 6, mirrored=True),
        "three": known_things.free_poses(rng, 3),
        "two": known_things.free_poses(rng, 2),
    }[layout]
    network, truth, closed, inside, thing = drawn(rng, poses)
    drafts = draw(network, [thing], Parameters())
    assert coverage(true_at(truth, inside), drawn_at(drafts)) > (0.97 if len(poses) > 2 else 0.9)
    assert coverage(drawn_at(drafts), true_at(truth, inside)) > 0.98
    assert len(drafts[0].poses) == len(poses)
    long = sum(len(resample_polyline(c, 1.0, ring)) for c, ring in zip(truth, closed))
    assert sum(d.lengths.sum() for d in drafts) < 1.1 * long
    if len(poses) > 3:
        assert sum(ring for d in drafts for ring in d.closed) == 2


def test_a_false_pose_goes_and_the_true_ones_stay(rng):
    network, truth, closed, inside, thing = drawn(rng, known_things.free_poses(rng, 5))
    wrong = inside[0] @ motion(np.eye(3), np.array([14.0, 9.0, 3.0]))
    thing.poses = np.concatenate([thing.poses[:2], wrong[None], thing.poses[2:]])
    drafts = draw(network, [thing], Parameters())
    assert drafts[0].keys[:, 0].tolist() == [0, 1, 3, 4, 5]


def test_a_curve_of_some_poses_is_drawn_at_these(rng):
    poses = known_things.free_poses(rng, 8)
    more = np.c_[np.arange(40.0) - 5, np.full(40, -9.0), np.zeros(40)]
    some = [1, 4, 6, 7]
    network, truth, closed, inside, thing = drawn(rng, poses, strong=[apply(poses[k], more) for k in some])
    drafts = draw(network, [thing], Parameters())
    assert sorted(len(d.poses) for d in drafts) == [4, 8]
    few = min(drafts, key=lambda d: len(d.poses))
    assert few.keys[:, 0].tolist() == some


def test_a_course_is_no_part_of_a_thing_but_a_sill_is(rng):
    poses = known_things.row(7)
    x = np.arange(-60.0, 420.0)
    course = np.c_[x, np.full(len(x), -12.0), np.zeros(len(x))]
    truth, closed = known_things.window()
    sill = np.c_[np.arange(-3.0, 33.0), np.full(36, -6.0), np.zeros(36)]
    network, truth, closed, inside, thing = drawn(
        rng, poses, curves=([*truth, sill], [*closed, False]), strong=[course]
    )
    drafts = draw(network, [thing], Parameters())
    at = drawn_at(drafts)
    assert coverage(true_at([sill], inside), at) > 0.95
    line = (course - network.centre) @ network.rotation
    assert coverage(line, at) < 0.1


def test_the_frame_and_the_order_of_the_poses_do_not_matter(rng):
    network, truth, closed, inside, thing = drawn(rng, known_things.free_poses(rng, 5))
    first = drawn_at(draw(network, [thing], Parameters()))
    frame = motion(Rotation.from_rotvec([0.3, -1.1, 0.6]).as_matrix(), np.array([5.0, -3.0, 8.0]))
    order = np.array([3, 0, 4, 2, 1])
    moved = known_things.thing((thing.poses @ inverse(frame))[order], apply(frame, thing.points))
    second = drawn_at(draw(network, [moved], Parameters()))
    assert coverage(first, second, 1.0) > 0.98
    assert coverage(second, first, 1.0) > 0.98


def test_nothing_is_written_to_and_nothing_comes_of_nothing(rng):
    network, truth, closed, inside, thing = drawn(rng, known_things.free_poses(rng, 3))
    before = thing.points.copy(), thing.poses.copy(), network.points.copy()
    draw(network, [thing], Parameters())
    assert all((a == b).all() for a, b in zip(before, (thing.points, thing.poses, network.points)))
    assert draw(network, [], Parameters()) == []
    far = thing.poses.copy()
    far[:, :3, 3] += 900
    away = known_things.thing(far, truth[0])
    assert draw(network, [away], Parameters()) == []
    assert draw(network, [known_things.thing(thing.poses[:1], truth[0])], Parameters()) == []
