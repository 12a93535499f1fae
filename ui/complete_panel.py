# SPDX-License-Identifier: GPL-3.0-or-later
"""What to complete, the button, the progress, and the parameters."""

from __future__ import annotations

from dataclasses import fields

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..core.parameters import Parameters
from ..fcn_addon.job import session, summary
from ..fcn_addon.job.estimate import Summary
from ..fcn_addon.properties.settings import BASIC, in_edges
from ..fcn_addon.result import stored
from ..fcn_addon.scene.units import unit_length
from ..fcn_addon.wording import duration
from . import lengths
from .presets_panel import FCN_PT_presets
from .sidebar import Sidebar


class FCN_PT_complete(Sidebar, bpy.types.Panel):
    bl_label = "Complete Curves"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        run = session.current()
        if run is not None:
            _draw_run(layout, run)
            return
        settings = context.scene.fcn
        row = layout.row()
        row.use_property_split = False
        row.alignment = "LEFT"
        row.prop(
            settings, "show_source", emboss=False, text=_hint(context), icon="DOWNARROW_HLT" if settings.show_source
            else "RIGHTARROW",
        )  # fmt: skip
        if settings.show_source:
            _draw_source(layout, context, settings)
            _draw_summary(layout.box(), context)
            layout.prop(settings, "form")
            layout.prop(settings, "earlier", expand=True)
        _draw_button(layout, context)


def _hint(context):
    """What to do next, in a line."""
    if context.mode != "OBJECT":
        return "Editing: Tab goes back"
    why = summary.latest()
    if stored.active(context.scene) is not None:
        return "Settings of the next run"
    if isinstance(why, Summary):
        return "Press Complete Curves"
    return "Select curves, or import some" if why else "What to complete"


def _draw_button(layout, context):
    """The one large button: it completes; in edit mode it ends what a button began, in the same place."""
    item = context.active_object
    button = layout.row()
    button.scale_y = 1.6
    if context.mode == "EDIT_CURVE" and item.get("occurrence", -1) >= 0:
        button.operator("fcn.edit_template", text="Finish Editing", icon="CHECKMARK")
    elif context.mode == "EDIT_MESH" and "source" in item.data.attributes:
        button.operator("fcn.select_result", icon="FORWARD")
    else:
        button.operator("fcn.complete", icon="CURVE_DATA")
        if stored.active(context.scene) is None and not isinstance(summary.latest(), Summary):
            row = layout.row(align=True)
            row.operator("fcn.import_curves", text="Import", icon="IMPORT")
            row.operator("fcn.try_example", icon="LIGHT")


def _draw_source(layout, context, settings):
    layout.prop(settings, "source", expand=True)
    if settings.source == "COLLECTION":
        layout.prop(settings, "collection", text=" ")
        layout.prop(settings, "use_hidden")
    layout.prop(settings, "take_edges")
    layout.prop(settings, "edge_length_from")
    if settings.edge_length_from == "SCAN":
        layout.prop(settings, "scan", text=" ")
    elif settings.edge_length_from == "VALUE":
        layout.prop(settings, "edge_length", text=" ")


def _draw_summary(box, context):
    """What a run would use."""
    found = summary.latest()
    if not isinstance(found, Summary):
        column = box.column(align=True)
        row = column.row()
        row.label(text=found or "Press Measure to count the curves", icon="INFO")
        row.operator("fcn.measure", text="", icon="FILE_REFRESH", emboss=False)
        for _ in range(3):  # as many rows as when something is chosen: what lies below stays where it is
            column.label(text="")
        return
    column = box.column(align=True)
    row = column.row()
    one = found.curves == 1
    if found.again:
        text = iface_("1 curve of the result") if one else iface_("{curves:,} curves of the result")
    elif found.objects == 1:
        text = iface_("1 curve of 1 object") if one else iface_("{curves:,} curves of 1 object")
    else:
        text = iface_("{curves:,} curves of {objects:,} objects")
    text = text.format(curves=found.curves, objects=found.objects)
    row.label(text=text, icon="CURVE_DATA", translate=False)
    row.operator("fcn.measure", text="", icon="FILE_REFRESH", emboss=False)
    length = unit_length(context.scene)
    edge = length(found.edge_length)
    strong = iface_("1 strong curve") if found.strong == 1 else iface_("{strong:,} strong curves")
    for text in (
        iface_("{samples:,} samples, edge length {edge}").format(samples=found.samples, edge=edge),
        strong.format(strong=found.strong),
        iface_("About {time}").format(time=duration(found.seconds)),
    ):
        column.label(text=text, icon="BLANK1", translate=False)
    if found.coarse:
        column.label(text="The edge length is a coarse estimate: type it in", icon="INFO")
        if found.outline:
            text = iface_("A fiftieth of drawn outlines of {size}").format(size=length(found.outline))
            column.label(text=text, icon="BLANK1", translate=False)
    if found.left_out:
        text = iface_("Left out: {objects}").format(objects=found.left_out)
        column.label(text=text, icon="INFO", translate=False)


def _draw_run(layout, run):
    """The progress, as of the last tick."""
    stopping, label, fraction, left = run.shown or (False, "Starting", 0.0, 0)
    column = layout.column()
    column.label(text="Stopping…" if stopping else label, icon="TIME")
    text = iface_("{share:.0%}   {time} left").format(share=fraction, time=duration(left))
    column.progress(factor=fraction, text=text, translate=False)
    row = column.row()
    row.scale_y = 1.6
    row.enabled = not stopping
    row.operator("fcn.cancel", text="Cancel", icon="CANCEL")
    column.label(text="Esc over the viewport cancels too")


class FCN_PT_parameters(Sidebar, bpy.types.Panel):
    bl_label = "Parameters"
    bl_parent_id = "FCN_PT_complete"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context):
        FCN_PT_presets.draw_panel_header(self.layout)

    def draw(self, context):
        _draw_parameters(self.layout, context, BASIC)


class FCN_PT_advanced(Sidebar, bpy.types.Panel):
    bl_label = "More"
    bl_parent_id = "FCN_PT_parameters"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        names = [field.name for field in fields(Parameters) if field.name not in BASIC]
        _draw_parameters(self.layout, context, names)


def _draw_parameters(layout, context, names):
    layout.active = not session.running()
    found = summary.latest()
    edge_length = found.edge_length if isinstance(found, Summary) else None
    lengths.draw(layout, context, context.scene.fcn.parameters, names, in_edges(), edge_length)
