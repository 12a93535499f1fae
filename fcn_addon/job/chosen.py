# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run is about: the objects chosen in the scene, what they are called, and the edge length."""

from __future__ import annotations

from ..result import stored
from ..scene import reader
from ..scene.edge_length import mean_edge_length


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
    return any(reader.curve_objects([item]) for item in objects)


def chosen(context) -> list:
    """The objects to complete, in a steady order."""
    settings = context.scene.fcn
    if settings.source == "COLLECTION":
        objects = _of_collection(settings.collection) if settings.collection else ()
    else:
        selected = _selected(context)
        objects = selected if _any(selected) else _again(context)
    return sorted(dict.fromkeys(reader.curve_objects(objects)), key=lambda item: item.name)


def is_again(context) -> bool:
    """Whether no other curves are selected, so that a run would repeat that of the active result."""
    return context.scene.fcn.source == "SELECTION" and not _any(_selected(context)) and bool(_again(context))


def _again(context) -> list:
    """The objects that the active result was made of, none if one is missing."""
    root = stored.active(context.scene)
    if root is None:
        return []
    found = [context.view_layer.objects.get(name) for name in stored.source_names(root)]
    return [] if None in found else found


def label(context, objects) -> str:
    """What the result is called after."""
    settings = context.scene.fcn
    if settings.source == "COLLECTION":
        return settings.collection.name
    if is_again(context):
        return stored.active(context.scene).fcn_result.source
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
    return _of_result(context)


def _of_result(context):
    """The edge length of the run that all chosen objects were made in, None where that is not one run.

    A repeated run takes what its own objects know, or estimates it as it did before.
    """
    if is_again(context):
        return None
    found = {_run_of(context.scene, item) for item in chosen(context)}
    root = found.pop() if len(found) == 1 else None
    return root.fcn_result.edge_length if root is not None else None


def _run_of(scene, item):
    """The result that an object belongs to, None if it is of none."""
    return next((root for root in stored.of_scene(scene) if item.name in root.all_objects), None)
