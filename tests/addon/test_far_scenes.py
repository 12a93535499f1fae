# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with world coordinates: a result stands exactly where the artist's objects are, and goes out as exactly."""

import numpy as np
import pytest

UTM = np.array([450123.0, 5411987.5, 212.25])  # single precision holds it, as it does the place of any object


def shown(bpy, root):
    """(n, 3) float64, the completed points where Blender's matrices and data put them."""
    bpy.context.view_layer.update()
    found = []
    for item in root.all_objects:
        if "support" in item:
            matrix = np.array(item.matrix_world, float)
            if item.type == "MESH":
                points = np.array([v.co for v in item.data.vertices], float)
            else:
                points = np.array([p.co[:3] for spline in item.data.splines for p in spline.points], float)
            found.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)


def distance(a, b):
    """The largest distance of a point of a from the nearest of b."""
    return max(np.linalg.norm(b - p, axis=1).min() for p in a)


def computed(completion):
    parts = [c.points @ m[:3, :3].T + m[:3, 3] for t in completion.templates for m in t.occurrences for c in t.curves]
    return np.concatenate([*parts, *(c.points for c in completion.strong)])


@pytest.fixture
def far(bpy, part, wall, completion, monkeypatch):
    """The result of the button on a wall at UTM coordinates, and where its points belong, about that place."""

    def make(form="DENSE"):
        wall.location = UTM
        bpy.context.view_layer.update()
        bpy.context.scene.fcn.form = form
        moved = part("fcn_addon.shifts").moved_completion(completion, UTM)
        monkeypatch.setattr(part("fcn_addon.job.completing"), "_work", lambda task, report: moved)
        assert bpy.ops.fcn.complete() == {"FINISHED"}
        bpy.context.view_layer.update()
        return bpy.context.scene.fcn.result, computed(completion)

    return make


@pytest.mark.parametrize("form", ["DENSE", "MESH"])
def test_all_of_a_result_stands_where_the_wall_is(bpy, far, wall, form):
    root, truth = far(form)
    assert root["fcn_step"] == 0.5
    found = shown(bpy, root) - UTM
    assert distance(found, truth) < 1e-5 and distance(truth, found) < 1e-5
    copy = next(o for o in root.all_objects if o.name.startswith("Input"))
    matrix = np.array(copy.matrix_world, float)
    points = np.array([v.co for v in copy.data.vertices], float) @ matrix[:3, :3].T + matrix[:3, 3] - UTM
    own = np.array([v.co for v in wall.data.vertices], float)
    assert distance(own, points) < 1e-5


def test_near_the_origin_occurrences_share_their_curves(bpy, made):
    parts = [o for o in made.all_objects if o.get("occurrence", -1) >= 0 and "support" in o]
    assert len({o.data for o in parts}) == 2 and "fcn_offset" not in parts[0].parent


