# SPDX-License-Identifier: GPL-3.0-or-later
"""A scan as arrays, on request through a smaller copy of it that is gone afterwards."""

from __future__ import annotations

import bpy
import numpy as np

from .geometry import read_mesh
from .reader import read_surface


def read(item, context, faces=None):
    """Points (n, 3) float64 and triangles (m, 3) int64 of all faces that an object shows, in world space.

    Parameters
    ----------
    faces : about how many triangles a copy that is read instead has, None to read the object itself

    Notes
    -----
    The copy is made in the main thread: Blender's modifiers run nowhere else. The object is not changed.
    """
    points, triangles = read_surface(item, context.evaluated_depsgraph_get())
    if faces is None:
        return points, triangles
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))  # Blender's meshes have float32
    points, triangles = _decimated(points - middle, triangles, min(1.0, faces / max(len(triangles), 1)))
    return points + middle, triangles


def _decimated(points, triangles, ratio):
    """The surface through Blender's Decimate modifier, in a scene of its own."""
    mesh = bpy.data.meshes.new("Copy")
    scene = bpy.data.scenes.new("Copy")
    copy = bpy.data.objects.new("Copy", mesh)
    try:
        _fill(mesh, points, triangles)
        scene.collection.objects.link(copy)
        copy.modifiers.new("Decimate", "DECIMATE").ratio = ratio
        layer = scene.view_layers[0]
        layer.update()
        surface = read_mesh(copy.evaluated_get(layer.depsgraph).data).surface
        return surface.points, surface.triangles
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)


def _fill(mesh, points, triangles):
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32).ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    mesh.update(calc_edges=True)
