# SPDX-License-Identifier: GPL-3.0-or-later
"""The children of many objects at once."""

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
