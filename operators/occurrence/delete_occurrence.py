# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove single occurrences for good."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection, stored, templates
from ...fcn_addon.wording import counted
from ..base import OnOccurrence


class FCN_OT_delete_occurrence(OnOccurrence, bpy.types.Operator):
    """Delete the occurrences that the selected curves belong to, whole. To be able to take them back in, reject them"""

    bl_idname = "fcn.delete_occurrence"
    bl_label = "Delete Occurrence"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        chosen = list(context.selected_objects)
        holders = selection.holders(chosen)
        count = len(holders)
        roots = selection.results_of(context.scene, chosen)
        stored.remove_objects([*holders, *selection.parts(chosen)])
        for root in roots:
            templates.count(root)
        self.report({"INFO"}, rpt_("{what} deleted").format(what=counted(count, "occurrence")))
        return {"FINISHED"}
