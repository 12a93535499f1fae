# SPDX-License-Identifier: GPL-3.0-or-later
"""What runs on from pose to pose, and what ends before the next one begins; and what is drawn once."""

from __future__ import annotations

import numpy as np
import pytest

from core.drawing.choosing import Chosen
from core.drawing.continuing import drawn_once
from core.drawing.sliding import Ways
from core.geometry.motions import apply
from tests import naive
from tests.core.shapes import circle, line, network, to_frame


def row(count, step=50.0):
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, 3] = [[step * k, 0, 0] for k in range(count)]
    return poses


def ways(curves, poses, frame=None):
    """Ways of poses in the world of some curves, and what takes points of that world to the network's frame."""
    net = network(curves)
    origin = to_frame(net, np.zeros((1, 3)))[0]
    inner = np.eye(4)
    inner[:3, :3], inner[:3, 3] = (to_frame(net, np.eye(3)) - origin).T, origin
    return Ways(net, inner @ poses, 2.5)


def test_a_cornice_runs_on_and_a_row_of_sills_does_not():
    sills = [line(30, start=(50.0 * k, 20, 0)) for k in range(5)]
    asked = ways([line(300, start=(-25, 0, 0)), *sills], row(5))
    assert asked.slides(line(30)[:25])
    assert not asked.slides(sills[0])


def test_the_middle_of_wide_sills_does_not_run_on_as_all_end_at_one_place():
    sills = [line(60, start=(85.0 * k, 20, 0)) for k in range(4)]
    middle = line(60, start=(0, 20, 0))[20:41]
    assert not ways(sills, row(4, step=85.0)).slides(middle)
    # With holes that are anywhere it is one line.
    whole = line(315, start=(0, 20, 0))
    pieces = [whole[a:b] for a, b in ((0, 46), (58, 148), (160, 246), (258, 316))]
    assert ways(pieces, row(4, step=85.0)).slides(middle)


def test_a_cornice_of_two_bays_runs_on_though_others_lack_it():
    asked = ways([line(95, start=(0, 0, 0)), *(line(30, start=(0, 40, 20.0 * k)) for k in range(3))], row(6))
    assert asked.slides(line(30))


def test_rings_about_the_axis_run_on_and_spokes_do_not():
    poses = np.array([naive.about([0, 0, 1], 2 * np.pi * k / 8, [0, 0, 0]) for k in range(8)])
    spokes = [apply(pose[None], line(25, start=(20, 0, 0)))[0] for pose in poses]
    asked = ways([circle(60.0, n=400), *spokes], poses)
    arc = circle(60.0, n=400)[:25]
    assert asked.slides(arc) and not asked.slides(spokes[0])


def test_what_two_poses_show_alone_is_not_asked_of_a_third():
    # The line leads out of what surrounds the poses: what lies between is asked of the network itself.
    asked = ways([line(700, start=(-10, 0, 0))], row(3, step=300.0))
    assert asked.slides(line(40))


@pytest.mark.parametrize("share, curves", [(1.0, 1), (0.0, 2)])
def test_a_curve_that_lies_on_others_at_most_of_its_places_is_drawn_once(share, curves):
    poses = row(4)
    sill, next_sill = line(30), line(28, start=(50.0, 0.5 if share else 9.0, 0))
    chosen = Chosen([sill, next_sill], [False, False], np.ones((2, 4), bool), np.array([9.0, 5.0]))
    shown = np.array([[0.8, 0.8], [0.8, 0.8], [0.8, 0.8], [0.8, 0.1]])
    assert len(drawn_once(chosen, poses, shown).curves) == curves
