# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the example."""

from __future__ import annotations

import bpy

from ...fcn_addon.exchange import example
from ...fcn_addon.installation import require_scipy
from ...fcn_addon.scene import viewports
from ..base import LEAVE_EDIT_MODE, Polled


class FCN_OT_try_example(Polled, bpy.types.Operator):
    """Make a wall with six windows, a scan and the curves found on it, to try this on"""

    bl_idname = "fcn.try_example"
    bl_label = "Try an Example"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def why_not(cls, context):
        return LEAVE_EDIT_MODE if context.mode != "OBJECT" else None

    def execute(self, context):
        require_scipy()
        example.add(context)
        viewports.look_from_front(context)
        return {"FINISHED"}
