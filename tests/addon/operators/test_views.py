# SPDX-License-Identifier: GPL-3.0-or-later
"""What is shown of a result: views, support, and the lines that are drawn."""

import numpy as np
import pytest

from tests.addon.operators.looking import parts, scene, seen, world


def test_the_views(bpy, part, made):
    colours = part("fcn_addon.colours")
    templates = {o.name for o in made.children["Templates"].all_objects}
    curves = [o for o in made.children["Templates"].all_objects if o.type == "CURVE"]
    assert len(templates) == 18
    shown = seen(bpy, made)
    assert shown["templates"] == templates and len(shown["strong"]) == 1
    assert shown["input"] == shown["noise"] == set()
    assert all(np.allclose(o.color[:3], colours.TEMPLATE) for o in curves)

    made.fcn_result.view = "COMPONENTS"
    shown = seen(bpy, made)
    pieces = {o.name for o in made.children["Components"].all_objects if "support" not in o}
    assert len(pieces) == 2
    assert shown["components"] == pieces | {o.name for o in curves} and not shown["strong"]
    assert shown["templates"] == {o.name for o in curves}  # they are the same objects; the empties are hidden
    assert all(np.allclose(o.color[:3], colours.distinct(o["component"])) for o in curves)

    made.fcn_result.view = "TEMPLATES"
    shown = seen(bpy, made)
    assert shown["templates"] == templates and len(shown["strong"]) == 1
    assert all(np.allclose(o.color[:3], colours.distinct(3)) for o in curves)

    made.fcn_result.view = "INPUT"
    shown = seen(bpy, made)
    assert shown["input"] == {"Input"}
    assert not (shown["templates"] | shown["components"] | shown["strong"] | shown["noise"])

    made.fcn_result.view = "RESULT"
    assert seen(bpy, made)["templates"] == templates
    assert all(np.allclose(o.color[:3], colours.TEMPLATE) for o in curves)


@pytest.mark.parametrize("least", [0.0, 0.09, 0.5, 1.0])
def test_the_support_hides_at_once_and_shows_again(bpy, made, least):
    everything = {o.name for o in parts(made)}
    made.fcn_result.support = least
    scene(bpy)
    assert {o.name for o in parts(made) if o.visible_get()} == {
        o.name for o in parts(made) if o["support"] >= least - 1e-6
    }
    assert {o.name for o in parts(made) if not o.hide_render} == {o.name for o in parts(made) if o.visible_get()}
    made.fcn_result.support = 0
    scene(bpy)
    assert {o.name for o in parts(made) if o.visible_get()} == everything


def test_the_bound_of_the_support_is_inclusive(bpy, made):
    item = next(o for o in parts(made) if 0.2 < o["support"] < 0.8)
    made.fcn_result.support = item["support"]
    scene(bpy)
    assert item.visible_get()
    made.fcn_result.support = item["support"] + 1e-3
    scene(bpy)
    assert not item.visible_get()


def test_view_and_support_together(bpy, made):
    made.fcn_result.support = 0.5
    made.fcn_result.view = "COMPONENTS"
    shown = seen(bpy, made)["components"]
    assert shown == {o.name for o in parts(made) if o["support"] >= 0.5 and o["occurrence"] >= 0} | {
        "Component 0 input", "Component 1 input"
    }  # fmt: skip


def test_a_renamed_result_can_be_worked_with(bpy, made):
    for collection in [made, *made.children_recursive]:
        collection.name = f"mine {collection.name}"
    made.fcn_result.view = "INPUT"
    assert seen(bpy, made)["input"] and not seen(bpy, made)["templates"]


def test_a_result_without_some_collections_can_be_worked_with(bpy, made):
    for name in ("Components", "Strong", "Noise"):
        bpy.data.collections.remove(made.children[name])
    for view in ("COMPONENTS", "INPUT", "TEMPLATES", "RESULT"):
        made.fcn_result.view = view
    assert len(seen(bpy, made)["templates"]) == 18
    bpy.data.collections.remove(made.children["Templates"].children[0])
    made.fcn_result.support = 0.5
    assert bpy.ops.fcn.select_transformation() == {"FINISHED"}


def test_the_strokes_that_are_drawn(bpy, part, made):
    strokes, colours = part("fcn_addon.result.strokes"), part("fcn_addon.colours")
    scene(bpy)
    segments, shades, known = strokes.collect(bpy.context)
    assert segments.shape == (6 * (8 + 8) + 8, 2, 3) and shades.shape == (len(segments), 4)
    assert {o.session_uid for o in parts(made)} <= known
    arch = next(o for o in parts(made) if o["occurrence"] == 3 and o["component"] == 0)
    expected = world(arch)
    assert any(np.allclose(segments[i : i + 8, 0], expected[:-1], atol=1e-4) for i in range(len(segments) - 7))
    assert len(np.unique(shades, axis=0)) == 2 and shades[0, 2] > colours.TEMPLATE[2]
    made.fcn_result.support = 1.0
    scene(bpy)
    assert len(strokes.collect(bpy.context)[0]) == 8 + 8  # the ring of the last occurrence, and the strong curve
    arch.select_set(True)
    made.fcn_result.view = "INPUT"
    scene(bpy)
    assert len(strokes.collect(bpy.context)[0]) == 0
