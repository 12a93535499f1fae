# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels say in each state of the scene. Without a window Blender has no layouts: one writes down."""

import re
from types import SimpleNamespace

import pytest

LAYOUTS = {"row", "column", "box", "column_flow", "grid_flow", "split"}


class Written:
    """A layout that writes down what it is asked for, and refuses what Blender's own would not take."""

    def __init__(self, rna, said, buttons):
        for name, value in (("rna", rna), ("said", said), ("buttons", buttons)):
            object.__setattr__(self, name, value)

    def __setattr__(self, name, value):
        assert name in self.rna.properties, name

    def __getattr__(self, name):
        parameters = self.rna.functions[name].parameters

        def call(*args, **more):
            known = [p.identifier for p in parameters if not p.is_output]
            given = {**dict(zip(known, args)), **more}
            assert set(given) <= set(known), (name, given)
            missing = [p.identifier for p in parameters if p.is_required and p.identifier not in {*given, "return"}]
            assert not set(missing) & set(known), (name, missing)
            return self._do(name, given)

        return call

    def _do(self, name, given):
        if "data" in given:
            assert given["property"] in given["data"].bl_rna.properties, given["property"]
        if given.get("text"):
            self.said.append(given["text"])
        if name.startswith("operator"):
            self.buttons.append(given["operator"])
            return SimpleNamespace()
        return Written(self.rna, self.said, self.buttons) if name in LAYOUTS else None


def is_seen(bpy, panel):
    """Whether Blender would draw a panel: it and those that it is in."""
    outer = getattr(bpy.types, getattr(panel, "bl_parent_id", ""), None)
    return (not hasattr(panel, "poll") or panel.poll(bpy.context)) and (outer is None or is_seen(bpy, outer))


@pytest.fixture
def panels(bpy, part):
    """Draws all panels that would be seen now: (texts, idnames of the buttons)."""

    def draw():
        bpy.context.view_layer.update()
        part("fcn_addon.job.summary").compute(bpy.context)
        said, buttons = [], []
        rna = bpy.types.UILayout.bl_rna
        for cls in part("ui").CLASSES:
            if issubclass(cls, bpy.types.Panel) and is_seen(bpy, cls) and not cls.__name__.endswith("presets"):
                cls.draw(SimpleNamespace(layout=Written(rna, said, buttons)), bpy.context)
        for root in part("fcn_addon.result.stored").of_scene(bpy.context.scene):
            for i, row in enumerate(root.fcn_result.transformations):
                layout = Written(rna, said, buttons)
                part("ui").FCN_UL_transformations.draw_item(
                    None, bpy.context, layout, root.fcn_result, row, 0, root.fcn_result, "active", i
                )
            for cls, rows in (("FCN_UL_templates", "template_rows"), ("FCN_UL_places", "places")):
                for i, row in enumerate(getattr(root.fcn_result, rows)):
                    layout = Written(rna, said, buttons)
                    drawn = getattr(part("ui"), cls).draw_item
                    drawn(None, bpy.context, layout, root.fcn_result, row, 0, root.fcn_result, "active", i)
        return said, buttons

    return draw


def test_nothing_is_selected(panels, bpy):
    said, buttons = panels()
    assert "Select curves or edge meshes" in said and "Select a scan, a mesh with faces" in said
    assert "fcn.complete" in buttons and "fcn.select_transformation" not in buttons


def test_a_result_far_from_the_origin_says_how_coarse_places_are(panels, bpy, made):
    assert not any("rounds places" in text for text in panels()[0])
    made["fcn_step"] = 0.5
    assert "Far from the origin: Blender rounds places to 50 cm" in panels()[0]


def test_what_a_run_would_use(panels, bpy, part, wall):
    bpy.context.scene.fcn.parameters.l0 = 4
    said, _ = panels()
    assert "4 curves of 1 object" in said
    (samples,) = (text for text in said if "samples" in text)
    assert re.fullmatch(r"\d+ samples, edge length [\d.]+ c?m", samples)
    assert any(re.fullmatch(r"\d+ strong curves", text) for text in said)
    assert any(re.fullmatch(r"About \d.* s", text) for text in said)
    # Each parameter in edge lengths stands beside its length in the scene; thresholds have no scan here to know it.
    detection = part("fcn_addon.properties.detection")
    assert said.count("edges") == len({*detection.ADVANCED} & {*detection.IN_EDGES})
    other = wall.copy()
    bpy.context.scene.collection.objects.link(other)
    other.select_set(True)
    assert "8 curves of 2 objects" in panels()[0]


@pytest.mark.parametrize(
    ("system", "scale", "unit", "factor"),
    [("METRIC", 1.0, "m", 1.0), ("METRIC", 1000.0, "km", 1.0), ("IMPERIAL", 1.0, "'", 0.3048), ("NONE", 1.0, "", 1.0)],
)
def test_lengths_are_in_the_unit_of_the_scene(panels, bpy, wall, system, scale, unit, factor):
    bpy.context.scene.unit_settings.system = system
    bpy.context.scene.unit_settings.scale_length = scale
    settings = bpy.context.scene.fcn
    settings.edge_length_from, settings.edge_length = "VALUE", 2.5
    (said,) = (text for text in panels()[0] if "samples" in text)
    number = re.fullmatch(rf"[\d,]+ samples, edge length ([\d.]+) ?{unit}", said)
    assert number, said
    assert float(number[1]) == pytest.approx(2.5 / factor, rel=1e-3)


def test_in_edit_mode(panels, bpy, wall):
    bpy.ops.object.mode_set(mode="EDIT")
    said, buttons = panels()
    assert "Leave the edit mode first" in said and "fcn.complete" in buttons
    bpy.ops.object.mode_set(mode="OBJECT")
    assert "Leave the edit mode first" not in panels()[0]


