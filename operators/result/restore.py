# SPDX-License-Identifier: GPL-3.0-or-later
"""Take all rejected parts back into the result."""

from __future__ import annotations

import bpy

from ...fcn_addon.result import stored, templates, views
from ...fcn_addon.scene.families import within
from ..base import OnResult


class FCN_OT_restore(OnResult, bpy.types.Operator):
    """Take all rejected transformations and occurrences of this result back in"""

    bl_idname = "fcn.restore"
    bl_label = "Restore Rejected"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        root = stored.active(context.scene)
        rejected = [item for item in within(root) if "rejected" in item]
        for item in rejected:
            del item["rejected"]
        for row in root.fcn_result.transformations:
            if not row.kept:
                row.kept = True
        views.refresh(root)
        templates.count(root)
        return {"FINISHED"}
