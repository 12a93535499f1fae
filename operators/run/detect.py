# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect the feature curves of a scan."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.job import detecting
from ..base import Background


class FCN_OT_detect(Background, bpy.types.Operator):
    """Find the ridges and valleys of the active mesh, and make an edge mesh of them that is ready to be completed.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.detect"
    bl_label = "Detect Feature Curves"
    bl_options = {"UNDO"}

    asked = detecting

    def kind(self):
        return detecting.DETECT

    def _finished(self, item):
        text = rpt_("{count} feature curves in {name!r}")
        self.report({"INFO"}, text.format(count=item.fcn_curves.total, name=item.name))
        if item.fcn_curves.remarks:
            self.report({"WARNING"}, item.fcn_curves.remarks)
        return {"FINISHED"}
