# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are hidden, shown for a moment: Blender does not evaluate what is hidden."""

from __future__ import annotations

from contextlib import contextmanager

import bpy


@contextmanager
def shown(context, objects):
    """Show for a moment the objects that are hidden in any of Blender's ways: it does not evaluate those."""
    hidden = [item for item in objects if not item.visible_get()]
    if not hidden:
        yield
        return
    off = [item for item in hidden if item.hide_viewport]
    shut = [item for item in hidden if item.hide_get()]
    home = bpy.data.collections.new("Shown")
    try:
        context.scene.collection.children.link(home)
        for item in hidden:
            home.objects.link(item)
            item.hide_viewport = False
        context.view_layer.update()
        for item in shut:
            item.hide_set(False)
        yield
    finally:
        for item in shut:
            item.hide_set(True)
        for item in off:
            item.hide_viewport = True
        bpy.data.collections.remove(home)
        context.view_layer.update()
