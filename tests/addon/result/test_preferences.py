# SPDX-License-Identifier: GPL-3.0-or-later
"""What the preferences say of new results: the collection that they are put into, and what they keep."""

import pytest

ALL = {"INPUT", "COMPONENTS", "NOISE"}


@pytest.fixture
def chosen(part):
    """The preferences, as they were before afterwards."""
    chosen = part("fcn_addon.properties.preferences").of_user()
    assert (chosen.collection, chosen.keep) == ("", ALL)
    yield chosen
    chosen.collection, chosen.keep = "", ALL


@pytest.mark.parametrize("keep", [set(), {"INPUT"}, {"COMPONENTS"}, {"NOISE"}, ALL])
def test_a_run_keeps_what_is_chosen(bpy, part, wall, work, chosen, keep):
    chosen.keep = keep
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    root, views = bpy.context.scene.fcn.result, part("fcn_addon.result.views")
    assert {c["fcn_role"] for c in root.children} == {"templates", "strong", *(key.lower() for key in keep)}
    assert [views.can_show(root, view) for view in ("RESULT", "TEMPLATES", "INPUT", "COMPONENTS")] == [
        True, True, "INPUT" in keep, "COMPONENTS" in keep
    ]  # fmt: skip
    for view in ("INPUT", "COMPONENTS", "TEMPLATES", "RESULT"):
        root.fcn_result.view = view
    assert bpy.ops.fcn.select_template(index=0) == {"FINISHED"} and len(bpy.context.selected_objects) == 12
    if "INPUT" in keep:
        return
    with pytest.raises(RuntimeError, match="was removed"):
        bpy.ops.fcn.select_source()


def test_results_go_into_the_collection_that_is_named(bpy, part, wall, work, chosen):
    chosen.collection, scene = "Drawings", bpy.context.scene
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    home = bpy.data.collections["Drawings"]
    assert [c.name for c in scene.collection.children] == ["Drawings"]
    assert (
        [c.name for c in home.children]
        == ["FCN Wall"]
        == [r.name for r in part("fcn_addon.result.stored").of_scene(scene)]
    )
    scene.fcn.earlier = "KEEP"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert [c.name for c in home.children] == ["FCN Wall", "FCN Wall.001"] and len(scene.collection.children) == 1
    assert bpy.ops.fcn.remove_result() == {"FINISHED"} == bpy.ops.fcn.remove_result()
    assert not home.children and "Drawings" in bpy.data.collections


def test_a_collection_that_is_there_takes_them(bpy, wall, work, chosen):
    outer, inner = bpy.data.collections.new("Outer"), bpy.data.collections.new("Inner")
    bpy.context.scene.collection.children.link(outer)
    outer.children.link(inner)
    chosen.collection = "Inner"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert [c.name for c in inner.children] == ["FCN Wall"] and list(bpy.context.scene.collection.children) == [outer]


def test_one_undo_step_takes_the_collection_back_too(bpy, wall, work, chosen):
    chosen.collection = "Drawings"
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.fcn.complete("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    assert not list(bpy.data.collections) and bpy.context.scene.fcn.result is None


@pytest.mark.parametrize("excluded", [False, True])
def test_detected_curves_go_there_too(bpy, scan, chosen, excluded):
    chosen.collection, home = "Drawings", bpy.data.collections.new("Drawings")
    bpy.context.scene.collection.children.link(home)
    bpy.context.view_layer.layer_collection.children["Drawings"].exclude = excluded
    assert bpy.ops.fcn.detect() == {"FINISHED"}
    assert [o.name for o in home.objects] == ["Scan curves"]
    assert "Scan curves" not in bpy.context.scene.collection.objects
    assert bpy.context.active_object.name == ("Scan" if excluded else "Scan curves")
