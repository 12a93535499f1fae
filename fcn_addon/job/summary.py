# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run would use: computed a moment after the selection or the settings change, never while drawing."""

from __future__ import annotations

from dataclasses import replace

import bpy

from ...core.errors import InputError
from .. import timers
from ..scene import viewports
from . import chosen, completing, session
from .estimate import summarise

DELAY = 0.3  # seconds of quiet before it is looked at
LARGEST = 400_000  # vertices; above this many it waits for the button


_latest = None  # Summary, or words that say why there is none
_key = None


def latest():
    """The Summary, or words that say why there is none, or None before anything is known."""
    return _latest


def changed():
    """Look again, soon: the settings, the selection or a chosen object has changed."""
    timers.soon(_look, DELAY)


def _look():
    if session.running():
        return DELAY
    compute(bpy.context)
    viewports.redraw(bpy.context)
    return None


def stop():
    """Forget what is known, and do not look again."""
    global _latest, _key
    timers.never(_look)
    _latest = _key = None


def watch(scene, depsgraph):
    """A handler: look again where the chosen objects, or what they are made of, have changed."""
    global _key
    context = bpy.context
    if bpy.app.background or context.mode != "OBJECT":
        return
    key = tuple(o.session_uid for o in context.selected_objects[:1000]), len(context.selected_objects)
    touched = any(update.is_updated_geometry for update in depsgraph.updates)
    if key != _key or touched:
        _key = key
        changed()


def compute(context, force=False):
    """Look at the chosen curves now; the Summary, or words that say why there is none."""
    global _latest
    try:
        why = chosen.why_not(context)
        if why:
            _latest = why
        elif not force and _size(chosen.chosen(context)) > LARGEST:
            _latest = "Many vertices: press Measure to count the curves"
        else:
            task, again = completing.take(context, hidden=False), chosen.is_again(context)
            _latest = summarise(task.reading.curves, task.edge_length, task.parameters, len(task.sources), again)
            _latest = replace(_latest, left_out=task.left_out.words())
    except InputError as error:
        _latest = str(error)
    return _latest


def _size(objects):
    return sum(len(o.data.vertices) if o.type == "MESH" else 0 for o in objects)
