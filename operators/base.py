# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common."""

from __future__ import annotations

import bpy

from ..core.errors import Cancelled, InputError
from ..fcn_addon.job import session
from ..fcn_addon.result import selection, stored
from ..fcn_addon.scene import viewports
from ..fcn_addon.wording import LEAVE_EDIT_MODE

TICK = 0.1  # seconds between two looks at the thread


NO_RESULT = "No result: complete curves first"


class Polled:
    """Says what is missing where it cannot run: operators have why_not(context) -> words, None if nothing is."""

    @classmethod
    def poll(cls, context):
        why = cls.why_not(context)
        if why:
            cls.poll_message_set(why)
        return not why


class Idle(Polled):
    """Needs that no run is under way, and what `asked`, a module, says with why_not(context)."""

    asked = None

    @classmethod
    def why_not(cls, context):
        return "A run is under way" if session.running() else cls.asked.why_not(context)


class Background(Idle):
    """Runs what `kind` says in a thread, watched by a timer; at once where there is no window.

    Operators have kind() -> session.RunKind, and _finished(made), which reports and returns {"FINISHED"}.
    """

    def execute(self, context):
        """At once, for scripts and where there is no window."""
        try:
            return self._finished(session.run_now(context, self.kind()))
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.run = session.begin(context, self.kind())
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
            made = self.run.kind.finish(context, self.run.task, session.outcome(self.run))
        except Cancelled:
            self.report({"INFO"}, "Stopped; nothing was changed")
            return {"CANCELLED"}
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        viewports.show_object_colours(context)
        return self._finished(made)


def enter_edit_mode(label):
    """Go into edit mode, as a step of undo of its own after one that holds what was done before.

    In edit mode Blender's steps of undo hold the edited data alone; without a whole one before it, a view or a
    selection that was changed on the way would never be taken back.
    """
    if not bpy.app.background:
        bpy.ops.ed.undo_push(message=label)
    bpy.ops.object.mode_set(mode="EDIT")


class OnOccurrence(Polled):
    """Needs a selected curve of an occurrence, in object mode; says so where there is none."""

    @classmethod
    def why_not(cls, context):
        if context.mode != "OBJECT":
            return LEAVE_EDIT_MODE
        if not any(map(selection.is_of_occurrence, context.selected_objects)):
            return "Select a curve of an occurrence"
        return None


class OnTransformation(Polled):
    """Needs an active transformation of a result, in object mode; says so where there is none."""

    @classmethod
    def why_not(cls, context):
        if context.mode != "OBJECT":
            return LEAVE_EDIT_MODE
        found = stored.active_transformation(context.scene) is not None
        return None if found else "No transformation: complete curves first"


class OnResult(Polled):
    """Needs a result, in object mode; says so where there is none."""

    @classmethod
    def why_not(cls, context):
        if context.mode != "OBJECT":
            return LEAVE_EDIT_MODE
        return None if stored.active(context.scene) is not None else NO_RESULT
