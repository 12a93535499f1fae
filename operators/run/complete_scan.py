# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect the feature curves of a scan and complete them."""

from __future__ import annotations

import bpy

from ...fcn_addon.job import completing_scan, detecting, session
from ..base import Background
from .complete import describe


class FCN_OT_complete_scan(Background, bpy.types.Operator):
    """Detect the feature curves of the active mesh, find what recurs in them, and complete them, in one go.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.complete_scan"
    bl_label = "Complete Scan"
    bl_options = {"UNDO"}

    @classmethod
    def why_not(cls, context):
        return "A run is under way" if session.running() else detecting.why_not(context)

    def kind(self):
        return completing_scan.COMPLETE_SCAN

    def _finished(self, root):
        self.report({"INFO"}, describe(root.fcn_result))
        return {"FINISHED"}
