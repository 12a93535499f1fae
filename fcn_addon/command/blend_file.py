# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading curves and scans of a .blend file, or of what Blender imports, and writing a result to a .blend.

All of it replaces what is open, so it is for the command line alone.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path

import bpy
import numpy as np

from ...core.errors import InputError, NoCurves
from ..detected import edge_mesh
from ..reading import left_out, reader
from ..reading.left_out import LeftOut
from ..result import stored, views, writer
from ..result.views import ROLE
from ..scans import Scan
from ..scene import importers, origin
from ..scene.families import within
from ..scene.libraries import require_libraries
from ..scene.units import metres, unit_length
from ..shifts import moved_completion, moved_curves, moved_fitted, shift_for

GEOMETRY = {*reader.CURVE_TYPES, "MESH", "SURFACE", "META"}


@dataclass(frozen=True)
class Choice:
    """What to take of a scene.

    objects, collections : names; without any, what the scene shows: its curves, and its scans where it has none
    hidden : take what is hidden too
    take_edges : of meshes with faces and loose edges take the edges
    """

    objects: tuple[str, ...] = ()
    collections: tuple[str, ...] = ()
    hidden: bool = False
    take_edges: bool = False


def read(path, choice=None, say=lambda line: None):
    """The curves of a file as one Reading, then its scans, a Scan for each object; what is LeftOut; the scene's shift.

    The shift, (3,) float64, is already in the coordinates.

    Parameters
    ----------
    say : called with a line where something is left out
    """
    choice = choice or Choice()
    if not os.path.isfile(path):
        raise InputError(f"{path}: no such file; check the path")
    remark = _open(path)
    try:
        require_libraries()
        found, skipped = _of_scene(path, choice)
        shift = origin.of(bpy.context.scene)
    except InputError as error:
        raise type(error)(f"{path}: {error}") from None
    if remark:
        say(remark)
    if skipped:
        say(f"{path}: {skipped.line()}")
    return [_moved(part, shift) for part in found], skipped, shift


def unit():
    """How many metres a unit of the open scene is, None where it has none, and what words a length in it."""
    return metres(bpy.context.scene), unit_length(bpy.context.scene)


def _moved(part, shift):
    """A Reading or a Scan moved by (3,)."""
    if isinstance(part, Scan):
        return replace(part, points=part.points + shift)
    return replace(part, curves=moved_curves(part.curves, shift))


