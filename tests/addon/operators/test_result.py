# SPDX-License-Identifier: GPL-3.0-or-later
"""Working with a result: rejecting, selecting, editing, and undo of each."""

import numpy as np
import pytest

from tests.addon.operators.looking import occurrence, parts, scene, seen


def test_rejecting_a_transformation_and_back(bpy, made):
    assert bpy.ops.fcn.reject_transformation() == {"FINISHED"}
    assert not made.fcn_result.transformations[0].kept
    shown = seen(bpy, made)
    assert not shown["templates"] and shown["strong"]
    made.fcn_result.view = "COMPONENTS"
    assert not any("at" in name or "curve" in name for name in seen(bpy, made)["components"])
    bpy.ops.fcn.restore()
    made.fcn_result.view = "RESULT"
    assert made.fcn_result.transformations[0].kept
    assert len(seen(bpy, made)["templates"]) == 18


def test_rejecting_single_occurrences(bpy, made):
    objects = occurrence(bpy, made, 2)
    assert bpy.ops.fcn.reject_occurrence() == {"FINISHED"}
    scene(bpy)
    assert not any(o.visible_get() for o in objects) and not objects[0].parent.visible_get()
    assert len(seen(bpy, made)["templates"]) == 15
    made.fcn_result.support = 0.3
    made.fcn_result.support = 0.0
    assert len(seen(bpy, made)["templates"]) == 15
    bpy.ops.fcn.restore()
    assert len(seen(bpy, made)["templates"]) == 18


def test_undo_of_a_rejection(bpy, made):
    bpy.ops.ed.undo_push(message="before")
    occurrence(bpy, made, 2)
    name = made.name
    bpy.ops.fcn.reject_occurrence("EXEC_DEFAULT", True)
    bpy.ops.ed.undo()
    root = bpy.data.collections[name]
    assert not any("rejected" in o for o in root.all_objects)
    assert len(seen(bpy, root)["templates"]) == 18


def state(bpy):
    """All that the buttons of a result change."""
    objects = {
        o.name: (o.data.name if o.data else "", o.hide_viewport, bool(o.get("rejected")), bool(o.get("unique")))
        for o in bpy.data.objects
    }
    roots = {
        c.name: (c.fcn_result.view, [row.kept for row in c.fcn_result.transformations]) for c in bpy.data.collections
    }
    return objects, roots, {len(bpy.data.curves), len(bpy.data.meshes)}


@pytest.mark.parametrize(
    ("operator", "options"),
    [
        ("reject_occurrence", {}),
        ("reject_transformation", {}),
        ("restore", {}),
        ("make_unique", {}),
        ("apply", {"kind": "CURVE"}),
        ("apply", {"kind": "MESH"}),
        ("remove_result", {}),
    ],
)
def test_undo_and_redo_of_each_button(bpy, made, operator, options):
    occurrence(bpy, made, 3)
    if operator == "restore":
        bpy.ops.fcn.reject_transformation()
        occurrence(bpy, made, 3)[0]["rejected"] = True
    bpy.ops.ed.undo_push(message="before")
    before = state(bpy)
    assert getattr(bpy.ops.fcn, operator)("EXEC_DEFAULT", True, **options) == {"FINISHED"}
    after = state(bpy)
    assert after != before
    for _ in range(2):
        bpy.ops.ed.undo()
        assert state(bpy) == before
        bpy.ops.ed.redo()
        assert state(bpy) == after


def test_selecting_a_transformation(bpy, made):
    assert bpy.ops.fcn.select_transformation(index=0) == {"FINISHED"}
    assert set(bpy.context.selected_objects) == {o for o in parts(made) if o["occurrence"] >= 0}
    made.fcn_result.support = 0.5
    scene(bpy)
    bpy.ops.fcn.select_transformation()
    assert {o["support"] >= 0.5 for o in bpy.context.selected_objects} == {True}
    with pytest.raises(RuntimeError, match="no row 9"):
        bpy.ops.fcn.select_transformation(index=9)


def near(made, curves, i, item):
    """Move input curve `i` of the input copy onto a result's curve."""
    mesh = made.children["Input"].objects[0]
    world = np.array(item.matrix_world)
    target = np.array([p.co[:3] for p in item.data.splines[0].points]) @ world[:3, :3].T + world[:3, 3]
    local = target[np.linspace(0, len(target) - 1, curves.offsets[i + 1] - curves.offsets[i]).astype(int)]
    for k, point in zip(range(curves.offsets[i], curves.offsets[i + 1]), local):
        mesh.data.vertices[k].co = point - np.array(mesh.location)


