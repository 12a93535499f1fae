# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences by their objects, and the selection of objects."""

from __future__ import annotations

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
    whole = [child for holder in holders(objects) for child in holder.children if is_part(child)]
    return list(dict.fromkeys([*whole, *(item for item in objects if is_part(item))]))


def of_transformation(row) -> list:
    """The objects of all occurrences of a row of the list."""
    return [] if row is None or row.home is None else list(row.home.objects)


def result_of(scene, item):
    """The result that an object belongs to, None if it is of none."""
    return next((root for root in stored.of_scene(scene) if item.name in root.all_objects), None)


def select(context, objects, active=None) -> int:
    """Select these objects and no others; how many could be."""
    layer = context.view_layer
    for item in context.selected_objects:
        item.select_set(False)
    count = 0
    for item in objects:
        if item.name in layer.objects:
            item.select_set(True)
            count += item.select_get()
    if active is not None and active.name in layer.objects:
        layer.objects.active = active
    return count
