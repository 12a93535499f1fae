# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of all rooms: loud where one fails, and undone in reverse."""

from __future__ import annotations

from importlib import import_module

import bpy

# Each has register() and unregister(); the order is that of the imports.
ROOMS = (
    "fcn_addon.command.subcommand",
    "fcn_addon.properties.settings",
    "operators",
    "ui",
    "fcn_addon.handlers",
    "fcn_addon.scene.focus",
)

_registered = []  # what Blender holds of ours at the moment, and nothing else


def register():
    """Register every room in order; where one raises, those before it are unregistered and the error goes on."""
    root = __package__.rpartition(".")[0]
    try:
        for name in ROOMS:
            room = import_module(f"{root}.{name}")
            room.register()
            _registered.append(room)
    except BaseException:
        unregister()
        raise


def unregister():
    """Unregister what is registered, in reverse; each room is tried, the first error is raised at the end."""
    first = None
    while _registered:
        try:
            _registered.pop().unregister()
        except Exception as error:
            first = first or error
    if first is not None:
        raise first


def register_classes(classes):
    """Register classes in order; where one fails, those before it are unregistered and the error goes on."""
    done = []
    try:
        for cls in classes:
            bpy.utils.register_class(cls)
            done.append(cls)
    except BaseException:
        unregister_classes(done)
        raise


def unregister_classes(classes):
    """Unregister classes in reverse."""
    for cls in reversed(classes):
        bpy.utils.unregister_class(cls)
