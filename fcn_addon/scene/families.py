# SPDX-License-Identifier: GPL-3.0-or-later
"""The children of many objects, and the objects of a tree of collections, without a walk for each."""

from __future__ import annotations

import bpy


def children(parents) -> dict:
    """Object -> list of its children, for each of `parents`.

    Notes
    -----
    O(objects of the file), as `Object.children` is for a single one: asked of each in turn, it would be the square.
    """
    found = {item: [] for item in parents}
    for item in bpy.data.objects:
        if item.parent in found:
            found[item.parent].append(item)
    return found


def within(collection) -> list:
    """All objects of a collection and of those in it, each once.

    Notes
    -----
    O(objects). `Collection.all_objects` is built anew after each change, and 4.2 searches its list for every object.
    """
    tree = (collection, *collection.children_recursive)
    return list(dict.fromkeys(item for one in tree for item in one.objects))
