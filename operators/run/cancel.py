# SPDX-License-Identifier: GPL-3.0-or-later
"""Stop the run that is under way."""

from __future__ import annotations

import bpy

from ...fcn_addon.job import session
from ...fcn_addon.scene import viewports
from ..base import Polled


class FCN_OT_cancel(Polled, bpy.types.Operator):
    """Stop the run that is under way; nothing is changed then"""

    bl_idname = "fcn.cancel"
    bl_label = "Cancel Completing Curves"

    @classmethod
    def why_not(cls, context):
        return None if session.running() else "No run is under way"

    def execute(self, context):
        session.cancel()
        viewports.redraw_panels(context)
        return {"FINISHED"}
