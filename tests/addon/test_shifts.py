# SPDX-License-Identifier: GPL-3.0-or-later
"""Results far from the origin: within 1e-6 of their extent of what was computed, and back again."""

import dataclasses

import numpy as np
import pytest

UTM = (450123.4, 5411987.6, 212.3)


def world(bpy, kind="CURVE"):
    """(n, 3) float64, all completed points of the open file as Blender shows them."""
    bpy.context.view_layer.update()
    found = []
    for item in bpy.data.objects:
        if item.type == kind and "support" in item:
            matrix = np.array(item.matrix_world, float)
            points = np.array([p.co[:3] for spline in item.data.splines for p in spline.points], float)
            found.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)


def computed(completion):
    """The same of a Completion, in the order of the objects' names; as a set."""
    parts = [c.points @ m[:3, :3].T + m[:3, 3] for t in completion.templates for m in t.occurrences for c in t.curves]
    return np.concatenate([*parts, *(c.points for c in completion.strong)])


def distance(a, b):
    """The largest distance of a point of a from the nearest of b."""
    return max(np.linalg.norm(b - p, axis=1).min() for p in a)


@pytest.mark.parametrize(
    ("offset", "is_shifted"),
    [((0, 0, 0), False), ((150, 0, 0), False), (UTM, True), ((0, -5e6, 0), True), ((3e7, 3e7, 3e7), True)],
)
def test_a_written_result_is_where_it_was_computed(bpy, part, completion, tmp_path, offset, is_shifted):
    shifts, origin = part("fcn_addon.shifts"), part("fcn_addon.scene.origin")
    completion = shifts.moved_completion(completion, np.array(offset))
    truth = computed(completion)
    extent = np.ptp(truth, axis=0).max()
    wide = part("core.values").Curves.from_list(np.array_split(truth, 4), [False] * 4)
    path = str(tmp_path / "r.blend")
    blend_file = part("fcn_addon.command.blend_file")
    blend_file.write(completion, wide, path, blend_file.Made("wall", part("core.parameters").Parameters()))
    bpy.ops.wm.open_mainfile(filepath=path)
    (root,) = bpy.context.scene.collection.children
    shift = origin.of(root)
    assert np.array_equal(shift, origin.of(bpy.context.scene)) and shift.any() == is_shifted
    assert np.array_equal(shift, np.round(shift)) and (origin.words(shift) != "") == is_shifted
    assert distance(world(bpy) - truth.mean(axis=0) + shift, truth - truth.mean(axis=0)) < 1e-6 * extent
    # And what is read from it has the shift again.
    found, _, kept = blend_file.read(path, blend_file.Choice(objects=("Input",)))
    assert np.array_equal(kept, shift)
    assert distance(found[0].curves.points - wide.points[0], wide.points - wide.points[0]) < 1e-6 * extent


def test_curves_with_handles_are_where_they_were_computed_too(bpy, part, completion, tmp_path):
    shifts, blend_file = part("fcn_addon.shifts"), part("fcn_addon.command.blend_file")
    wide = part("core.values").Curves.from_list(np.array_split(computed(completion), 4), [False] * 4)
    fitted = part("core.fitting").fit_completion(completion, wide)
    far = shifts.moved_completion(completion, UTM), shifts.moved_curves(wide, UTM)
    made = blend_file.Made("wall", part("core.parameters").Parameters())
    blend_file.write(*far, str(tmp_path / "r.blend"), made, fitted=shifts.moved_fitted(fitted, UTM))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "r.blend"))
    (root,) = bpy.context.scene.collection.children
    shift = part("fcn_addon.scene.origin").of(root)
    (strong,) = (o for o in root.all_objects if o.get("occurrence") == -1 and "support" in o)
    (spline,) = strong.data.splines
    assert spline.type == "BEZIER"
    ends = [strong.matrix_world @ spline.bezier_points[i].co for i in (0, -1)]
    assert np.array(ends) + shift - UTM == pytest.approx(completion.strong[0].points[[0, -1]], abs=2e-3)


def test_shifts_are_rounded_and_only_where_they_must_be(part):
    shift_for = part("fcn_addon.shifts").shift_for
    box = np.array([[0, 0, 0], [14, 3, 8.0]])
    assert not shift_for(box).any() and not shift_for(box + [40, 0, 0]).any()
    assert shift_for(box + UTM).tolist() == [450130, 5411990, 220]
    assert shift_for(1000 * (box + UTM)).tolist() == [450130e3, 5411990e3, 220e3]  # the same in millimetres
    assert not shift_for(np.zeros((0, 3))).any() and not shift_for(np.full((3, 3), 7.0)).any()


def test_transformations_are_those_of_the_moved_curves(part, completion):
    """A motion that takes a curve onto another does so after the move."""
    moved = part("fcn_addon.shifts").moved_completion
    turn = np.array([[0, -1, 0, 3], [1, 0, 0, 4], [0, 0, 1, 5], [0, 0, 0, 1.0]])
    single = dataclasses.replace(completion.transformations[0], kind="single", generators=turn[None])
    (after,) = moved(dataclasses.replace(completion, transformations=(single,)), np.array(UTM)).transformations
    point = np.array([7.0, 8, 9, 1])
    there = np.r_[point[:3] + UTM, 1]
    assert np.allclose((after.generators[0] @ there)[:3] - UTM, (turn @ point)[:3], atol=1e-6)


def test_the_origin_of_blendergis_is_respected(bpy, part, completion, curves, wall, work, tmp_path):
    origin, blend_file = part("fcn_addon.scene.origin"), part("fcn_addon.command.blend_file")
    scene = bpy.context.scene
    scene["crs x"], scene["crs y"] = UTM[:2]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"), copy=True)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert np.allclose(origin.of(scene.fcn.result), [*UTM[:2], 0], rtol=1e-15)
    (reading,), _, shift = blend_file.read(str(tmp_path / "a.blend"))
    assert np.allclose(reading.curves.points - shift, curves.points, atol=1e-5) and np.allclose(shift, [*UTM[:2], 0])
    # The result lies where the artist's curves lie.
    made = blend_file.Made("wall", part("core.parameters").Parameters())
    at_home = part("fcn_addon.shifts").moved_completion(completion, shift)
    blend_file.write(at_home, reading.curves, str(tmp_path / "r.blend"), made, shift)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "r.blend"))
    assert distance(world(bpy), computed(completion)) < 1e-4
    assert np.allclose(origin.of(bpy.context.scene), shift, rtol=1e-15)


def test_detected_curves_keep_their_shift(bpy, part, bumps, tmp_path):
    scans, blend_file = part("fcn_addon.scans"), part("fcn_addon.command.blend_file")
    points, triangles = bumps(rows=1)
    parameters = part("core.detection.parameters").DetectionParameters()
    kinds = {"ridges": True, "valleys": True, "sharp": False, "boundary": False}
    found = scans.detect(scans.Scan("far", points + UTM, triangles), parameters, kinds)
    blend_file.write_detected([found], str(tmp_path / "r.blend"), "far")
    (reading,), _, shift = blend_file.read(str(tmp_path / "r.blend"))
    assert shift.any()
    truth = found.found.curves.points - UTM
    assert distance(reading.curves.points - UTM, truth) < 1e-6 * np.ptp(truth, axis=0).max()
