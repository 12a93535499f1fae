# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves into the scene and out of it, and the example."""

import csv

import numpy as np
import pytest


def test_ridge_lines_come_in_by_the_file_menu(bpy, tmp_path):
    path = tmp_path / "ridges.txt"
    path.write_text("3 2.0 0.5 0 0 0 1 0 0 2 0 1\n2 1.0 0.5 5 0 0 6 0 0\n")
    assert bpy.ops.fcn.import_curves(filepath=str(path)) == {"FINISHED"}
    item = bpy.context.active_object
    assert (item.name, len(item.data.vertices), len(item.data.edges)) == ("ridges", 5, 3)
    assert "curvature" in item.data.attributes and item.select_get()
    world = np.array([item.matrix_world @ v.co for v in item.data.vertices])
    assert world.max(axis=0) == pytest.approx([6, 0, 1])


def test_a_file_that_is_none_is_refused(bpy, tmp_path):
    path = tmp_path / "bad.txt"
    path.write_text("hello")
    with pytest.raises(RuntimeError, match="bad.txt"):
        bpy.ops.fcn.import_curves(filepath=str(path))
    assert not bpy.data.objects


def test_every_curve_goes_out_as_one_polyline(bpy, made, tmp_path, part):
    path = tmp_path / "out.obj"
    assert bpy.ops.fcn.export_curves(filepath=str(path), form="OBJ") == {"FINISHED"}
    lines = [line.split()[1:] for line in path.read_text().splitlines() if line.startswith("l ")]
    assert len(lines) == 13
    assert sorted({len(line) for line in lines}) == [9]
    assert sum(line[0] == line[-1] for line in lines) == 6
    reading = part("core.files.formats").read_curves([path])
    assert len(reading.curves) == 13


def test_poses_go_out_as_a_table(bpy, made, tmp_path, completion):
    path = tmp_path / "out.csv"
    assert bpy.ops.fcn.export_curves(filepath=str(path), form="CSV") == {"FINISHED"}
    with open(path, newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["template"] for row in table] == ["Template A"] * 6
    for row in table:
        motion = completion.templates[0].occurrences[int(row["occurrence"]) - 1]
        found = np.array([[float(row[f"m{i}{j}"]) for j in range(1, 4)] for i in range(1, 4)])
        assert found == pytest.approx(motion[:3, :3], abs=1e-5)


def test_nothing_is_written_where_nothing_is_visible(bpy, made, tmp_path):
    made.fcn_result.view = "INPUT"
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="no completed curve is visible"):
        bpy.ops.fcn.export_curves(filepath=str(tmp_path / "out.obj"))
    assert not (tmp_path / "out.obj").exists()


def test_the_example_is_the_same_every_time_and_can_be_run(bpy, part):
    found = []
    for _ in range(2):
        assert bpy.ops.fcn.try_example() == {"FINISHED"}
        curves = bpy.context.active_object
        found.append([tuple(v.co) for v in curves.data.vertices])
        assert len(bpy.context.selected_objects) == 1
    assert found[0] == found[1] and len(found[0]) > 1000
    assert curves["edge_length"] == pytest.approx(0.05)
    task = part("fcn_addon.job.completing").take(bpy.context)
    assert task.edge_length == pytest.approx(0.05) and len(task.reading.curves) > 30
    scan = bpy.data.objects["Example Scan"]
    assert len(scan.data.polygons) > 10_000


def test_a_shifted_scene_meets_files_at_world_coordinates(bpy, made, part, tmp_path):
    shift, origin = np.array([4.5e5, 5.4e6, 100.0]), part("fcn_addon.scene.origin")
    bpy.ops.fcn.export_curves(filepath=str(tmp_path / "near.obj"), form="OBJ")
    origin.keep(made, shift)
    origin.keep(bpy.context.scene, shift)
    bpy.ops.fcn.export_curves(filepath=str(tmp_path / "far.obj"), form="OBJ")
    bpy.ops.fcn.export_curves(filepath=str(tmp_path / "far.csv"), form="CSV")
    read = part("core.files.formats").read_lines
    near, far = (read(tmp_path / name).curves.points for name in ("near.obj", "far.obj"))
    assert np.allclose(far - shift, near, rtol=0, atol=1e-6)
    with open(tmp_path / "far.csv", newline="") as file:
        assert min(float(row["y"]) for row in csv.DictReader(file)) > 5.3e6
    assert bpy.ops.fcn.import_curves(filepath=str(tmp_path / "far.obj")) == {"FINISHED"}
    assert np.abs(bpy.context.active_object.location).max() < 1000
