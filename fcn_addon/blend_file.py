# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading curves from a .blend file and writing a result to one, without a window.

Both replace what is open, so they are for the command line alone.
"""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ..core.errors import InputError
from . import scene_reader, scene_writer


def read(path, objects=(), collections=()):
    """Curves of the named objects and collections of a file, or of all curve objects of its scene; a Reading."""
    if not os.path.isfile(path):
        raise InputError(f"{path}: no such file; check the path")
    try:
        # Scripts in the file stay off: it may come from anywhere.
        bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = " ".join(str(error).removeprefix("Error:").split())
        raise InputError(f"{path}: Blender cannot open it ({reason}); was it cut off?") from None
    chosen = [_named(path, bpy.data.objects, "object", name) for name in objects]
    for name in collections:
        inside = scene_reader.curve_objects(_named(path, bpy.data.collections, "collection", name).all_objects)
        if not inside:
            raise InputError(f"{path}: collection {name!r} holds no edge mesh or curve object")
        chosen += inside
    if not objects and not collections:
        chosen = scene_reader.curve_objects(bpy.context.scene.objects)
    if not chosen:
        raise InputError(f"{path}: no edge mesh or curve object in its scene; name one with --object")
    chosen = list(dict.fromkeys(chosen))
    _show(chosen)
    try:
        return scene_reader.read_objects(chosen, bpy.context.evaluated_depsgraph_get()).reading
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _named(path, items, what, name):
    if name not in items:
        known = ", ".join(repr(item.name) for item in list(items)[:8]) or "none"
        raise InputError(f"{path}: no {what} {name!r}; it has {known}")
    return items[name]


def _show(objects):
    """Make sure that all are evaluated, which Blender leaves out for what is hidden or in no scene."""
    shown = bpy.data.collections.new("Shown")
    bpy.context.scene.collection.children.link(shown)
    for item in objects:
        item.hide_viewport = False
        shown.objects.link(item)
    bpy.context.view_layer.update()


def write(completion, curves, path, source):
    """Save a result as a .blend file that holds nothing else."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene_writer.write(completion, curves, source=source, scene=bpy.context.scene)
    for screen in bpy.data.screens:
        for area in screen.areas:
            for space in (s for s in area.spaces if s.type == "VIEW_3D"):
                space.shading.wireframe_color_type = space.shading.color_type = "OBJECT"
    Path(path).unlink(missing_ok=True)  # Blender would keep what stands there as a backup beside it
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(path).resolve()), copy=True, check_existing=False)
