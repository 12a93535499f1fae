# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run is about: the objects chosen in the scene, their curves and the edge length."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ..core.errors import InputError
from ..core.files.network import Reading
from ..core.parameters import Parameters
from . import properties, results, scene_reader
from .identity import Identity


@dataclass(frozen=True)
class Task:
    """All that a run needs, taken from the scene at once; nothing in it is Blender's.

    owner : (reading.count,) int64, which of `sources` each input curve comes from
    edge_length : scene units, None to estimate it
    replace : remove the earlier result of the same curves
    """

    label: str
    scene: Identity
    sources: tuple[Identity, ...]
    reading: Reading
    owner: np.ndarray
    edge_length: float | None
    parameters: Parameters
    replace: bool


def take(context, hidden=True) -> Task:
    """Read what the settings choose. Raises InputError where that cannot be used.

    hidden : evaluate hidden objects too, for which they are shown for a moment; otherwise they are read as they were
    """
    settings = context.scene.fcn
    why = why_not(context)
    if why:
        raise InputError(why)
    objects = chosen(context)
    with _shown(context, objects if hidden else ()):
        depsgraph = context.evaluated_depsgraph_get()
        read = scene_reader.read_objects(objects, depsgraph)
        unit = edge_length(context, depsgraph) or read.reading.edge_length
    return Task(
        label(context, objects),
        Identity.of(context.scene),
        tuple(Identity.of(item) for item in objects),
        read.reading,
        read.owner,
        unit,
        properties.parameters(settings.parameters),
        settings.earlier == "REPLACE",
    )


@contextmanager
def _shown(context, objects):
    """Show for a moment the objects that are hidden in any of Blender's ways: it does not evaluate those."""
    hidden = [item for item in objects if not item.visible_get()]
    if not hidden:
        yield
        return
    off = [item for item in hidden if item.hide_viewport]
    shut = [item for item in hidden if item.hide_get()]
    home = bpy.data.collections.new("Shown")
    try:
        context.scene.collection.children.link(home)
        for item in hidden:
            home.objects.link(item)
            item.hide_viewport = False
        context.view_layer.update()
        for item in shut:
            item.hide_set(False)
        yield
    finally:
        for item in shut:
            item.hide_set(True)
        for item in off:
            item.hide_viewport = True
        bpy.data.collections.remove(home)
        context.view_layer.update()


def why_not(context) -> str | None:
    """What is missing for a run, None if nothing is. Cheap: it is asked at every redraw."""
    settings = context.scene.fcn
    if context.mode != "OBJECT":
        return "Leave the edit mode first"
    if settings.source == "COLLECTION":
        if settings.collection is None:
            return "Choose the collection that holds the curves"
        if not _any(_of_collection(settings.collection)):
            return "The collection holds no edge mesh or curve object"
    elif not _any(_selected(context)) and not _again(context):
        return "Select curves or edge meshes"
    if settings.edge_length_from == "SCAN" and scan(context) is None:
        return "Choose the scan that the edge length is measured on"
    return None


def _selected(context) -> list:
    """The selected objects, without the completed curves: who has selected those means to work with the result."""
    return [item for item in context.selected_objects if "support" not in item]


def _of_collection(collection):
    """The objects of a collection and of those inside it, without results that a user has put there."""
    made = {item for root in collection.children_recursive if root.fcn_result.is_result for item in root.all_objects}
    return [item for item in collection.all_objects if item not in made]


def _any(objects):
    return any(scene_reader.curve_objects([item]) for item in objects)


def chosen(context) -> list:
    """The objects to complete, in a steady order."""
    settings = context.scene.fcn
    if settings.source == "COLLECTION":
        objects = _of_collection(settings.collection) if settings.collection else ()
    else:
        selected = _selected(context)
        objects = selected if _any(selected) else _again(context)
    return sorted(dict.fromkeys(scene_reader.curve_objects(objects)), key=lambda item: item.name)


def is_again(context) -> bool:
    """Whether no other curves are selected, so that a run would repeat that of the active result."""
    return context.scene.fcn.source == "SELECTION" and not _any(_selected(context)) and bool(_again(context))


def _again(context) -> list:
    """The objects that the active result was made of, none if one is missing."""
    root = results.active(context.scene)
    if root is None:
        return []
    found = [context.view_layer.objects.get(name) for name in results.source_names(root)]
    return [] if None in found else found


def label(context, objects) -> str:
    """What the result is called after."""
    settings = context.scene.fcn
    if settings.source == "COLLECTION":
        return settings.collection.name
    if is_again(context):
        return results.active(context.scene).fcn_result.source
    main = context.active_object if context.active_object in objects else objects[0]
    return main.name if len(objects) == 1 else f"{main.name} and {len(objects) - 1} more"


def scan(context):
    """The object that the edge length is measured on: the one set, else the one surface that is selected."""
    settings = context.scene.fcn
    if settings.scan is not None:
        return settings.scan
    surfaces = [o for o in context.selected_objects if o.type == "MESH" and len(o.data.polygons)]
    return surfaces[0] if len(surfaces) == 1 else None


def edge_length(context, depsgraph):
    """The edge length of the settings in scene units, None where it is to be estimated."""
    settings = context.scene.fcn
    if settings.edge_length_from == "VALUE":
        return float(f"{settings.edge_length:.6g}")
    if settings.edge_length_from == "SCAN":
        return mean_edge_length(scan(context), depsgraph)
    return None


def mean_edge_length(item, depsgraph) -> float:
    """Mean length of the edges of a mesh object, evaluated and in world space."""
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.edges:
            text = rpt_("object {name!r} has no edges; choose the scan that the curves come from")
            raise InputError(text.format(name=item.name))
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        edges = np.empty(2 * len(mesh.edges), np.int32)
        mesh.edges.foreach_get("vertices", edges)
    finally:
        evaluated.to_mesh_clear()
    turn = np.array(evaluated.matrix_world, float)[:3, :3]
    points, edges = points.reshape(-1, 3) @ turn.T, edges.reshape(-1, 2)
    mean = float(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).mean())
    if not (np.isfinite(mean) and mean > 0):
        text = rpt_("object {name!r} has a mean edge length of {mean:g}; choose another scan")
        raise InputError(text.format(name=item.name, mean=mean))
    return mean


def missing(task) -> str | None:
    """What of a task has gone from the file, in words; None if all is there."""
    scene = task.scene.find(bpy.data.scenes)
    if scene is None:
        return rpt_("scene {name!r}").format(name=task.scene.name)
    for source in task.sources:
        item = source.find(bpy.data.objects)
        if item is None or item.name not in scene.objects:
            return rpt_("object {name!r}").format(name=source.name)
    return None
