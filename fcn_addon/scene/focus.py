# SPDX-License-Identifier: GPL-3.0-or-later
"""Editing a template: what else there is stays in sight, faint, or is hidden; however the editing ends, that ends too.

What the viewports were before is kept on the screens, not here: undo does not touch screens, files keep them.
"""

from __future__ import annotations

import json

import bpy
from bpy.app.handlers import persistent

from . import viewports

KEY = "fcn_focus"
FAINT = 0.75  # how far the rest fades


def begin(context, alone, frame=True):
    """Let all but the selection fade in the viewport of the context, or hide it; look at the selection."""
    end()
    found = viewports.of_context(context)
    if found is None:
        return
    window, area = found
    space = area.spaces.active
    index = list(window.screen.areas).index(area)
    before = {
        "area": index,
        "alone": alone,
        "fade": space.overlay.show_fade_inactive,
        "alpha": space.overlay.fade_inactive_alpha,
    }
    window.screen[KEY] = json.dumps(before)
    space.overlay.show_fade_inactive, space.overlay.fade_inactive_alpha = not alone, FAINT
    if alone:
        viewports.isolate(window, area, True)
    elif frame:
        viewports.frame_selected(context)


def end():
    """Give every viewport back what it was before; harmless where nothing is in focus."""
    for window in bpy.context.window_manager.windows:
        screen = window.screen
        if KEY not in screen:
            continue
        before = json.loads(screen[KEY])
        del screen[KEY]
        if before["area"] < len(screen.areas) and screen.areas[before["area"]].type == "VIEW_3D":
            area = screen.areas[before["area"]]
            overlay = area.spaces.active.overlay
            overlay.show_fade_inactive, overlay.fade_inactive_alpha = before["fade"], before["alpha"]
            if before["alone"]:
                viewports.isolate(window, area, False)


def _is_on() -> bool:
    return any(KEY in window.screen for window in bpy.context.window_manager.windows)


def _is_wanted() -> bool:
    """Whether a curve of an occurrence is being edited, however that was begun: undo and Tab lead there too."""
    item = bpy.context.active_object
    return bpy.context.mode != "OBJECT" and item is not None and item.get("occurrence", -1) >= 0


def settle():
    """Begin or end what goes with the editing."""
    if _is_wanted() and not _is_on():
        begin(bpy.context, bpy.context.scene.fcn.edit_alone, frame=False)
    elif _is_on() and not _is_wanted():
        end()


@persistent
def _after_change(*_):
    """Soon, outside the handler: what ends the local view is an operator."""
    if not bpy.app.background and _is_wanted() != _is_on() and not bpy.app.timers.is_registered(settle):
        bpy.app.timers.register(settle, first_interval=0.0)


HANDLERS = ("depsgraph_update_post", "undo_post", "redo_post", "load_post")


def register():
    for name in HANDLERS:
        getattr(bpy.app.handlers, name).append(_after_change)


def unregister():
    if bpy.app.timers.is_registered(settle):
        bpy.app.timers.unregister(settle)
    for name in HANDLERS:
        called = getattr(bpy.app.handlers, name)
        if _after_change in called:
            called.remove(_after_change)
