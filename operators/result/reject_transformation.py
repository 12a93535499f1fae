# SPDX-License-Identifier: GPL-3.0-or-later
"""Take a transformation out of the result, or back in."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.result import stored
from ..base import OnTransformation


class FCN_OT_reject_transformation(OnTransformation, bpy.types.Operator):
    """Take all that the active transformation explains out of the result; again takes it back in"""

    bl_idname = "fcn.reject_transformation"
    bl_label = "Reject Transformation"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        row = stored.active_transformation(context.scene)
        row.kept = not row.kept
        text = rpt_("Kept: {name}") if row.kept else rpt_("Rejected: {name}")
        self.report({"INFO"}, text.format(name=row.name))
        return {"FINISHED"}
