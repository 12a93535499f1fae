# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove a result and show its source again."""

from __future__ import annotations

import bpy

from ...fcn_addon.result import stored
from ..base import OnResult


class FCN_OT_remove_result(OnResult, bpy.types.Operator):
    """Remove this result with all its objects, and show the curves it was made of again"""

    bl_idname = "fcn.remove_result"
    bl_label = "Remove Result"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        root = stored.active(context.scene)
        names = stored.source_names(root)
        stored.remove(root)
        context.scene.fcn.result = stored.active(context.scene)
        for name in names:
            item = context.view_layer.objects.get(name)
            if item is not None:
                item.hide_set(False)
        return {"FINISHED"}