def test_a_result(panels, bpy, made):
    said, buttons = panels()
    for text in ("Grid 1: 3 x 2, 6 places", "6   50%", "Template A at 3", "Grid 1: 3 x 2, step 1.8 m, 2.4 m", "40%",
                 "6 occurrences, 12 curves",
                 "Reject"):  # fmt: skip
        assert text in said, (text, said)
    assert "4 curves of the result" not in said
    bpy.context.scene.fcn.show_source = True
    assert "4 curves of the result" in panels()[0]
    made.fcn_result.transformations[0].kept = False
    assert "Keep" in panels()[0]
    item = next(o for o in made.all_objects if o.get("occurrence") == 3 and "support" in o)
    bpy.context.view_layer.objects.active = item
    assert f"{item.name}: {item['support']:.0%}" in panels()[0]
    bpy.context.view_layer.objects.active = item.parent
    assert item.parent.name in panels()[0]


def test_what_is_selected_moves_no_panel_of_a_result(panels, bpy, part, made):
    """Detect Curves is above all while there is no result, and below it afterwards."""
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata([(0, 0, 0), (3, 0, 0), (0, 4, 0)], [], [(0, 1, 2)])
    scan = bpy.data.objects.new("Scan", mesh)
    bpy.context.scene.collection.objects.link(scan)

    def seen():
        bpy.context.view_layer.update()
        shown = [c for c in part("ui").CLASSES if issubclass(c, bpy.types.Panel) and is_seen(bpy, c)]
        return [c.bl_label for c in shown if not getattr(c, "bl_parent_id", "") and not c.__name__.endswith("presets")]

    for selected in (True, False):
        scan.select_set(selected)
        bpy.context.view_layer.objects.active = scan if selected else None
        assert seen() == ["Complete Curves", "Result", "Detect Curves"]
        assert ("Scan: 1 face" in panels()[0]) == selected
        assert "fcn.detect" in panels()[1]
    bpy.ops.fcn.remove_result()
    assert seen() == ["Detect Curves", "Complete Curves"]


def test_while_a_template_is_edited(panels, bpy, made):
    item = next(o for o in made.all_objects if o.get("occurrence") == 3 and "support" in o)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.ops.fcn.edit_template()
    said, buttons = panels()
    assert said.count("Finish Editing") == 2 and "fcn.complete" not in buttons


def remove_objects(bpy, root):
    bpy.data.batch_remove(list(root.all_objects))


def remove_empties(bpy, root):
    bpy.data.batch_remove([o for o in root.all_objects if o.type == "EMPTY"])


def remove_collections(bpy, root):
    bpy.data.batch_remove(root.children_recursive)


def remove_data(bpy, root):
    bpy.data.batch_remove(list({o.data for o in root.all_objects if o.type == "CURVE"}))


def unlink_result(bpy, root):
    bpy.context.scene.collection.children.unlink(root)


def remove_source(bpy, root):
    bpy.data.objects.remove(bpy.data.objects["Wall"])


BY_HAND = (remove_objects, remove_empties, remove_collections, remove_data, unlink_result, remove_source)


@pytest.mark.parametrize("change", BY_HAND, ids=lambda change: change.__name__)
def test_what_users_deleted_by_hand_disturbs_neither_panels_nor_buttons(panels, bpy, part, made, change):
    change(bpy, made)
    there = change is not unlink_result
    said, buttons = panels()
    assert ("fcn.apply" in buttons) == there
    for view in ("COMPONENTS", "TEMPLATES", "INPUT", "RESULT"):
        made.fcn_result.view = view
        panels()
    made.fcn_result.support = 0.5
    made.fcn_result.support = 0.0
    for name in ("select_transformation", "select_source", "reject_occurrence", "make_unique", "restore",
                 "reject_transformation", "apply", "edit_template", "edit_template"):  # fmt: skip
        operator = getattr(bpy.ops.fcn, name)
        if not operator.poll():
            continue
        try:
            assert operator() in ({"FINISHED"}, {"CANCELLED"})
        except RuntimeError as error:  # that is how Python hears of what an operator reports; faults have a traceback
            assert str(error).startswith("Error: ") and "Traceback" not in str(error), name
        panels()
    if there:
        while part("fcn_addon.result.stored").active(bpy.context.scene) is not None:
            if bpy.context.mode != "OBJECT":
                bpy.ops.object.mode_set(mode="OBJECT")
            assert bpy.ops.fcn.remove_result() == {"FINISHED"}
        assert "fcn.apply" not in panels()[1]


def test_during_a_run(panels, bpy, part, wall, work):
    session = part("fcn_addon.job.session")
    session.begin(bpy.context, part("fcn_addon.job.completing").COMPLETE)
    try:
        said, buttons = panels()
        assert "Starting" in said and "fcn.cancel" in buttons and "fcn.complete" not in buttons
        assert any(re.fullmatch(r"0% +[\d.]+ s left", text) for text in said)
        assert session.current().job.join(5)
        session.tick()
        assert "Fitting lines and arcs" in panels()[0]
        session.cancel()
        session.tick()
        assert "Stopping…" in panels()[0]
    finally:
        session.end()


def test_the_menu_has_every_operator(bpy, part):
    said, buttons = [], []
    part("ui.menu").FCN_MT_object.draw(
        SimpleNamespace(layout=Written(bpy.types.UILayout.bl_rna, said, buttons)), bpy.context
    )
    # Measuring and presets have no use outside the panel.
    assert {*buttons, "fcn.measure", "fcn.save_preset"} == {cls.bl_idname for cls in part("operators").CLASSES}
