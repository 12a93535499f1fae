# SPDX-License-Identifier: GPL-3.0-or-later
"""The result: what is shown of it, the transformations, and single occurrences."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..fcn_addon.job import session
from ..fcn_addon.result import stored
from ..fcn_addon.result import views as views_of
from ..fcn_addon.scene import origin
from ..fcn_addon.scene.units import unit_length
from ..fcn_addon.wording import counted
from .sidebar import Sidebar

WIDE = 240  # pixels, on a screen of usual density, from which two buttons stand side by side


class OfResult(Sidebar):
    """A panel that is there while there is a result."""

    @classmethod
    def poll(cls, context):
        return stored.active(context.scene) is not None


def _kept_row(layout, item, **words):
    """A row of a list with what can be kept or rejected: the box, what it is, and its support."""
    row = layout.row(align=True)
    row.prop(item, "kept", text="", icon="CHECKBOX_HLT" if item.kept else "CHECKBOX_DEHLT", emboss=False)
    name = row.row()
    name.active = item.kept
    name.label(translate=False, **words)
    share = row.row()
    share.alignment = "RIGHT"
    share.active = item.kept
    share.label(text=f"{item.support:.0%}", translate=False)
    return row


class FCN_UL_transformations(bpy.types.UIList):
    bl_idname = "FCN_UL_transformations"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        text = f"{item.short}, {counted(item.count, 'place')}"
        row = _kept_row(layout, item, text=text, icon=stored.ICONS.get(item.kind, "DOT"))
        row.operator("fcn.select_transformation", text="", icon="RESTRICT_SELECT_OFF", emboss=False).index = index


class FCN_UL_templates(bpy.types.UIList):
    bl_idname = "FCN_UL_templates"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = layout.row(align=True)
        row.prop(item, "shown", text="", icon="HIDE_OFF" if item.shown else "HIDE_ON", emboss=False)
        colour = row.row()
        colour.ui_units_x = 0.8
        colour.prop(item, "colour", text="")
        row.prop(item, "name", text="", emboss=False)
        numbers = row.row()
        numbers.alignment = "RIGHT"
        numbers.label(text=f"{item.count:,}   {item.support:.0%}", translate=False)
        row.operator("fcn.select_template", text="", icon="RESTRICT_SELECT_OFF", emboss=False).index = index


class FCN_UL_places(bpy.types.UIList):
    bl_idname = "FCN_UL_places"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = _kept_row(layout, item, text=item.name)
        button = row.operator("fcn.select_template", text="", icon="RESTRICT_SELECT_OFF", emboss=False)
        button.index, button.place = -1, index


class FCN_PT_result(OfResult, bpy.types.Panel):
    bl_label = "Result"

    def draw(self, context):
        layout = self.layout
        layout.enabled = not session.running()
        root = stored.active(context.scene)
        result = root.fcn_result
        row = layout.row(align=True)
        row.prop(context.scene.fcn, "result", text="", placeholder=root.name)  # without a choice it is the latest
        row.operator("fcn.remove_result", text="", icon="TRASH")
        shift = origin.words(origin.of(root))
        if shift:
            text = iface_("Shift: {shift}").format(shift=shift)
            layout.label(text=text, icon="ORIENTATION_GLOBAL", translate=False)
        if origin.STEP in root:
            step = unit_length(context.scene)(root[origin.STEP])
            text = iface_("Far from the origin: Blender rounds places to {step}").format(step=step)
            layout.label(text=text, icon="ERROR", translate=False)
        views = layout.grid_flow(row_major=True, columns=2, even_columns=True, align=True)
        for view in ("RESULT", "COMPONENTS", "TEMPLATES", "INPUT"):
            cell = views.row(align=True)
            cell.enabled = views_of.can_show(root, view)
            cell.prop_enum(result, "view", view)
        row = layout.row(align=True)
        row.prop(result, "support", text="Hide Below Support", slider=True)
        row.prop(result, "solo", text="", icon="SOLO_ON" if result.solo else "SOLO_OFF")
        row.operator("fcn.restore", text="", icon="LOOP_BACK")
        # Over the whole width: names would be cut beside buttons, where many rows bring a scroll bar.
        layout.template_list(
            FCN_UL_templates.bl_idname, "", result, "template_rows", result, "active_template", rows=3, maxrows=3
        )
        layout.template_list(FCN_UL_places.bl_idname, "", result, "places", result, "active_place", rows=3, maxrows=3)


class FCN_PT_transformations(OfResult, bpy.types.Panel):
    bl_label = "How It Repeats"
    bl_parent_id = "FCN_PT_result"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.enabled = not session.running()
        result = stored.active(context.scene).fcn_result
        layout.template_list(
            FCN_UL_transformations.bl_idname, "", result, "transformations", result, "active", rows=4, maxrows=4
        )
        _draw_transformation(layout, stored.active_transformation(context.scene))


def _draw_transformation(layout, row):
    """The numbers of the active row; as many rows where there is none."""
    column = layout.box().column(align=True)
    for text in _said(row):
        column.label(text=text, translate=False)
    buttons = layout.row(align=True)
    buttons.operator("fcn.select_transformation", text="Select", icon="RESTRICT_SELECT_OFF").index = -1
    kept = row is None or row.kept
    buttons.operator("fcn.reject_transformation", text="Reject" if kept else "Keep", icon="X" if kept else "CHECKMARK")


def _said(row):
    if row is None:
        return iface_("Nothing repeats here"), "", ""
    return (
        row.name,
        f"{counted(row.count, 'occurrence')}, {counted(row.curves, 'curve')}",
        iface_("Explains {support:.0%} of all curves").format(support=row.support),
    )


class FCN_PT_occurrence(OfResult, bpy.types.Panel):
    bl_label = "Occurrence"
    bl_parent_id = "FCN_PT_result"

    def draw(self, context):
        layout = self.layout
        layout.enabled = not session.running()
        item = context.active_object
        text = iface_("No curve of an occurrence is active")
        if item is not None and item.get("occurrence", -1) >= 0:
            text = item.name if "support" not in item else f"{item.name}: {item['support']:.0%}"
        layout.label(text=text, translate=False)
        wide = context.region is not None and context.region.width >= WIDE * context.preferences.system.ui_scale
        buttons = layout.grid_flow(row_major=True, columns=2 if wide else 1, even_columns=True, align=True)
        editing = context.mode != "OBJECT"
        for name, text, icon in (
            ("fcn.edit_template", "Finish Editing" if editing else "Edit Template", "EDITMODE_HLT"),
            ("fcn.select_occurrence", "Select Whole", "RESTRICT_SELECT_OFF"),
            ("fcn.select_source", "Source Curves", "BACK"),
            ("fcn.select_result", "Completed", "FORWARD"),
            ("fcn.make_unique", "Make Unique", "UNLINKED"),
            ("fcn.reject_occurrence", "Reject", "X"),
            ("fcn.delete_occurrence", "Delete", "TRASH"),
        ):
            buttons.operator(name, text=text, icon=icon)
        buttons.prop(context.scene.fcn, "edit_alone", text="Edit Alone")


class FCN_PT_use(OfResult, bpy.types.Panel):
    bl_label = "Use It"
    bl_parent_id = "FCN_PT_result"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.enabled = not session.running()
        result = stored.active(context.scene).fcn_result
        layout.operator_menu_enum("fcn.apply", "kind", icon="OUTLINER_OB_CURVE")
        layout.operator("fcn.export_curves", text="Export", icon="EXPORT")
        layout.prop(result, "attributes")
        layout.prop(result, "scan_locked")
        row = layout.row(align=True)
        row.prop(result, "template_colour", text="")
        row.prop(result, "strong_colour", text="")
