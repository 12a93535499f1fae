# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user may stumble over: what is hidden, linked files, other scenes, objects deleted by hand, attributes."""

import numpy as np
import pytest


def parts(root):
    return [o for o in root.all_objects if "support" in o]


def select(bpy, *objects):
    for item in bpy.context.selected_objects:
        item.select_set(False)
    for item in objects:
        item.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]


def of(root, i):
    """The curves of an occurrence."""
    return [o for o in parts(root) if o["occurrence"] == i]


def into_collection(bpy, item, name="Walls"):
    """Move an object into a collection of its own, which is the source from now on."""
    home = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(home)
    home.objects.link(item)
    bpy.context.scene.collection.objects.unlink(item)
    settings = bpy.context.scene.fcn
    settings.source, settings.collection = "COLLECTION", home
    return home


@pytest.mark.parametrize("how", ["excluded", "eye of the object", "object", "eye of the collection", "collection"])
def test_a_source_that_is_hidden_is_evaluated_all_the_same(bpy, part, wall, work, how):
    home = into_collection(bpy, wall)
    layer = bpy.context.view_layer.layer_collection.children[home.name]
    wall.modifiers.new("Array", "ARRAY").count = 3
    if how == "eye of the object":
        wall.hide_set(True)
    elif how == "object":
        wall.hide_viewport = True
    elif how == "collection":
        home.hide_viewport = True
    elif how == "excluded":
        layer.exclude = True
    else:
        layer.hide_viewport = True
    bpy.context.view_layer.update()

    def state():
        hidden = wall.name in bpy.context.view_layer.objects and wall.hide_get()
        flags = wall.hide_viewport, home.hide_viewport, layer.exclude, layer.hide_viewport
        return hidden, flags, len(bpy.data.collections), [c.name for c in wall.users_collection]

    before = state()
    assert part("fcn_addon.job.completing").take(bpy.context).reading.count == 12
    assert state() == before
    wall.modifiers.clear()
    assert bpy.ops.fcn.complete() == {"FINISHED"}


def test_results_in_the_source_collection_are_not_taken(bpy, part, wall, work):
    home = into_collection(bpy, wall)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    root = bpy.context.scene.fcn.result
    bpy.context.scene.collection.children.unlink(root)
    home.children.link(root)
    assert [s.name for s in part("fcn_addon.job.completing").take(bpy.context).sources] == ["Wall"]
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert [r.name for r in part("fcn_addon.result.stored").of_scene(bpy.context.scene)] == ["FCN Walls"]


@pytest.mark.parametrize("kind", ["nothing", "CAMERA", "LIGHT", "EMPTY", "FONT", "META", "ARMATURE", "scan"])
def test_other_selections_are_refused_in_words(bpy, wall, kind):
    wall.select_set(False)
    bpy.context.view_layer.objects.active = None
    if kind == "scan":
        bpy.ops.mesh.primitive_cube_add()
    elif kind == "META":
        bpy.ops.object.metaball_add()
    elif kind == "FONT":
        bpy.ops.object.text_add()
    elif kind != "nothing":
        bpy.ops.object.add(type=kind)
    with pytest.raises(RuntimeError, match="Select curves or edge meshes"):
        bpy.ops.fcn.complete()
    if kind != "scan":
        with pytest.raises(RuntimeError, match="Select one mesh with faces"):
            bpy.ops.fcn.detect()


def test_it_says_why_not_in_edit_mode(bpy, made):
    bpy.context.view_layer.update()
    select(bpy, *of(made, 0))
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("apply", "complete", "delete_occurrence", "make_unique", "remove_result", "select_occurrence"):
        with pytest.raises(RuntimeError, match="Leave the edit mode first"):
            getattr(bpy.ops.fcn, name)()
    made.fcn_result.support = 0.5
    made.fcn_result.view = "COMPONENTS"
    bpy.ops.object.mode_set(mode="OBJECT")


def library(bpy, tmp_path, name):
    """Save the file, and begin an empty one that links a collection of it."""
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.collections = [name]
    (linked,) = wanted.collections
    bpy.context.scene.collection.children.link(linked)
    bpy.context.view_layer.update()
    return linked


