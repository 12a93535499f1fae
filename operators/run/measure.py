# SPDX-License-Identifier: GPL-3.0-or-later
"""Count what a run would use."""

from __future__ import annotations

import bpy

from ...fcn_addon.job import chosen, summary
from ...fcn_addon.wording import counted
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
        numbers = ((found.curves, "curve"), (found.samples, "sample"), (found.strong, "strong curve"))
        self.report({"INFO"}, ", ".join(counted(count, thing) for count, thing in numbers))
        return {"FINISHED"}
