# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect the feature curves of a scan and complete them."""

from __future__ import annotations

import bpy

from ..fcn_addon import detecting, scan_runs, session
from .background import Background
from .complete import describe


class FCN_OT_complete_scan(Background, bpy.types.Operator):
    """Detect the feature curves of the active mesh, find what recurs in them, and complete them, in one go.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.complete_scan"
    bl_label = "Complete Scan"
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        why = "A run is under way" if session.running() else detecting.why_not(context)
        if why:
            cls.poll_message_set(why)
        return not why

    def doing(self):
        return scan_runs.COMPLETE_SCAN

    def _finished(self, root):
        self.report({"INFO"}, describe(root.fcn_result))
        return {"FINISHED"}