def test_curves_of_a_linked_file(bpy, wall, work, tmp_path):
    into_collection(bpy, wall)
    item = library(bpy, tmp_path, "Walls").objects[0]
    assert item.library is not None
    select(bpy, item)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert item.hide_get()
    assert bpy.ops.fcn.remove_result() == {"FINISHED"}
    assert not item.hide_get()


def test_a_result_of_a_linked_file_is_seen_and_not_changed(bpy, part, made, tmp_path):
    linked = library(bpy, tmp_path, made.name)
    assert linked.fcn_result.is_result
    assert part("fcn_addon.result.stored").active(bpy.context.scene) is None
    assert len(part("fcn_addon.result.strokes").collect(bpy.context)[0]) == 6 * (8 + 8) + 8
    select(bpy, *of(linked, 0))
    for name in ("remove_result", "reject_transformation", "restore", "apply"):
        with pytest.raises(RuntimeError, match="complete curves first"):
            getattr(bpy.ops.fcn, name)()
    for name in ("reject_occurrence", "make_unique", "delete_occurrence"):
        with pytest.raises(RuntimeError, match="Select a curve of an occurrence"):
            getattr(bpy.ops.fcn, name)()


def test_two_scenes_have_results_of_their_own(bpy, part, made):
    first, other = bpy.context.scene, bpy.data.scenes.new("Other")
    bpy.context.window.scene = other
    results = part("fcn_addon.result.stored")
    assert results.active(other) is None and not bpy.ops.fcn.apply.poll()
    mesh = bpy.data.meshes.new("Gate")
    mesh.from_pydata([v.co[:] for v in bpy.data.meshes["Wall"].vertices], [e.vertices[:] for e in
                     bpy.data.meshes["Wall"].edges], [])  # fmt: skip
    gate = bpy.data.objects.new("Gate", mesh)
    other.collection.objects.link(gate)
    select(bpy, gate)
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert (results.active(first).name, results.active(other).name) == ("FCN Wall", "FCN Gate")
    bpy.context.window.scene = first
    assert bpy.ops.fcn.remove_result() == {"FINISHED"}
    assert results.active(first) is None and results.active(other).name == "FCN Gate"


def test_the_next_result_is_chosen_where_one_is_removed(bpy, made):
    settings = bpy.context.scene.fcn
    settings.earlier = "KEEP"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert settings.result != made
    bpy.ops.fcn.remove_result()
    assert settings.result == made
    bpy.ops.fcn.remove_result()
    assert settings.result is None


def places(objects):
    return np.array([np.array(o.matrix_world) for o in objects])


def test_curves_stay_in_their_place_without_their_empty(bpy, made):
    bpy.context.view_layer.update()
    objects = of(made, 5)
    before = places(objects)
    assert not np.allclose(before[0], np.eye(4))
    bpy.data.objects.remove(objects[0].parent)
    bpy.context.view_layer.update()
    assert np.allclose(places(objects), before, atol=1e-5)
    select(bpy, objects[0])
    assert bpy.ops.fcn.reject_occurrence() == {"FINISHED"}
    bpy.ops.fcn.restore()
    assert objects[0].visible_get()


def test_an_empty_moves_its_curves(bpy, made):
    bpy.context.view_layer.update()
    objects, others = of(made, 5), of(made, 0)
    before, elsewhere = places(objects), places(others)
    objects[0].parent.location.y += 3
    bpy.context.view_layer.update()
    before[:, 1, 3] += 3
    assert np.allclose(places(objects), before, atol=1e-5) and np.allclose(places(others), elsewhere)


def test_a_whole_occurrence_is_selected(bpy, made):
    bpy.context.view_layer.update()
    objects = of(made, 2)
    select(bpy, objects[1])
    assert bpy.ops.fcn.select_occurrence() == {"FINISHED"}
    assert set(bpy.context.selected_objects) == {*objects, objects[0].parent}
    assert bpy.context.active_object == objects[0].parent


