# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove a result and show its source again."""

from __future__ import annotations

import bpy

from ..fcn_addon import results


class FCN_OT_remove_result(bpy.types.Operator):
    """Remove this result with all its objects, and show the curves it was made of again"""

    bl_idname = "fcn.remove_result"
    bl_label = "Remove Result"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        why = "Leave the edit mode first" if context.mode != "OBJECT" else None
        if why is None and results.active(context.scene) is None:
            why = "No result: complete curves first"
        if why:
            cls.poll_message_set(why)
        return not why

    def execute(self, context):
        root = results.active(context.scene)
        names = results.source_names(root)
        results.remove(root)
        context.scene.fcn.result = results.active(context.scene)
        for name in names:
            item = context.view_layer.objects.get(name)
            if item is not None:
                item.hide_set(False)
        return {"FINISHED"}
