# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run is about: the objects chosen in the scene, what they are called, and the edge length."""

from __future__ import annotations

from ..reading import left_out, reader, shown
from ..reading.edge_length import mean_edge_length
from ..reading.left_out import LeftOut
from ..result import stored
from ..scene.families import within
from ..wording import LEAVE_EDIT_MODE


def why_not(context) -> str | None:
    """What is missing for a run, None if nothing is. Cheap: it is asked at every redraw."""
    settings = context.scene.fcn
    if context.mode != "OBJECT":
        return LEAVE_EDIT_MODE
    if settings.source == "COLLECTION":
        if settings.collection is None:
            return "Choose the collection that holds the curves"
        of_collection = _of_collection(settings.collection)
        if not _any(context, of_collection):
            return "The collection holds no edge mesh or curve object"
        if not _any(context, _taken(context, of_collection)):
            return "All curves of the collection are hidden"
    elif not _any(context, _selected(context)) and not _again(context):
        return "Select curves or edge meshes"
    if settings.edge_length_from == "SCAN" and scan(context) is None:
        return "Choose the scan that the edge length is measured on"
    return None


def _selected(context) -> list:
    """The selected objects, without the completed curves: who has selected those means to work with the result."""
    return [item for item in context.selected_objects if "support" not in item]


def _of_collection(collection):
    """The objects of a collection and of those inside it, without results that a user has put there."""
    made = {item for root in collection.children_recursive if root.fcn_result.is_result for item in within(root)}
    return [item for item in within(collection) if item not in made]


def _taken(context, objects) -> list:
    """Those that are not hidden, all if the settings say so; what an earlier run has hidden counts as seen."""
    if context.scene.fcn.use_hidden:
        return list(objects)
    completed = {name for root in stored.of_scene(context.scene) for name in stored.source_names(root)}
    return [item for item in objects if item.visible_get() or item.name in completed]


def _curves(context, objects) -> list:
    depsgraph, take_edges = context.view_layer.depsgraph, context.scene.fcn.take_edges
    return [item for item in objects if reader.may_hold_curves(item, depsgraph, take_edges)]


def _any(context, objects):
    return any(_curves(context, [item]) for item in objects)


def chosen(context) -> list:
    """The objects to complete, in a steady order."""
    settings = context.scene.fcn
    if settings.source == "COLLECTION":
        objects = _taken(context, _of_collection(settings.collection)) if settings.collection else ()
    else:
        selected = _selected(context)
        objects = selected if _any(context, selected) else _again(context)
    return sorted(dict.fromkeys(_curves(context, objects)), key=lambda item: item.name)


def passed_over(context) -> LeftOut:
    """What was chosen and is not read: hidden objects of the collection, and text and the like by name."""
    settings = context.scene.fcn
    if settings.source != "COLLECTION":
        objects, unseen = _selected(context), []
    elif settings.collection is None:
        return LeftOut()
    else:
        every = _of_collection(settings.collection)
        objects = _taken(context, every)
        unseen = _curves(context, [item for item in every if item not in set(objects)])
    rows = [(item.name, left_out.HIDDEN) for item in unseen]
    rows += [(item.name, shown.REFUSED[item.type]) for item in objects if item.type in shown.REFUSED]
    return LeftOut(tuple(sorted(rows)))


def is_again(context) -> bool:
    """Whether no other curves are selected, so that a run would repeat that of the active result."""
    again = context.scene.fcn.source == "SELECTION" and not _any(context, _selected(context))
    return again and bool(_again(context))


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
    depsgraph = context.view_layer.depsgraph
    surfaces = [item for item in context.selected_objects if reader.evaluated_faces(item, depsgraph)]
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
    objects = set(chosen(context))
    root = next((r for r in stored.of_scene(context.scene) if objects and objects.issubset(within(r))), None)
    return None if root is None else root.fcn_result.edge_length
