# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences by their objects, and the selection of objects."""

from __future__ import annotations

from ..scene.families import children, within
from . import stored


def is_part(item) -> bool:
    """Whether an object is a curve of an occurrence."""
    return "occurrence" in item and "support" in item and item["occurrence"] >= 0


def is_of_occurrence(item) -> bool:
    """Whether an object is a curve of an occurrence or the empty that holds it, and not of a linked file."""
    return item.get("occurrence", -1) >= 0 and item.library is None


def holders(objects) -> list:
    """The empties of the occurrences that the objects belong to."""
    found = (item.parent if is_part(item) else item for item in objects if is_of_occurrence(item))
    return [item for item in dict.fromkeys(found) if item is not None]


def parts(objects) -> list:
    """All curves of the occurrences that the objects belong to; those whose empty is gone stand for themselves."""
    whole = [child for family in children(holders(objects)).values() for child in family if is_part(child)]
    return list(dict.fromkeys([*whole, *(item for item in objects if is_part(item))]))


def of_transformation(row) -> list:
    """The objects of all occurrences of a row of the list."""
    return [] if row is None or row.home is None else list(row.home.objects)


def results_of(scene, objects) -> list:
    """The results that objects belong to."""
    objects = set(objects)
    return [root for root in stored.of_scene(scene) if not objects.isdisjoint(within(root))]


def select(context, objects, active=None) -> int:
    """Select these objects and no others; how many could be."""
    layer = context.view_layer
    for item in context.selected_objects:
        item.select_set(False)
    count, here = 0, set(layer.objects)  # looked up in the layer itself, each would walk it
    for item in objects:
        if item in here:
            item.select_set(True)
            count += item.select_get()
    if active in here:
        layer.objects.active = active
    return count