def test_an_occurrence_is_deleted_whole_and_comes_back_with_undo(bpy, made):
    bpy.ops.ed.undo_push(message="before")
    objects = of(made, 2)
    names = {o.name for o in (*objects, objects[0].parent)}
    select(bpy, objects[1])
    curves = len(bpy.data.curves)
    assert bpy.ops.fcn.delete_occurrence("EXEC_DEFAULT", True) == {"FINISHED"}
    root = bpy.context.scene.fcn.result
    assert not names & set(bpy.data.objects.keys()) and len(bpy.data.curves) == curves
    assert len(parts(root)) == 11
    root.fcn_result.support = 0.5
    root.fcn_result.view = "COMPONENTS"
    bpy.ops.ed.undo()
    assert names <= set(bpy.data.objects.keys())


def test_a_result_that_lost_all_its_objects_can_be_worked_with(bpy, part, made):
    bpy.data.batch_remove(list(made.all_objects))
    for view in ("COMPONENTS", "INPUT", "TEMPLATES", "RESULT"):
        made.fcn_result.view = view
    made.fcn_result.support = 0.4
    assert bpy.ops.fcn.select_transformation(index=0) == {"FINISHED"}
    assert bpy.ops.fcn.reject_transformation() == {"FINISHED"}
    assert bpy.ops.fcn.restore() == {"FINISHED"}
    with pytest.raises(RuntimeError, match="no completed curve is visible"):
        bpy.ops.fcn.apply()
    assert len(part("fcn_addon.result.strokes").collect(bpy.context)[0]) == 0
    assert bpy.ops.fcn.remove_result() == {"FINISHED"}
    assert not bpy.data.objects["Wall"].hide_get()


LABELS = ("support", "component", "template", "occurrence")


def stored(bpy, objects):
    """The attributes that geometry nodes see: of all objects of a collection, read by a node group that joins them."""
    home = bpy.data.collections.new("Asked")
    bpy.context.scene.collection.children.link(home)
    for item in objects:
        home.objects.link(item)
    nodes = bpy.data.node_groups.new("Ask", "GeometryNodeTree")
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    info, realize = nodes.nodes.new("GeometryNodeCollectionInfo"), nodes.nodes.new("GeometryNodeRealizeInstances")
    mesh, out = nodes.nodes.new("GeometryNodeCurveToMesh"), nodes.nodes.new("NodeGroupOutput")
    info.inputs["Collection"].default_value = home
    nodes.links.new(info.outputs[0], realize.inputs[0])
    nodes.links.new(realize.outputs[0], mesh.inputs[0])
    nodes.links.new(mesh.outputs[0], out.inputs[0])
    asker = bpy.data.objects.new("Ask", bpy.data.meshes.new("Ask"))
    bpy.context.scene.collection.objects.link(asker)
    asker.modifiers.new("Ask", "NODES").node_group = nodes
    bpy.context.view_layer.update()
    data = asker.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found = {n: [round(a.value, 5) for a in data.attributes[n].data] for n in LABELS if n in data.attributes}
    return len(data.vertices), found


def test_geometry_nodes_see_support_and_labels(bpy, made):
    bpy.context.view_layer.update()
    objects = parts(made)
    before = {o.name: o.matrix_world.copy() for o in objects}
    made.fcn_result.attributes = True
    bpy.context.view_layer.update()
    size, found = stored(bpy, objects)
    assert size == sum(len(o.data.splines[0].points) for o in objects)
    for name in LABELS:
        kept = sorted(round(float(o[name]), 5) for o in objects for _ in o.data.splines[0].points)
        assert np.allclose(sorted(found[name]), kept, atol=1e-4), name
    assert {o.name: o.matrix_world for o in objects} == before
    made.fcn_result.attributes = True  # again: nothing twice
    assert {len(o.modifiers) for o in objects} == {1} and len(bpy.data.node_groups) == 2
    assert bpy.ops.fcn.apply(kind="MESH") == {"FINISHED"}
    assert len(bpy.context.active_object.data.vertices) == size
    made.fcn_result.attributes = False
    assert {len(o.modifiers) for o in objects} == {0} and len(bpy.data.node_groups) == 1