def test_it_goes_out_exactly_in_every_form(bpy, far, part, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    _, truth = far()
    files = {form: str(tmp_path / f"a.{form.lower()}") for form in ("OBJ", "DXF", "CSV")}
    for form, path in files.items():
        assert bpy.ops.fcn.export_curves(filepath=path, form=form) == {"FINISHED"}
    for form in ("OBJ", "DXF"):
        found = part("core.files.formats").read_lines(files[form]).curves.points - UTM
        assert distance(found, truth) < 1e-5 and distance(truth, found) < 1e-5
    document = ezdxf.readfile(files["DXF"])
    assert len(document.modelspace().query("INSERT")) == 6, "a block for each template, though data are not shared"
    assert len({e.dxf.name for e in document.modelspace().query("INSERT")}) == 1
    rows = open(files["CSV"], encoding="utf-8").read().splitlines()[1:]
    places = np.array([[float(v) for v in row.split(",")[3:6]] for row in rows]) - UTM
    steps = np.diff(np.sort(places[:5, 0]))
    assert np.allclose(steps[steps > 0.1], 1.8, atol=1e-6)


def test_what_was_edited_far_away_is_a_symbol_of_its_own(bpy, far, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    root, _ = far()
    part = next(o for o in root.all_objects if o.get("occurrence") == 2 and "support" in o)
    part.data.splines[0].points[0].co.x += 0.3
    assert bpy.ops.fcn.export_curves(filepath=str(tmp_path / "a.dxf"), form="DXF") == {"FINISHED"}
    names = [e.dxf.name for e in ezdxf.readfile(tmp_path / "a.dxf").modelspace().query("INSERT")]
    assert sorted(names.count(name) for name in set(names)) == [1, 5]


def test_detected_and_imported_curves_stand_where_they_were_computed(bpy, part, bumps, arcs, tmp_path):
    points, triangles = bumps(rows=1)
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    scan = bpy.data.objects.new("Scan", mesh)
    bpy.context.scene.collection.objects.link(scan)
    places = []
    for location in ((0, 0, 0), UTM):
        scan.location = location
        for item in bpy.context.selected_objects:
            item.select_set(False)
        scan.select_set(True)
        bpy.context.view_layer.objects.active = scan
        bpy.context.view_layer.update()
        assert bpy.ops.fcn.detect() == {"FINISHED"}
        item = bpy.context.active_object
        bpy.context.view_layer.update()
        world = np.array([v.co for v in item.data.vertices], float) + np.array(item.matrix_world.translation)
        places.append(world - location)
    assert distance(places[1], places[0]) < 1e-4
    (tmp_path / "far.obj").write_text(arcs(shift=UTM))
    assert bpy.ops.fcn.import_curves(filepath=str(tmp_path / "far.obj")) == {"FINISHED"}
    item = bpy.context.active_object
    bpy.context.view_layer.update()
    world = np.array([v.co for v in item.data.vertices], float) + np.array(item.matrix_world.translation)
    truth = part("core.files.formats").read_lines(tmp_path / "far.obj").curves.points
    assert distance(world - UTM, truth - UTM) < 1e-5


@pytest.mark.parametrize("kind", ["CURVE", "MESH", "CURVES"])
def test_one_object_of_it_stands_there_too(bpy, part, far, kind):
    _, truth = far()
    assert bpy.ops.fcn.apply(kind=kind) == {"FINISHED"}
    bpy.context.view_layer.update()
    item = next(o for o in bpy.context.scene.collection.objects if o.name.endswith("completed"))
    if kind == "CURVES":  # in Blender 4.2 these are Catmull-Rom curves through the same points
        positions = item.data.attributes["position"].data
        points = np.array([p.vector for p in positions], float) + np.array(item.matrix_world.translation)
    else:
        points = (
            part("fcn_addon.reading.reader").read([item], bpy.context.evaluated_depsgraph_get()).reading.curves.points
        )
    assert distance(points - UTM, truth) < 1e-5 and distance(truth, points - UTM) < 1e-5


def test_a_template_is_renamed_with_the_curves_of_each_occurrence(bpy, far):
    root, _ = far()
    root.fcn_result.template_rows[0].name = "Window"
    names = {o.data.name for o in root.all_objects if o.get("occurrence", -1) >= 0 and "support" in o}
    assert names == {f"Window {i} at {k}" for i in (1, 2) for k in range(1, 7)}


def test_in_a_scene_of_blendergis_it_goes_out_with_world_coordinates(bpy, part, wall, work, completion, tmp_path):
    scene = bpy.context.scene
    scene["crs x"], scene["crs y"] = float(UTM[0]), float(UTM[1])
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    bpy.context.view_layer.update()
    assert "fcn_step" not in scene.fcn.result
    truth = computed(completion)
    assert distance(shown(bpy, scene.fcn.result), truth) < 1e-4
    for form in ("OBJ", "DXF"):
        if form == "DXF":
            pytest.importorskip("ezdxf")
        path = str(tmp_path / f"a.{form.lower()}")
        assert bpy.ops.fcn.export_curves(filepath=path, form=form) == {"FINISHED"}
        found = part("core.files.formats").read_lines(path).curves.points - [*UTM[:2], 0]
        assert distance(found, truth) < 1e-4 and distance(truth, found) < 1e-4
