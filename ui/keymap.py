# SPDX-License-Identifier: GPL-3.0-or-later
"""Shortcuts that can be set in the preferences; all are off until the user switches them on."""

from __future__ import annotations

import bpy

ENTRIES = (
    ("Object Mode", "fcn.complete", "C"),
    ("Object Mode", "fcn.select_occurrence", "W"),
    ("Object Mode", "fcn.edit_template", "E"),
    ("Object Mode", "fcn.reject_occurrence", "X"),
    ("Object Mode", "fcn.select_source", "S"),
)

_added = []


def register():
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is None:  # without a window
        return
    for name, operator, key in ENTRIES:
        keymap = keys.keymaps.new(name=name)
        item = keymap.keymap_items.new(operator, key, "PRESS", ctrl=True, alt=True, shift=True)
        item.active = False
        _added.append((keymap, item))


def unregister():
    while _added:
        keymap, item = _added.pop()
        keymap.keymap_items.remove(item)
