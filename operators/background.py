# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common that work in the background."""

from __future__ import annotations

import bpy

from ..core.errors import Cancelled, InputError
from ..fcn_addon import session, viewports

TICK = 0.1  # seconds between two looks at the thread


class Background:
    """Runs what `doing` says in a thread, watched by a timer; at once where there is no window.

    Operators have doing() -> session.Doing, and _finished(made), which reports and returns {"FINISHED"}.
    """

    def execute(self, context):
        """At once, for scripts and where there is no window."""
        try:
            return self._finished(session.run_now(context, doing=self.doing()))
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.run = session.begin(context, self.doing())
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
            made = self.run.doing.finish(context, self.run.task, session.outcome(self.run))
        except Cancelled:
            self.report({"INFO"}, "Stopped; nothing was changed")
            return {"CANCELLED"}
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        viewports.show_object_colours(context)
        return self._finished(made)
