# SPDX-License-Identifier: GPL-3.0-or-later
"""Count what a run would use."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.job import chosen, summary
from ..base import Idle


class FCN_OT_measure(Idle, bpy.types.Operator):
    """Count the chosen curves and estimate their edge length and the time that a run takes"""

    bl_idname = "fcn.measure"
    bl_label = "Measure Curves"

    asked = chosen

    def execute(self, context):
        found = summary.compute(context, force=True)
        if isinstance(found, str):
            self.report({"ERROR"}, found)
            return {"CANCELLED"}
        text = rpt_("{curves} curves, {samples} samples, {strong} strong curves")
        self.report({"INFO"}, text.format(curves=found.curves, samples=found.samples, strong=found.strong))
        return {"FINISHED"}
