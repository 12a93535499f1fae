# SPDX-License-Identifier: GPL-3.0-or-later
"""What other thresholds of detection would add and drop, before a run."""

import numpy as np
import pytest


def tried(bpy, part):
    """The Trial, or the words, that the settings give."""
    _, work = part("fcn_addon.job.trial").prepare(bpy.context)
    return work(lambda stage, fraction: None) if callable(work) else work


def length(segments):
    return np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()


def of_mesh(item):
    """(k, 2, 3), the edges of a mesh object in the world."""
    points = np.array([item.matrix_world @ v.co for v in item.data.vertices])
    return points[np.array([e.vertices for e in item.data.edges])]


def test_nothing_is_tried_before_curves_are_detected(bpy, part, scan):
    assert tried(bpy, part) is None


def test_the_same_thresholds_change_nothing(bpy, part, scan):
    bpy.ops.fcn.detect()
    found = tried(bpy, part)
    assert (len(found.added), len(found.dropped), found.longer, found.shorter) == (0, 0, 0, 0)


def test_what_is_dropped_and_added_is_what_a_run_drops_and_adds(bpy, part, scan):
    bpy.ops.fcn.detect()
    before = of_mesh(bpy.context.active_object)
    settings = bpy.context.scene.fcn.detection
    settings.valleys = False
    found = tried(bpy, part)
    assert len(found.added) == 0 and 0 < found.shorter < 1
    scan.select_set(True)
    bpy.context.view_layer.objects.active = scan
    bpy.context.scene.fcn.earlier = "REPLACE"
    bpy.ops.fcn.detect()
    after = of_mesh(bpy.context.active_object)
    assert found.shorter == pytest.approx(1 - length(after) / length(before), abs=0.02)
    assert length(found.dropped) == pytest.approx(length(before) - length(after), rel=0.05)
    settings.valleys = True
    back = tried(bpy, part)
    assert len(back.dropped) == 0
    assert length(back.added) == pytest.approx(length(before) - length(after), rel=0.05)


def test_curves_that_were_moved_are_outlined_where_they_are(bpy, part, scan):
    bpy.ops.fcn.detect()
    item = bpy.context.active_object
    bpy.context.scene.fcn.detection.valleys = False
    here = tried(bpy, part)
    item.location.x += 50
    bpy.context.view_layer.update()
    there = tried(bpy, part)
    assert there.dropped == pytest.approx(here.dropped + [50, 0, 0], abs=1e-4)


def test_another_detail_is_left_to_the_run(bpy, part, scan):
    bpy.ops.fcn.detect()
    bpy.context.scene.fcn.detection.detail = 3.0
    assert "detail" in tried(bpy, part)


def test_stretches_are_compared_one_by_one(part):
    curves, compare = part("core.values").Curves, part("fcn_addon.job.trial").compare
    line = np.linspace([0, 0, 0], [10.0, 0, 0], 11)
    square = np.array([[20.0, 0, 0], [21, 0, 0], [21, 1, 0], [20, 1, 0]])
    now, then = curves.from_list([line, square], [False, True]), curves.from_list([line[:6] + [0, 0.3, 0]])
    found = compare(now, then, 0.5, np.eye(4))
    assert len(found.added) == 0
    assert length(found.dropped) == pytest.approx(5 + 4)
    assert found.shorter == pytest.approx(9 / 14)
    back = compare(then, now, 0.5, np.eye(4))
    assert len(back.dropped) == 0 and length(back.added) == pytest.approx(9)
    assert back.longer == pytest.approx(9 / 5)
