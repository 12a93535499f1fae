# SPDX-License-Identifier: GPL-3.0-or-later
"""Select and frame what a transformation explains."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty

from ...fcn_addon.result import selection, stored
from ...fcn_addon.scene import viewports
from ..base import OnTransformation


class FCN_OT_select_transformation(OnTransformation, bpy.types.Operator):
    """Select the occurrences of this transformation and look at them"""

    bl_idname = "fcn.select_transformation"
    bl_label = "Select Transformation"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty(name="Row", description="Row of the list, -1 for the active one", default=-1, min=-1)

    def execute(self, context):
        result = stored.active(context.scene).fcn_result
        if self.index >= len(result.transformations):
            text = rpt_("There is no row {row}; the list has {count}")
            self.report({"ERROR"}, text.format(row=self.index, count=len(result.transformations)))
            return {"CANCELLED"}
        if self.index >= 0:
            result.active = self.index
        if result.view == "INPUT":
            result.view = "RESULT"
        objects = selection.of_transformation(result.transformations[result.active])
        shown = [item for item in objects if selection.is_part(item) and item.visible_get()]
        if not selection.select(context, shown, active=shown[0] if shown else None):
            self.report({"WARNING"}, "Nothing of this transformation is visible")
            return {"FINISHED"}
        viewports.frame_selected(context)
        return {"FINISHED"}
