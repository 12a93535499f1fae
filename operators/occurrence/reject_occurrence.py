# SPDX-License-Identifier: GPL-3.0-or-later
"""Take single occurrences out of the result."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection, templates, views
from ...fcn_addon.wording import counted
from ..base import OnOccurrence


class FCN_OT_reject_occurrence(OnOccurrence, bpy.types.Operator):
    """Take the occurrences that the selected curves belong to out of the result"""

    bl_idname = "fcn.reject_occurrence"
    bl_label = "Reject Occurrence"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        chosen = selection.holders(context.selected_objects)
        rejected = [*chosen, *selection.parts(context.selected_objects)]
        roots = selection.results_of(context.scene, rejected)
        for item in rejected:
            item["rejected"] = True
        for root in roots:
            views.refresh(root)
            templates.count(root)
        self.report({"INFO"}, rpt_("{what} rejected").format(what=counted(len(chosen), "occurrence")))
        return {"FINISHED"}
