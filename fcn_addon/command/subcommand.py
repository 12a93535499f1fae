# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `blender -c fcn`."""

from __future__ import annotations

import bpy

NAME = "fcn"

_handles = []


def run(arguments) -> int:
    """Called by Blender with the arguments that follow the command's name; the exit code."""
    from .run import main

    return main(list(arguments), prog=f"blender -c {NAME}")


def register():
    _handles.append(bpy.utils.register_cli_command(NAME, run))


def unregister():
    while _handles:
        bpy.utils.unregister_cli_command(_handles.pop())
