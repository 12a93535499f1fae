# SPDX-License-Identifier: GPL-3.0-or-later
"""Stop the run that is under way."""

from __future__ import annotations

import bpy

from ..fcn_addon import session, viewports


class FCN_OT_cancel(bpy.types.Operator):
    """Stop the run that is under way; nothing is changed then"""

    bl_idname = "fcn.cancel"
    bl_label = "Cancel Completing Curves"

    @classmethod
    def poll(cls, context):
        if not session.running():
            cls.poll_message_set("No run is under way")
        return session.running()

    def execute(self, context):
        session.cancel()
        viewports.redraw_panels(context)
        return {"FINISHED"}
