# SPDX-License-Identifier: GPL-3.0-or-later
"""The buttons on scenes as artists make them: instances, hidden objects, loose edges, surfaces of modifiers."""

import numpy as np
import pytest


def home(bpy, name="Walls"):
    made = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(made)
    return made


def choose(bpy, *objects):
    for item in bpy.context.selected_objects:
        item.select_set(False)
    for item in objects:
        item.select_set(True)
    bpy.context.view_layer.objects.active = objects[0] if objects else None
    bpy.context.view_layer.update()


@pytest.fixture
def instances(bpy, wall):
    """Two empties that instance a collection with the wall, which is shown nowhere else; selected."""
    source = bpy.data.collections.new("Source")
    source.objects.link(wall)
    bpy.context.scene.collection.objects.unlink(wall)
    made = []
    for x in (0, 50):
        item = bpy.data.objects.new("Instance", None)
        item.instance_type, item.instance_collection, item.location.x = "COLLECTION", source, x
        bpy.context.scene.collection.objects.link(item)
        made.append(item)
    choose(bpy, *made)
    return made


def test_instances_are_curves_like_others(bpy, part, instances, work):
    task = part("fcn_addon.job.completing").take(bpy.context)
    assert task.reading.count == 8 and [s.name for s in task.sources] == ["Instance", "Instance.001"]
    choose(bpy, instances[1])
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert [item.hide_get() for item in instances] == [False, True]


def test_hidden_objects_of_a_collection_are_left_out_and_counted(bpy, part, wall, work):
    walls = home(bpy)
    walls.objects.link(wall)
    other = wall.copy()
    other.name = "Rejected"
    walls.objects.link(other)
    bpy.context.view_layer.update()
    other.hide_set(True)
    settings = bpy.context.scene.fcn
    settings.source, settings.collection = "COLLECTION", walls
    summary = part("fcn_addon.job.summary")
    found = summary.compute(bpy.context)
    assert (found.curves, found.left_out) == (4, "1 hidden")
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert settings.result.fcn_result.left_out == "1 hidden"
    # What the run has hidden is taken again, what the user has hidden is not.
    assert wall.hide_get() and part("fcn_addon.job.completing").take(bpy.context).reading.count == 4
    settings.use_hidden = True
    assert summary.compute(bpy.context).curves == 8
    assert part("fcn_addon.job.completing").take(bpy.context).reading.count == 8


def test_loose_edges_beside_faces_on_request(bpy, part, wall, work):
    mesh = wall.data
    first = len(mesh.vertices)
    mesh.vertices.add(3)
    mesh.vertices.foreach_set("co", np.r_[[0.0] * 3 * first, 0, 0, 9, 1, 0, 9, 0, 1, 9].astype(np.float32))
    mesh.loops.add(3)
    mesh.loops.foreach_set("vertex_index", [first, first + 1, first + 2])
    mesh.polygons.add(1)
    mesh.polygons.foreach_set("loop_start", [0])
    mesh.update(calc_edges=True, calc_edges_loose=True)
    for i, vertex in enumerate(mesh.vertices):
        vertex.co.x += 0.1 * i
    choose(bpy, wall)
    with pytest.raises(RuntimeError, match="Select curves or edge meshes"):
        bpy.ops.fcn.complete()
    bpy.context.scene.fcn.take_edges = True
    task = part("fcn_addon.job.completing").take(bpy.context)
    assert task.reading.count == 4 and task.left_out.words() == "1 faces beside loose edges"


def test_text_beside_curves_is_named_and_text_alone_refused(bpy, part, wall, work):
    text = bpy.data.objects.new("Title", bpy.data.curves.new("Title", "FONT"))
    text.data.body = "Hi"
    bpy.context.scene.collection.objects.link(text)
    choose(bpy, wall, text)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert bpy.context.scene.fcn.result.fcn_result.left_out == "1 text"
    choose(bpy, text)
    bpy.ops.fcn.remove_result()
    with pytest.raises(RuntimeError, match="Select curves or edge meshes"):
        bpy.ops.fcn.complete()


