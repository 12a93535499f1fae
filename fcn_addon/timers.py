# SPDX-License-Identifier: GPL-3.0-or-later
"""Something that is done a moment later; without a window timers do not fire, and nothing is."""

from __future__ import annotations

import bpy


def soon(function, seconds=0.0):
    """Call a function after so many seconds of quiet: where it waits already, it waits anew."""
    if bpy.app.background:
        return
    never(function)
    bpy.app.timers.register(function, first_interval=seconds)


def never(*functions):
    """Let functions that wait wait no more; harmless where they do not."""
    for function in functions:
        if bpy.app.timers.is_registered(function):
            bpy.app.timers.unregister(function)
