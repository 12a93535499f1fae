# SPDX-License-Identifier: GPL-3.0-or-later
"""Says that a setting has changed; who wants to know listens."""

from __future__ import annotations

RUN, DETECTION = "a setting of a run", "a threshold of detection"

_listeners = {RUN: [], DETECTION: []}


def listen(function, what=RUN):
    """Call a function without arguments whenever such a setting changes."""
    _listeners[what].append(function)


def forget(function):
    """Call it no more; harmless where it does not listen."""
    for functions in _listeners.values():
        if function in functions:
            functions.remove(function)


def update(_group, _context):
    """Called by Blender when a setting of a run changes."""
    _tell(RUN)


def update_detection(_group, _context):
    """Called by Blender when a threshold of detection changes."""
    _tell(DETECTION)


def _tell(what):
    for function in tuple(_listeners[what]):
        function()
