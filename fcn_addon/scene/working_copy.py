# SPDX-License-Identifier: GPL-3.0-or-later
"""A scan as arrays, on request through a smaller copy of it that is gone afterwards."""

from __future__ import annotations

from contextlib import contextmanager

import bpy

from . import reader


def read(item, context, faces=None):
    """Points (n, 3) float64 and triangles (m, 3) int64 of a mesh object, evaluated, in world space.

    Parameters
    ----------
    faces : about how many triangles a copy that is read instead has, None to read the object itself

    Notes
    -----
    The copy is made in the main thread: Blender's modifiers run nowhere else. The object is not changed.
    """
    depsgraph = context.evaluated_depsgraph_get()
    if faces is None:
        return reader.read_surface(item, depsgraph)
    with _copy(item, item.evaluated_get(depsgraph), context, depsgraph) as copy:
        modifier = copy.modifiers.new("Decimate", "DECIMATE")
        modifier.ratio = min(1.0, faces / max(len(copy.data.loop_triangles), 1))
        context.view_layer.update()
        return reader.read_surface(copy, context.evaluated_depsgraph_get())


@contextmanager
def _copy(item, evaluated, context, depsgraph):
    """An object with what the modifiers of another leave, at the same place; gone at the end."""
    mesh = bpy.data.meshes.new_from_object(evaluated, depsgraph=depsgraph)
    copy = None
    try:
        mesh.calc_loop_triangles()
        copy = bpy.data.objects.new(item.name, mesh)
        copy.matrix_world = evaluated.matrix_world.copy()
        context.scene.collection.objects.link(copy)
        yield copy
    finally:
        if copy is not None:
            bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
        context.view_layer.update()
