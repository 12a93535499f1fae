# SPDX-License-Identifier: GPL-3.0-or-later
"""From a scan to curves: what to look for, the buttons, and the thresholds of curves that were detected."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..fcn_addon.detected import kept
from ..fcn_addon.job import detecting, session, trial
from ..fcn_addon.properties.detection import ADVANCED, IN_EDGES, LARGE
from ..fcn_addon.reading.reader import evaluated_faces
from ..fcn_addon.result import stored
from . import lengths
from .sidebar import Sidebar


class Detecting(Sidebar):
    """Drawn in two places; whatever is selected it takes as much room, so that nothing below it moves."""

    bl_label = "Detect Curves"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.enabled = not session.running()
        item, scan, settings = context.active_object, detecting.scan_of(context), context.scene.fcn.detection
        if item is not None and item.select_get() and item.fcn_curves.scan:
            _draw_thresholds(layout, item)
            if scan is None:
                return
        if scan is None:
            layout.label(text="Select a scan, a mesh with faces", icon="INFO")
        else:
            faces = evaluated_faces(scan, context.view_layer.depsgraph)
            text = iface_("{scan}: 1 face") if faces == 1 else iface_("{scan}: {faces:,} faces")
            text = text.format(scan=scan.name, faces=faces)
            layout.label(text=text, icon="MESH_DATA", translate=False)
            _draw_copy(layout, settings, faces)
        layout.prop(settings, "detail")
        row = layout.row(align=True, heading="Kinds")
        row.prop(settings, "ridges", toggle=True)
        row.prop(settings, "valleys", toggle=True)
        row = layout.row(align=True, heading=" ")
        row.prop(settings, "sharp", text="Sharp", toggle=True)
        row.prop(settings, "boundary", toggle=True)
        column = layout.column(align=True)
        column.scale_y = 1.3
        column.operator("fcn.detect", icon="MOD_EDGESPLIT")
        column.operator("fcn.complete_scan", icon="CURVE_DATA")


class FCN_PT_detect(Detecting, bpy.types.Panel):
    """The first thing to do, as long as there is no result."""

    @classmethod
    def poll(cls, context):
        return stored.active(context.scene) is None


class FCN_PT_detect_below(Detecting, bpy.types.Panel):
    """Beside a result it stands below that, so that the lists stay where they are when something is selected."""

    @classmethod
    def poll(cls, context):
        return stored.active(context.scene) is not None


def _draw_copy(layout, settings, faces):
    """The choice of a smaller copy: where the scan is large, or where it is on."""
    if faces <= LARGE and not settings.use_copy:
        return
    if not settings.use_copy:
        layout.label(text="A smaller copy is quicker", icon="INFO")
    layout.prop(settings, "use_copy")
    if settings.use_copy:
        layout.prop(settings, "faces")


def _draw_thresholds(layout, item):
    box, curves = layout.box(), item.fcn_curves
    text = iface_("{shown:,} of 1 curve") if curves.total == 1 else iface_("{shown:,} of {total:,} curves")
    text = text.format(shown=curves.shown, total=curves.total)
    lines = box.column(align=True)
    lines.label(text=text, icon="CURVE_DATA", translate=False)
    text = iface_("Detail {detail:.1f} edge lengths").format(detail=curves.detail) if curves.detail else ""
    lines.label(text=text, icon="BLANK1", translate=False)
    lines.label(text=curves.remarks, icon="ERROR" if curves.remarks else "BLANK1", translate=False)
    column = box.column()
    column.enabled = kept.can_change(item)
    column.prop(curves, "fold", slider=True)
    column.prop(curves, "length")
    can_change = kept.can_change(item)
    box.label(text="" if can_change else "Detect again to change these", icon="BLANK1" if can_change else "INFO")


class Thresholds(Sidebar):
    bl_label = "Thresholds"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        layout.enabled = not session.running()
        scan = detecting.scan_of(context)
        known = None if scan is None else kept.measured(scan.name)
        edge_length = known.edge_length if known is not None else None
        lengths.draw(layout, context, context.scene.fcn.detection, ADVANCED, IN_EDGES, edge_length)
        _draw_trial(layout.box().column(align=True), trial.latest())


class FCN_PT_detect_more(Thresholds, bpy.types.Panel):
    bl_parent_id = "FCN_PT_detect"


class FCN_PT_detect_more_below(Thresholds, bpy.types.Panel):
    bl_parent_id = "FCN_PT_detect_below"


def _draw_trial(box, found):
    """What the thresholds would add and drop; as many lines where nothing was tried."""
    if not isinstance(found, trial.Trial):
        box.label(text=found or "A change is outlined here", icon="INFO")
        box.label(text="" if found else "once curves were detected")
        return
    for icon, text, share in (
        ("ADD", iface_("Green: {share:.1%} more"), found.longer),
        ("REMOVE", iface_("Red: {share:.1%} less"), found.shorter),
    ):
        box.label(text=text.format(share=share), icon=icon, translate=False)
