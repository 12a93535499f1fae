# SPDX-License-Identifier: GPL-3.0-or-later
"""The scan of a result cannot be picked while the result is there: clicks on curves would take the scan behind them.

A result keeps the names of the objects that it locked, and unlocks these alone.
"""

from __future__ import annotations

import json

import bpy


def lock(root, scans):
    """Make these objects unselectable for a result; those that already are stay out of it."""
    result = root.fcn_result
    mine = [item for item in scans if item is not None and item.library is None and not item.hide_select]
    for item in mine:
        item.select_set(False)
        item.hide_select = True
    result.locked = json.dumps(sorted({*json.loads(result.locked or "[]"), *(item.name for item in mine)}))


def unlock(root):
    """Make selectable again what a result locked."""
    _set(root.fcn_result, False)


def update(group, _context):
    """Called by Blender when the switch of a result changes."""
    _set(group, group.scan_locked)


def _set(result, locked):
    for name in json.loads(result.locked or "[]"):
        item = bpy.data.objects.get(name)
        if item is not None and item.library is None:
            item.hide_select = locked


def scans_of(sources, settings) -> list:
    """The scans that these source objects come from, and the one that the edge length was measured on."""
    named = [bpy.data.objects.get(item.fcn_curves.scan) for item in sources if item.fcn_curves.scan]
    measured = settings.scan if settings.edge_length_from == "SCAN" else None
    return [item for item in dict.fromkeys([*named, measured]) if item is not None]