def _open(path) -> str:
    """Open or import a file; what is to be said of it."""
    if Path(path).suffix.lower() != ".blend":
        return importers.open_file(path)
    try:
        # Scripts in the file stay off: it may come from anywhere.
        bpy.ops.wm.open_mainfile(filepath=str(Path(path).resolve()), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = " ".join(str(error).removeprefix("Error:").split())
        raise InputError(f"{path}: Blender cannot open it ({reason}); was it cut off?") from None
    return ""


def _of_scene(path, choice):
    """The Reading and the Scans of the open file, and what is LeftOut."""
    named = bool(choice.objects or choice.collections)
    chosen = [_named(bpy.data.objects, "object", name) for name in choice.objects]
    for name in choice.collections:
        chosen += _named(bpy.data.collections, "collection", name).all_objects
    skipped = LeftOut()
    if not named:
        own = _own_results()
        chosen = list(bpy.context.scene.objects)
        skipped = LeftOut(tuple((item.name, left_out.OWN) for item in chosen if item in own))
        skipped += LeftOut(tuple((item.name, left_out.ELSEWHERE) for item in _elsewhere()))
        chosen = [item for item in chosen if item not in own]
    chosen = list(dict.fromkeys(chosen))
    if choice.hidden or named:
        _show(chosen)
    read = reader.read(chosen, bpy.context.evaluated_depsgraph_get(), take_edges=choice.take_edges)
    skipped = read.left_out + skipped
    found = [] if read.reading is None else [read.reading]
    if read.reading is not None and not choice.objects:
        skipped += LeftOut(tuple((read.names[i], left_out.SCAN) for i in read.surfaces))
    else:
        found += [Scan(f"{path}: object {read.names[i]!r}", *surface) for i, surface in read.surfaces.items()]
    if not found:
        raise NoCurves(_nothing(choice, skipped))
    return found, skipped


def _nothing(choice, skipped) -> str:
    """Why there is no input."""
    said = f" ({skipped.line()})" if skipped else ""
    names = [*(f"object {n!r}" for n in choice.objects), *(f"collection {n!r}" for n in choice.collections)]
    where = " and ".join(names) if names else "the scene"
    return f"{where} shows no curves and no faces{said}; give edge meshes, curve objects, or a scan"


def _own_results() -> set:
    """The objects of results that this program has made."""
    roots = {c for c in bpy.data.collections if any(ROLE in child for child in c.children)}
    return {item for root in roots for item in within(root)}


def _elsewhere() -> list:
    """Objects with geometry of other scenes than the one that is open."""
    here = set(bpy.context.scene.objects)
    others = (item for scene in bpy.data.scenes for item in scene.objects if item not in here)
    return list(dict.fromkeys(item for item in others if item.data is not None and item.type in GEOMETRY))


def _named(items, what, name):
    if name not in items:
        known = ", ".join(repr(item.name) for item in list(items)[:8]) or "none"
        raise InputError(f"no {what} {name!r}; it has {known}")
    return items[name]


def _show(objects):
    """Make sure that all are evaluated, which Blender leaves out for what is hidden or in no scene."""
    shown = bpy.data.collections.new("Shown")
    bpy.context.scene.collection.children.link(shown)
    for item in objects:
        item.hide_viewport = False
        shown.objects.link(item)
    bpy.context.view_layer.update()
    for item in objects:
        item.hide_set(False)
    bpy.context.view_layer.update()


@dataclass(frozen=True)
class Made:
    """What is kept of a run on its result: what it was called, its parameters, and what was LeftOut."""

    label: str
    parameters: object
    left_out: LeftOut = LeftOut()
    sources: tuple = ()


def write(completion, curves, path, made, shift=None, *, fitted=None):
    """Save a result as a .blend file that holds nothing else, about its origin: as the window would have made it.

    fitted : FittedCompletion, for curves with handles; dense ones if None
    shift : (3,), where the origin of the scene that the curves come from lies, None for (0, 0, 0); where they are far
        from it, the result gets an origin nearer to them
    """
    shift = _shift(curves.points, shift)
    scene = _empty_scene(shift)
    completion = moved_completion(completion, -shift)
    root = writer.write(
        completion, moved_curves(curves, -shift), source=made.label, scene=scene,
        form="DENSE" if fitted is None else "HANDLES",
        fitted=None if fitted is None else moved_fitted(fitted, -shift),
    )  # fmt: skip
    with stored.known():
        stored.describe(root, completion, made, unit_length(scene))
        origin.keep(root, shift)
        views.refresh(root)
        _save(path)


def write_detected(detected, path, source, shift=None):
    """Save detected curves as a .blend file with an edge mesh for each scan and nothing else, about its origin."""
    shift = _shift(np.concatenate([d.found.curves.points for d in detected]), shift)
    scene = _empty_scene(shift)
    for d in detected:
        name = source if len(detected) == 1 else Path(d.name).stem
        scene.collection.objects.link(edge_mesh.make(f"{name} curves", d.found, shift))
    _save(path)


def _shift(points, given):
    """The shift that is given, and what must be added to it to come near the origin."""
    given = np.zeros(3) if given is None else np.asarray(given, float)
    return given + shift_for(points - given)


def _empty_scene(shift):
    """The scene of a new file."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    origin.keep(bpy.context.scene, shift)
    return bpy.context.scene


def _save(path):
    for screen in bpy.data.screens:
        for area in screen.areas:
            for space in (s for s in area.spaces if s.type == "VIEW_3D"):
                space.shading.wireframe_color_type = space.shading.color_type = "OBJECT"
    Path(path).unlink(missing_ok=True)  # Blender would keep what stands there as a backup beside it
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(path).resolve()), copy=True, check_existing=False)
