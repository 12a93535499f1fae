# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of templates and of their occurrences."""

import numpy as np
import pytest


def rows(made):
    return made.fcn_result.template_rows


def parts(made, occurrence):
    return [o for o in made.all_objects if o.get("occurrence") == occurrence and "support" in o]


def test_the_rows_say_what_there_is(bpy, made):
    (row,) = rows(made)
    assert (row.name, row.count, row.rejected) == ("Template A", 6, 0)
    assert row.support == pytest.approx(0.5)
    places = made.fcn_result.places
    assert [p.name for p in places] == [f"Template A at {i}" for i in range(1, 7)]
    assert all(p.name in made.all_objects and p.kept for p in places)


def test_rejecting_counts_and_restoring_counts_back(bpy, made):
    made.fcn_result.places[2].kept = False
    assert rows(made)[0].count == 5 and rows(made)[0].rejected == 1
    assert made.fcn_result.transformations[0].count == 5
    assert all(o.hide_viewport for o in parts(made, 2)) and not parts(made, 1)[0].hide_viewport
    assert not made.fcn_result.places[2].kept
    made.fcn_result.places[2].kept = True
    assert rows(made)[0].count == 6 and not any(o.hide_viewport for o in parts(made, 2))
    made.fcn_result.places[0].kept = False
    assert bpy.ops.fcn.restore() == {"FINISHED"}
    assert rows(made)[0].count == 6 and made.fcn_result.places[0].kept


def test_what_is_rejected_or_deleted_in_the_viewport_shows_in_the_list(bpy, made):
    for name, kept in (("reject_occurrence", 6), ("delete_occurrence", 5)):
        part = parts(made, 3)[0]
        part.hide_viewport = False
        bpy.context.view_layer.update()
        part.select_set(True)
        assert getattr(bpy.ops.fcn, name)() == {"FINISHED"}
        assert rows(made)[0].count == 5 and len(made.fcn_result.places) == kept


def test_a_new_name_is_that_of_the_objects_too(bpy, made):
    rows(made)[0].name = "Window"
    assert {o.name for o in parts(made, 0)} == {"Window 1 at 1", "Window 2 at 1"}
    assert {o.data.name for o in parts(made, 0)} == {"Window 1", "Window 2"}
    assert parts(made, 4)[0].parent.name == "Window at 5"


def test_names_are_kept_over_runs(bpy, made, wall):
    rows(made)[0].name = "Window"
    wall.hide_set(False)
    wall.select_set(True)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    root = bpy.context.scene.fcn.result
    assert [row.name for row in rows(root)] == ["Window"]
    assert "Window at 1" in root.all_objects


def test_eye_solo_and_colour(bpy, made):
    row = rows(made)[0]
    row.shown = False
    assert all(o.hide_viewport for o in parts(made, 0))
    row.shown = True
    made.fcn_result.solo = True
    assert not any(o.hide_viewport for o in parts(made, 0))
    made.fcn_result.view = "TEMPLATES"
    row.colour = (0.1, 0.7, 0.3)
    assert tuple(parts(made, 0)[0].color[:3]) == pytest.approx((0.1, 0.7, 0.3))


def test_selecting_all_and_one(bpy, made):
    assert bpy.ops.fcn.select_template(index=0) == {"FINISHED"}
    assert len(bpy.context.selected_objects) == 12
    assert bpy.ops.fcn.select_template(place=4) == {"FINISHED"}
    assert set(bpy.context.selected_objects) == set(parts(made, 4))
    with pytest.raises(RuntimeError, match="6 places"):
        bpy.ops.fcn.select_template(place=6)


def test_the_scan_is_out_of_the_way_while_there_is_a_result(bpy, wall, work, part):
    scan = bpy.data.objects.new("Scan", bpy.data.meshes.new("Scan"))
    scan.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(scan)
    wall.fcn_curves.scan = "Scan"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert scan.hide_select
    result = bpy.context.scene.fcn.result.fcn_result
    result.scan_locked = False
    assert not scan.hide_select
    result.scan_locked = True
    assert scan.hide_select and bpy.ops.fcn.remove_result() == {"FINISHED"}
    assert not scan.hide_select


def test_what_a_result_holds_keeps_the_edge_length_of_the_run(bpy, made, part):
    bpy.context.view_layer.update()
    made.fcn_result.view = "INPUT"
    item = next(o for o in made.all_objects if o.name.startswith("Input"))
    bpy.context.view_layer.update()
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    task = part("fcn_addon.job.completing").take(bpy.context)
    assert task.edge_length == pytest.approx(made.fcn_result.edge_length)


def test_curves_with_handles(bpy, wall, work, completion):
    bpy.context.scene.fcn.form = "HANDLES"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    made = bpy.context.scene.fcn.result
    arch, ring = (next(o for o in parts(made, 0) if o["component"] == c) for c in (0, 1))
    for item, closed in ((arch, False), (ring, True)):
        (spline,) = item.data.splines
        assert spline.type == "BEZIER" and spline.use_cyclic_u == closed
        assert len(spline.bezier_points) < 9
        mesh = item.to_mesh()
        world = np.array([item.matrix_world @ v.co for v in mesh.vertices])
        item.to_mesh_clear()
        curve = completion.templates[0].curves[item["component"]]
        centre, radius = (np.array([100, 0, 0]), 1.0) if not closed else (np.array([100, 0, 1]), 0.25)
        assert np.linalg.norm(world - centre, axis=1) == pytest.approx(radius, abs=0.02)
        assert len(world) > len(curve.points)
    assert bpy.ops.fcn.apply(kind="CURVE") == {"FINISHED"}
    item = bpy.context.active_object
    assert {s.type for s in item.data.splines} == {"BEZIER"}


def test_edge_meshes(bpy, wall, work):
    bpy.context.scene.fcn.form = "MESH"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    made = bpy.context.scene.fcn.result
    arch, ring = (next(o for o in parts(made, 0) if o["component"] == c) for c in (0, 1))
    assert (arch.type, len(arch.data.vertices), len(arch.data.edges)) == ("MESH", 9, 8)
    assert (len(ring.data.vertices), len(ring.data.edges)) == (8, 8)
