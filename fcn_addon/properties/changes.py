# SPDX-License-Identifier: GPL-3.0-or-later
"""Says that a setting has changed; who wants to know listens."""

from __future__ import annotations

_listeners = []


def listen(function):
    """Call a function without arguments whenever a setting changes."""
    _listeners.append(function)


def forget(function):
    """Call it no more; harmless where it does not listen."""
    if function in _listeners:
        _listeners.remove(function)


def update(_group, _context):
    """Called by Blender when a setting changes."""
    for function in tuple(_listeners):
        function()
