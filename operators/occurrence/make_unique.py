# SPDX-License-Identifier: GPL-3.0-or-later
"""Let an occurrence differ from its template."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import selection
from ...fcn_addon.wording import counted
from ..base import OnOccurrence


class FCN_OT_make_unique(OnOccurrence, bpy.types.Operator):
    """Give the selected occurrences curves of their own, which no longer follow the template"""

    bl_idname = "fcn.make_unique"
    bl_label = "Make Unique"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        shared = [item for item in selection.parts(context.selected_objects) if item.data.users > 1]
        for item in shared:
            item.data = item.data.copy()
            item["unique"] = True
        self.report({"INFO"}, rpt_("{what} now follow no template").format(what=counted(len(shared), "curve")))
        return {"FINISHED"}
