# SPDX-License-Identifier: GPL-3.0-or-later
"""What shows a moved point, against loops over all samples; and the watershed of labels."""

from __future__ import annotations

import numpy as np
import pytest

from core.evidence.field import COSINE, Field
from core.evidence.nearest import NearestTable
from core.geometry.motions import exponential
from tests import naive
from tests.core.shapes import circle, line, network, ornament, random_motion


def nearest_by_loop(points, at):
    """Index of the nearest point and its distance, one query at a time."""
    gaps = [np.linalg.norm(points - p, axis=1) for p in at]
    return np.array([g.argmin() for g in gaps]), np.array([g.min() for g in gaps])


@pytest.mark.parametrize("count", [1, 400])
def test_table_gives_the_nearest_to_about_a_voxel(rng, count):
    points = rng.uniform(-40, 40, (count, 3)) + [1000, -500, 3]
    at = points[rng.integers(count, size=3000)] + rng.normal(size=(3000, 3)) * 2
    near = NearestTable(points, 6.0, 1.0).look_up(at)
    _, least = nearest_by_loop(points, at)
    reached = least < 5
    assert (near[reached] >= 0).all()
    # Half the diagonal of a voxel on either side.
    assert (np.linalg.norm(points[near[reached]] - at[reached], axis=1) < least[reached] + np.sqrt(3)).all()


def test_far_away_nothing_is_near(rng):
    field = Field(network(ornament(rng)), radius=2.0)
    assert (field.nearest(np.array([[1e6, 0, 0], [-1e6, 2, 1], [0, 0, 1e4]])) == -1).all()


def test_targets_are_those_of_the_loop(rng):
    net = network(ornament(rng, 4))
    field = Field(net, radius=2.0)
    pick = np.arange(0, len(net.points), 3)
    probe = field.probe(pick)
    small = exponential(np.concatenate([rng.normal(size=(8, 3)) * 0.02, rng.normal(size=(8, 3))], axis=1))
    found = field.targets(small, probe)
    wrong = 0
    for k, m in enumerate(small):
        at, lines = naive.moved(m, net.points[pick]), naive.moved(naive.rigid(m[:3, :3]), net.tangents[pick])
        near, gap = nearest_by_loop(net.points, at)
        for i in range(len(pick)):
            expected = gap[i] <= 2.0 and abs(net.tangents[near[i]] @ lines[i]) > COSINE
            wrong += expected != (found[k, i] >= 0)
            if found[k, i] >= 0:
                assert np.linalg.norm(net.points[found[k, i]] - at[i]) <= 2.0
                assert abs(net.tangents[found[k, i]] @ lines[i]) > COSINE
    # The table is exact to a voxel: few points lie at the very edge.
    assert wrong < 0.06 * found.size


def test_every_sample_shows_itself():
    net = network([circle(30.0), line(60, start=(-30, 0, 9))], closed=[True, False])
    field = Field(net, radius=2.0)
    assert (field.targets(np.eye(4)[None], field.probe(np.arange(len(net.points)))) >= 0).all()


def test_watershed_follows_the_curves_and_leaves_what_is_out_of_reach():
    net = network([line(40), line(40, start=(0, 200, 0))])
    field = Field(net, radius=2.0)
    label = np.full(len(field), -1)
    first, last = net.offsets[0], net.offsets[1] - 1
    label[first], label[last] = 7, 9
    out = field.watershed(label)
    along = out[first : last + 1]
    middle = len(along) // 2
    assert (along[: middle - 4] == 7).all() and (along[middle + 4 :] == 9).all()
    assert (out[net.offsets[1] :] == -1).all()
    assert (field.watershed(np.full(len(field), -1)) == -1).all()


def test_results_do_not_depend_on_what_is_asked_together(rng):
    field = Field(network(ornament(rng, 4)), radius=2.0)
    poses = np.stack([random_motion(rng, reach=5.0) for _ in range(6)])
    probe = field.probe(np.arange(0, len(field), 2))
    together = field.targets(poses, probe)
    assert all((field.targets(poses[k : k + 1], probe)[0] == together[k]).all() for k in range(len(poses)))
