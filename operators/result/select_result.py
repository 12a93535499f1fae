# SPDX-License-Identifier: GPL-3.0-or-later
"""From input curves to the occurrences that were made of them."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection, stored, tracing
from ...fcn_addon.scene import viewports
from ...fcn_addon.wording import counted
from ..base import Polled


class FCN_OT_select_result(Polled, bpy.types.Operator):
    """Go back to the result, and select the occurrences that the selected input curves belong to"""

    bl_idname = "fcn.select_result"
    bl_label = "Select Completed Curves"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_not(cls, context):
        item = context.active_object
        found = item is not None and item.type == "MESH" and "source" in item.data.attributes
        return None if found else "Select points of a result's input first: Select Source Curves shows it"

    def execute(self, context):
        item = context.active_object
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        root = next(iter(selection.results_of(context.scene, [item])), None)
        mesh = None if root is None else tracing.input_mesh(root)
        if mesh is None or mesh.item != item or stored.child(root, "templates") is None:
            self.report({"ERROR"}, rpt_("{name!r} is not the input of a result").format(name=item.name))
            return {"CANCELLED"}
        found = tracing.parts_of_points(root, tracing.selected_points(item.data), mesh)
        root.fcn_result.view = "RESULT"
        context.view_layer.update()
        count = selection.select(context, found, active=found[0] if found else None)
        if count:
            viewports.frame_selected(context)
        self.report({"INFO"}, rpt_("{what} selected").format(what=counted(count, "completed curve")))
        return {"FINISHED"}
