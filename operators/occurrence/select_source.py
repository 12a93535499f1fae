# SPDX-License-Identifier: GPL-3.0-or-later
"""From an occurrence to the input curves that show it."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection, tracing
from ...fcn_addon.scene import viewports
from ...fcn_addon.wording import counted
from ..base import OnOccurrence, enter_edit_mode


class FCN_OT_select_source(OnOccurrence, bpy.types.Operator):
    """Show the input, and select in it the curves that the selected occurrences were made of"""

    bl_idname = "fcn.select_source"
    bl_label = "Select Source Curves"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        parts = selection.parts(context.selected_objects)
        root = next(iter(selection.results_of(context.scene, parts[:1])), None)
        mesh = None if root is None else tracing.input_mesh(root)
        if mesh is None:
            self.report({"ERROR"}, "The input of this result was removed; complete the curves again")
            return {"CANCELLED"}
        chosen = tracing.source_points(root, parts, mesh)
        if not chosen.any():
            self.report({"WARNING"}, "No input curve lies here: this was completed from other occurrences alone")
            return {"CANCELLED"}
        root.fcn_result.view = "INPUT"
        context.view_layer.update()
        tracing.select_points(mesh.item.data, chosen)
        selection.select(context, [mesh.item], active=mesh.item)
        enter_edit_mode(self.bl_label)
        viewports.frame_selected(context)
        count = len(np.unique(mesh.source[chosen]))
        self.report({"INFO"}, rpt_("{what} selected").format(what=counted(count, "input curve")))
        return {"FINISHED"}
