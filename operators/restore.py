# SPDX-License-Identifier: GPL-3.0-or-later
"""Take all rejected parts back into the result."""

from __future__ import annotations

import bpy

from ..fcn_addon import results, views


class FCN_OT_restore(bpy.types.Operator):
    """Take all rejected transformations and occurrences of this result back in"""

    bl_idname = "fcn.restore"
    bl_label = "Restore Rejected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        found = results.active(context.scene) is not None
        if not found:
            cls.poll_message_set("No result: complete curves first")
        return found

    def execute(self, context):
        root = results.active(context.scene)
        rejected = [item for item in root.all_objects if "rejected" in item]
        for item in rejected:
            del item["rejected"]
        for row in root.fcn_result.transformations:
            if not row.kept:
                row.kept = True
        views.refresh(root)
        return {"FINISHED"}
