# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as Blender's data: curve data, and meshes of edges."""

from __future__ import annotations

import bpy
import numpy as np


def curve_data(name, polylines, closed):
    """Curve data with a poly spline each; without bevel."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    for points, loop in zip(polylines, closed):
        spline = data.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.c_[points, np.ones(len(points))].astype(np.float32).ravel())
        spline.use_cyclic_u = bool(loop)
    return data


def mesh_data(name, curves, points):
    """A mesh of the edges of curves, with these (n, 3) points in place of their own."""
    mesh = bpy.data.meshes.new(name)
    fill_mesh(mesh, curves, points)
    return mesh


def fill_mesh(mesh, curves, points):
    """Put the edges of curves into an empty mesh, with these (n, 3) points in place of their own."""
    edges = _edges(curves)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.edges.add(len(edges))
    mesh.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    mesh.update()


def _edges(curves) -> np.ndarray:
    """(k, 2) int64, the edges of all curves, those that close a curve last."""
    ends = np.zeros(len(curves.points), bool)
    ends[curves.offsets[1:] - 1] = True
    inner = np.flatnonzero(~ends)
    first, last = curves.offsets[:-1][curves.closed], curves.offsets[1:][curves.closed] - 1
    return np.concatenate([np.stack([inner, inner + 1], axis=1), np.stack([last, first], axis=1)])
