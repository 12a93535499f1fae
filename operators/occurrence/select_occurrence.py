# SPDX-License-Identifier: GPL-3.0-or-later
"""From a curve to the whole occurrence."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection
from ...fcn_addon.wording import counted
from ..base import OnOccurrence


class FCN_OT_select_occurrence(OnOccurrence, bpy.types.Operator):
    """Select all curves of the selected occurrences and the empties that hold them, to move or hide them as one"""

    bl_idname = "fcn.select_occurrence"
    bl_label = "Select Whole"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        chosen = list(context.selected_objects)
        whole = [*selection.holders(chosen), *selection.parts(chosen)]
        count = selection.select(context, whole, active=whole[0])
        self.report({"INFO"}, rpt_("{what} selected").format(what=counted(count, "object")))
        return {"FINISHED"}
