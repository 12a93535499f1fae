# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading curves from a .blend file and writing a result to one, without a window.

Both replace what is open, so they are for the command line alone.
"""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from ...core.errors import InputError
from ..detected import edge_mesh
from ..result import writer
from ..scans import Scan
from ..scene import reader


def read(path, objects=(), collections=(), say=lambda line: None) -> list:
    """The curves of a file as one Reading, then its scans, a Scan each.

    Parameters
    ----------
    objects, collections : names; without any, all curve objects of the scene are read, and its meshes with faces
        where it has no curves
    say : called with a line where both are there
    """
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
        inside = _curves_or_scans(_named(path, bpy.data.collections, "collection", name).all_objects, path, say)
        if not inside:
            raise InputError(f"{path}: collection {name!r} holds no edge mesh, curve object or mesh with faces")
        chosen += inside
    if not objects and not collections:
        chosen = _curves_or_scans(bpy.context.scene.objects, path, say)
    if not chosen:
        raise InputError(f"{path}: no edge mesh or curve object in its scene, nor a scan; name one with --object")
    chosen = list(dict.fromkeys(chosen))
    _show(chosen)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    surfaces = [item for item in chosen if reader.is_surface(item)]
    curves = [item for item in chosen if item not in surfaces]
    try:
        found = [reader.read_objects(curves, depsgraph).reading] if curves else []
        for item in surfaces:
            found.append(Scan(f"{path}: object {item.name!r}", *reader.read_surface(item, depsgraph)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return found


def _curves_or_scans(objects, path, say):
    """The curve objects among these, or where there are none the meshes with faces."""
    objects = list(objects)
    curves = reader.curve_objects(objects)
    surfaces = [item for item in objects if reader.is_surface(item)]
    if curves and surfaces:
        say(f"{path} has curves and meshes with faces: the curves are taken; name a scan with --object to detect it")
    return curves or surfaces


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
    writer.write(completion, curves, source=source, scene=bpy.context.scene)
    _save(path)


def write_detected(detected, path, source):
    """Save detected curves as a .blend file that holds an edge mesh for each scan and nothing else."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for d in detected:
        name = source if len(detected) == 1 else Path(d.name).stem
        bpy.context.scene.collection.objects.link(edge_mesh.make(f"{name} curves", d.found))
    _save(path)


def _save(path):
    for screen in bpy.data.screens:
        for area in screen.areas:
            for space in (s for s in area.spaces if s.type == "VIEW_3D"):
                space.shading.wireframe_color_type = space.shading.color_type = "OBJECT"
    Path(path).unlink(missing_ok=True)  # Blender would keep what stands there as a backup beside it
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(path).resolve()), copy=True, check_existing=False)
