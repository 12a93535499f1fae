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


@pytest.fixture
def drawn(bpy, wall, work):
    """A result whose curves have handles: arches and circles."""
    bpy.context.scene.fcn.form = "HANDLES"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.scene.fcn.result


def export(bpy, path):
    assert bpy.ops.fcn.export_curves(filepath=str(path), form=path.suffix[1:].upper()) == {"FINISHED"}
    return path


def test_a_drawing_has_a_block_for_each_template_with_arcs_as_arcs(bpy, drawn, completion, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.readfile(export(bpy, tmp_path / "out.dxf"))
    assert document.units == 6
    block = document.blocks.get("Template A")
    assert sorted(e.dxftype() for e in block) == ["ARC", "CIRCLE"]
    (circle,) = block.query("CIRCLE")
    assert circle.dxf.radius == pytest.approx(0.25, abs=1e-3)
    space = document.modelspace()
    assert len(space.query("INSERT")) == 6 and {e.dxf.layer for e in space.query("INSERT")} == {"template"}
    assert [e.dxftype() for e in space if e.dxf.layer == "strong"] == ["ARC"]
    # Where the curves end up: the ends of all arches.
    ends = np.array([[*p] for insert in space.query("INSERT") for arc in insert.virtual_entities()
                     if arc.dxftype() == "ARC" for p in (arc.start_point, arc.end_point)])  # fmt: skip
    arch = completion.templates[0].curves[0].points[[0, -1]]
    wanted = np.concatenate([arch @ m[:3, :3].T + m[:3, 3] for m in completion.templates[0].occurrences])
    gap = np.linalg.norm(ends[:, None] - wanted[None], axis=2)
    assert gap.min(axis=0).max() < 2e-3 and gap.min(axis=1).max() < 2e-3


def test_what_is_unique_moved_or_scaled_is_drawn_as_it_is(bpy, drawn, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    holders = sorted((o for o in drawn.all_objects if o.type == "EMPTY"), key=lambda o: o["occurrence"])
    part = next(o for o in holders[0].children if len(o.data.splines[0].bezier_points) == 4)
    part.data = part.data.copy()
    part.data.splines[0].bezier_points[0].co.x += 0.1
    holders[1].location.x += 0.5
    holders[2].scale = (2, 1, 1)
    bpy.context.view_layer.update()
    document = ezdxf.readfile(export(bpy, tmp_path / "out.dxf"))
    space = document.modelspace()
    places = {name: len(space.query(f'INSERT[name=="{name}"]')) for name in ("Template A", "Template A 2")}
    assert sorted(places.values()) == [1, 4]
    loose = [e for e in space if e.dxf.layer == "template" and e.dxftype() != "INSERT"]
    assert loose and not {e.dxftype() for e in loose} & {"ARC", "CIRCLE"}, "a circle of twice the width is none"
    points = np.array([p for e in loose if e.dxftype() == "SPLINE" for p in e.control_points])
    middle = np.array(holders[2].matrix_world.translation)
    assert np.abs(points[:, 0] - middle[0]).max() == pytest.approx(2, abs=0.02)


def test_a_picture_has_a_symbol_with_its_uses(bpy, drawn, tmp_path):
    text = export(bpy, tmp_path / "out.svg").read_text()
    assert text.count("<use ") == 6 and 'id="Template A"' in text and text.count("C") >= 4


def test_an_edge_mesh_goes_out_as_chains_whatever_its_points_are_numbered(bpy, wall, work, part, tmp_path):
    bpy.context.scene.fcn.form = "MESH"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    bpy.context.view_layer.update()
    item = next(o for o in bpy.context.scene.fcn.result.all_objects if o.get("occurrence") == -1 and o.type == "MESH")
    points = [tuple(v.co) for v in item.data.vertices]
    order = [3, 0, 5, 1, 8, 2, 7, 4, 6]  # where each point is put
    edges = [(order[i], order[i + 1]) for i in range(8)]
    item.data.clear_geometry()
    item.data.from_pydata([points[order.index(i)] for i in range(9)], edges, [])
    reading = part("core.files.formats").read_curves([export(bpy, tmp_path / "out.obj")])
    assert len(reading.curves) == 13
    found = reading.curves.curve(12) - np.array(item.matrix_world.translation)
    found = found if np.linalg.norm(found[0] - points[0]) < 0.1 else found[::-1]
    assert found == pytest.approx(np.array(points), abs=1e-5)


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


@pytest.mark.parametrize("system, scale, code", [("METRIC", 1.0, 6), ("METRIC", 0.001, 4), ("IMPERIAL", 0.3048, 2),
                                                 ("NONE", 1.0, 0), ("METRIC", 0.7, 0)])  # fmt: skip
def test_a_drawing_says_the_unit_of_the_scene(bpy, drawn, tmp_path, system, scale, code):
    ezdxf = pytest.importorskip("ezdxf")
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length = system, scale
    assert ezdxf.readfile(export(bpy, tmp_path / "out.dxf")).units == code