def test_a_scan_that_only_a_modifier_makes_can_be_detected(bpy, part):
    profile = [(0, 0.3 * np.sin(6 * t), t) for t in np.linspace(0, 3, 31)]
    mesh = bpy.data.meshes.new("Profile")
    mesh.from_pydata(profile, [(i, i + 1) for i in range(30)], [])
    item = bpy.data.objects.new("Cornice", mesh)
    bpy.context.scene.collection.objects.link(item)
    screw = item.modifiers.new("Screw", "SCREW")
    screw.angle, screw.screw_offset, screw.axis, screw.steps = 0, 5, "X", 50
    choose(bpy, item)
    assert part("fcn_addon.job.detecting").scan_of(bpy.context) == item
    assert bpy.ops.fcn.detect() == {"FINISHED"}
    assert bpy.context.active_object.fcn_curves.total >= 2


def test_instances_of_a_scan_can_be_detected_and_a_copy_of_them(bpy, part, bumps):
    points, triangles = bumps(rows=1)
    mesh = bpy.data.meshes.new("Bay")
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    source = bpy.data.collections.new("Source")
    source.objects.link(bpy.data.objects.new("Bay", mesh))
    item = bpy.data.objects.new("Instance", None)
    item.instance_type, item.instance_collection, item.location.x = "COLLECTION", source, 100
    bpy.context.scene.collection.objects.link(item)
    choose(bpy, item)
    read = part("fcn_addon.reading.working_copy").read
    all_points, all_triangles = read(item, bpy.context)
    few_points, few = read(item, bpy.context, len(triangles) // 2)
    assert len(all_triangles) == len(triangles) and abs(len(few) - len(triangles) // 2) < 20
    assert all_points[:, 0].min() == pytest.approx(100) and few_points[:, 0].min() == pytest.approx(100, abs=0.5)
    assert bpy.ops.fcn.detect() == {"FINISHED"}
    assert bpy.context.active_object.location.x > 100


def test_counting_touches_nothing(bpy, part, wall):
    """Hair curves and geometry nodes are drawn in a scene of their own for a run, not for the numbers in the panel."""
    wall.hide_set(True)
    settings = bpy.context.scene.fcn
    walls = home(bpy)
    walls.objects.link(wall)
    settings.source, settings.collection, settings.use_hidden = "COLLECTION", walls, True
    updates = []
    bpy.app.handlers.depsgraph_update_post.append(lambda scene, graph: updates.append(scene.name))
    try:
        bpy.context.view_layer.update()
        updates.clear()
        assert part("fcn_addon.job.summary").compute(bpy.context).curves == 4
        assert not updates and wall.hide_get()
    finally:
        bpy.app.handlers.depsgraph_update_post.pop()


def test_what_is_missing_of_a_library_is_named(bpy, wall, tmp_path):
    source = bpy.data.collections.new("Source")
    source.objects.link(wall)
    bpy.context.scene.collection.children.link(source)
    library, path = tmp_path / "library.blend", tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(library), copy=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.collections = ["Source"]
    item = bpy.data.objects.new("Instance", None)
    item.instance_type, item.instance_collection = "COLLECTION", bpy.data.collections["Source"]
    bpy.context.scene.collection.objects.link(item)
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    choose(bpy, bpy.data.objects["Instance"])
    for run in (bpy.ops.fcn.complete, bpy.ops.fcn.detect):
        with pytest.raises(RuntimeError, match="'Source' of the library '.*library.blend' is missing"):
            run()


def test_an_image_that_shapes_a_scan_and_is_missing_is_named(bpy, part, bumps, tmp_path):
    points, triangles = bumps(rows=1)
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], triangles.tolist())
    for name in ("Scan", "Plain"):
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    texture = bpy.data.textures.new("Height", "IMAGE")
    texture.image = bpy.data.images.new("Height", 4, 4)
    texture.image.source, texture.image.filepath = "FILE", str(tmp_path / "gone.png")
    bpy.data.objects["Scan"].modifiers.new("Displace", "DISPLACE").texture = texture
    choose(bpy, bpy.data.objects["Scan"])
    with pytest.raises(RuntimeError, match="the image '.*gone.png', which a modifier uses, is missing"):
        bpy.ops.fcn.detect()
    choose(bpy, bpy.data.objects["Plain"])
    assert bpy.ops.fcn.detect() == {"FINISHED"}
