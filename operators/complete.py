# SPDX-License-Identifier: GPL-3.0-or-later
"""Complete the chosen curves."""

from __future__ import annotations

import bpy

from ..core.errors import Cancelled, InputError
from ..fcn_addon import session, sources, viewports
from ..fcn_addon.terminal import duration

TICK = 0.1  # seconds between two looks at the thread


class FCN_OT_complete(bpy.types.Operator):
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

    def execute(self, context):
        """At once, for scripts and where there is no window."""
        try:
            return self._finished(session.run_now(context))
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.run = session.begin(context)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.run.timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        viewports.redraw_panels(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if session.current() is not self.run:  # a file was loaded, or the add-on switched off
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS" and viewports.is_over_viewport(context, event):
            session.cancel()
            viewports.redraw_panels(context)
            return {"RUNNING_MODAL"}
        if event.type == "TIMER":
            if session.tick():
                viewports.redraw_panels(context)
            if self.run.over:
                return self._end(context)
        return {"PASS_THROUGH"}

    def cancel(self, context):
        if session.current() is self.run:
            session.end(context)

    def _end(self, context):
        session.leave(context)
        viewports.redraw_panels(context)
        try:
            root = session.finish(context, self.run.task, session.outcome(self.run))
        except Cancelled:
            self.report({"INFO"}, "Stopped; nothing was changed")
            return {"CANCELLED"}
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        viewports.show_object_colours(context)
        return self._finished(root)

    def _finished(self, root):
        result = root.fcn_result
        self.report(
            {"INFO"},
            f"{len(result.transformations)} transformations, {result.templates} templates at {result.occurrences}"
            f" places, {result.strong} strong curves; {duration(result.seconds)}",
        )
        return {"FINISHED"}