def test_to_the_source_and_back(bpy, made, curves):
    scene(bpy)
    arch, ring = occurrence(bpy, made, 1)
    assert (arch["component"], ring["component"]) == (0, 1)
    near(made, curves, 0, arch)
    assert bpy.ops.fcn.select_source() == {"FINISHED"}
    assert made.fcn_result.view == "INPUT" and bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    mesh = made.children["Input"].objects[0].data
    assert [v.select for v in mesh.vertices] == [True] * 4 + [False] * 14
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.fcn.select_result() == {"FINISHED"}
    assert bpy.context.mode == "OBJECT" and made.fcn_result.view == "RESULT"
    assert bpy.context.selected_objects == [arch]


def test_an_occurrence_that_no_input_shows(bpy, made):
    scene(bpy)
    occurrence(bpy, made, 5)
    assert bpy.ops.fcn.select_source() == {"CANCELLED"}
    assert made.fcn_result.view == "RESULT" and bpy.context.mode == "OBJECT"


def test_the_source_of_a_removed_input(bpy, made):
    occurrence(bpy, made, 0)
    bpy.data.objects.remove(made.children["Input"].objects[0])
    with pytest.raises(RuntimeError, match="was removed"):
        bpy.ops.fcn.select_source()


def test_editing_a_template_moves_all(bpy, made):
    scene(bpy)
    objects = occurrence(bpy, made, 0)
    assert bpy.ops.fcn.edit_template() == {"FINISHED"}
    assert bpy.context.mode == "EDIT_CURVE"
    assert set(bpy.context.objects_in_mode) == set(objects)
    objects[0].data.splines[0].points[0].co[2] += 1
    assert bpy.ops.fcn.edit_template() == {"FINISHED"}
    assert bpy.context.mode == "OBJECT"
    others = [o for o in parts(made) if o.data == objects[0].data]
    assert len(others) == 6
    heights = {round(o.data.splines[0].points[0].co[2], 4) for o in others}
    assert len(heights) == 1


def test_a_unique_occurrence_no_longer_follows(bpy, made):
    objects = occurrence(bpy, made, 4)
    assert bpy.ops.fcn.make_unique() == {"FINISHED"}
    assert all(o.data.users == 1 for o in objects)
    other = next(o for o in parts(made) if o["occurrence"] == 0 and o["component"] == 0)
    before = other.data.splines[0].points[0].co[2]
    objects[0].data.splines[0].points[0].co[2] += 1
    assert other.data.splines[0].points[0].co[2] == before


@pytest.mark.parametrize("operator", ["make_unique", "reject_occurrence", "select_source"])
def test_occurrences_must_be_selected(bpy, made, operator):
    for item in bpy.context.selected_objects:
        item.select_set(False)
    with pytest.raises(RuntimeError, match="Select a curve of an occurrence"):
        getattr(bpy.ops.fcn, operator)()


@pytest.mark.parametrize("operator", ["apply", "restore", "remove_result", "select_transformation"])
def test_there_must_be_a_result(bpy, operator):
    with pytest.raises(RuntimeError, match="complete curves first"):
        getattr(bpy.ops.fcn, operator)()


def test_every_property_and_operator_has_words(bpy, part):
    group = type(bpy.context.scene.fcn.parameters).bl_rna
    detection = type(bpy.context.scene.fcn.detection).bl_rna
    results = part("fcn_addon.result.stored")
    shown = {"kept", "view", "support", "attributes"}  # the rest of a result is not shown as buttons
    for owner in (group, detection, type(bpy.context.scene.fcn).bl_rna):
        for prop in owner.properties:
            if prop.identifier not in {"rna_type", "name", "parameters", "detection"}:
                assert prop.name and prop.description, prop.identifier
    for owner in (results.FCN_PG_result.bl_rna, results.FCN_PG_transformation.bl_rna):
        found = [prop for prop in owner.properties if prop.identifier in shown]
        assert found and all(prop.name and prop.description for prop in found)
    for name in dir(bpy.ops.fcn):
        kind = getattr(bpy.ops.fcn, name).get_rna_type()
        assert kind.name and kind.description and kind.description != "(undocumented operator)", name
