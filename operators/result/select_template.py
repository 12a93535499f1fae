# SPDX-License-Identifier: GPL-3.0-or-later
"""Select and frame the occurrences of a template."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty

from ...fcn_addon.result import selection, stored, templates
from ...fcn_addon.scene import viewports
from ...fcn_addon.wording import counted
from ..base import OnResult


class FCN_OT_select_template(OnResult, bpy.types.Operator):
    """Select all occurrences of this template, or one of them, and look at them"""

    bl_idname = "fcn.select_template"
    bl_label = "Select Template"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty(name="Template", description="Row of the list, -1 for the active one", default=-1, min=-1)
    place: IntProperty(name="Occurrence", description="Row of its occurrences, -1 for all", default=-1, min=-1)

    def execute(self, context):
        root = stored.active(context.scene)
        result = root.fcn_result
        if not result.template_rows or self.index >= len(result.template_rows):
            self.report({"ERROR"}, "There is no such template in the list")
            return {"CANCELLED"}
        if self.index >= 0:
            result.active_template = self.index
        row = templates.active(root)
        found = templates.holders(root, row.ident)
        if self.place >= len(found):
            self.report({"ERROR"}, rpt_("{name} has {what}").format(name=row.name, what=counted(len(found), "place")))
            return {"CANCELLED"}
        if self.place >= 0:
            found, result.active_place = [found[self.place]], self.place
        if result.view == "INPUT":
            result.view = "RESULT"
        context.view_layer.update()
        shown = [item for item in selection.parts(found) if item.visible_get()]
        if not selection.select(context, shown, active=shown[0] if shown else None):
            self.report({"WARNING"}, "Nothing of this template is visible")
            return {"FINISHED"}
        viewports.frame_selected(context)
        return {"FINISHED"}
