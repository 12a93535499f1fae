# SPDX-License-Identifier: GPL-3.0-or-later
"""Open the manual."""

from __future__ import annotations

import bpy

from ..fcn_addon import manual


class FCN_OT_manual(bpy.types.Operator):
    """Open the manual of this extension in the browser; it needs no network"""

    bl_idname = "fcn.manual"
    bl_label = "Manual"

    def execute(self, context):
        bpy.ops.wm.url_open(url=manual.write(bpy.app.tempdir).as_uri())
        return {"FINISHED"}
