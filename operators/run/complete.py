# SPDX-License-Identifier: GPL-3.0-or-later
"""Complete the chosen curves."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...fcn_addon.job import chosen, completing
from ...fcn_addon.wording import counted, duration
from ..base import Background


class Completing(Background):
    """Ends with a result and a line about it."""

    def _finished(self, root):
        self.report({"INFO"}, describe(root.fcn_result))
        return {"FINISHED"}


class FCN_OT_complete(Completing, bpy.types.Operator):
    """Find what recurs in the chosen curves, and make clean templates of it wherever it was seen.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.complete"
    bl_label = "Complete Curves"
    bl_options = {"UNDO"}

    asked = chosen

    def kind(self):
        return completing.COMPLETE


def describe(result) -> str:
    """A line about a result."""
    text = rpt_("{templates} at {places}, {strong}; {time}")
    said = text.format(
        templates=counted(result.templates, "template"),
        places=counted(result.occurrences, "place"),
        strong=counted(result.strong, "single curve"),
        time=duration(result.seconds),
    )
    if result.left_out:
        said += "; " + rpt_("left out: {objects}").format(objects=result.left_out)
    return said
