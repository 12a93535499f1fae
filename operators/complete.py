# SPDX-License-Identifier: GPL-3.0-or-later
"""Complete the chosen curves."""

from __future__ import annotations

import bpy

from ..fcn_addon import session, sources
from ..fcn_addon.terminal import duration
from .background import Background


class FCN_OT_complete(Background, bpy.types.Operator):
    """Find what recurs in the chosen curves, and make clean templates of it wherever it was seen.
    Works in the background, Esc stops it"""

    bl_idname = "fcn.complete"
    bl_label = "Complete Curves"
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        why = "A run is under way" if session.running() else sources.why_not(context)
        if why:
            cls.poll_message_set(why)
        return not why

    def doing(self):
        return session.COMPLETE

    def _finished(self, root):
        self.report({"INFO"}, describe(root.fcn_result))
        return {"FINISHED"}


def describe(result) -> str:
    """A line about a result."""
    return (
        f"{len(result.transformations)} transformations, {result.templates} templates at {result.occurrences}"
        f" places, {result.strong} strong curves; {duration(result.seconds)}"
    )
