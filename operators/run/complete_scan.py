# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect the feature curves of a scan and complete them."""

from __future__ import annotations

import bpy

from ...fcn_addon.job import completing_scan, detecting
from .complete import Completing


class FCN_OT_complete_scan(Completing, bpy.types.Operator):
    """Detect the feature curves of the active mesh, find what recurs in them, and complete them, in one go.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.complete_scan"
    bl_label = "Complete Scan"
    bl_options = {"UNDO"}

    asked = detecting

    def kind(self):
        return completing_scan.COMPLETE_SCAN
