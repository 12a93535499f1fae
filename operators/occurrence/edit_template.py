# SPDX-License-Identifier: GPL-3.0-or-later
"""Edit the curves that all occurrences of a template share."""

from __future__ import annotations

import bpy

from ...fcn_addon.result import selection
from ...fcn_addon.scene import focus
from ...fcn_addon.scene.curve_data import OFFSET
from ..base import Polled, enter_edit_mode


class FCN_OT_edit_template(Polled, bpy.types.Operator):
    """Edit the curves of this template: what is changed in one occurrence changes in all. Again, or Tab, goes back"""

    bl_idname = "fcn.edit_template"
    bl_label = "Edit Template"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_not(cls, context):
        found = context.active_object is not None and selection.is_of_occurrence(context.active_object)
        return None if found else "Make a curve of an occurrence active"

    def execute(self, context):
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
            focus.end()
            return {"FINISHED"}
        parts = [item for item in selection.parts([context.active_object]) if item.visible_get()]
        if not parts:
            self.report({"ERROR"}, "No curve of this occurrence is visible")
            return {"CANCELLED"}
        active = context.active_object if context.active_object in parts else parts[0]
        if parts[0].parent is not None and OFFSET in parts[0].parent:
            self.report({"WARNING"}, "So far from the origin occurrences share no curves: this one changes alone")
        selection.select(context, parts, active=active)
        focus.begin(context, context.scene.fcn.edit_alone)
        enter_edit_mode(self.bl_label)
        return {"FINISHED"}
