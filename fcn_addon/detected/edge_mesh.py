# SPDX-License-Identifier: GPL-3.0-or-later
"""Detected feature curves as an edge mesh; its points have the attributes `curvature`, `kind`, `surface_normal`."""

from __future__ import annotations

import bpy
import numpy as np

from .. import colours
from ..scene.curve_data import EDGE_LENGTH, KIND, NORMAL, STRENGTH, fill_mesh
from ..shifts import held, held_middle


def make(name, found, shift=(0.0, 0.0, 0.0)):
    """A new object of FeatureCurves about their middle, so that float32 holds them far from the origin too.

    It is in no collection yet. On any fault nothing is left behind.

    shift : (3,), where the origin of the scene lies
    """
    made = []
    try:
        shift = np.asarray(shift, float)
        place = held(middle(found.curves.points) - shift)
        centre = place + shift
        data = mesh(name, found, centre)
        made.append(data)
        item = bpy.data.objects.new(name, data)
        made.append(item)
        item.matrix_world = np.block([[np.eye(3), np.zeros((3, 1))], [place, 1.0]]).tolist()  # columns
        item.color = (*colours.DETECTED, 1.0)
        item.show_wire = True
        item[EDGE_LENGTH] = found.edge_length
    except BaseException:
        bpy.data.batch_remove(made)
        raise
    return item


def mesh(name, found, centre):
    """A mesh of FeatureCurves with `centre` (3,) as its origin."""
    data = bpy.data.meshes.new(name)
    try:
        fill(data, found, centre)
    except BaseException:
        bpy.data.meshes.remove(data)
        raise
    return data


def fill(data, found, centre):
    """Put FeatureCurves into a mesh in place of what it holds."""
    curves = found.curves
    data.clear_geometry()
    fill_mesh(data, curves, curves.points - centre)
    for name, kind, field, values in (
        (STRENGTH, "FLOAT", "value", curves.strength.astype(np.float32)),
        (KIND, "INT", "value", curves.kind.astype(np.int32)),
        (NORMAL, "FLOAT_VECTOR", "vector", curves.normals.astype(np.float32).ravel()),
    ):
        data.attributes.new(name, kind, "POINT").data.foreach_set(field, values)


def holds(data, found, centre) -> bool:
    """Whether a mesh has the points of FeatureCurves and as many edges, as `fill` left it."""
    points = (found.curves.points - centre).astype(np.float32)
    edges = len(points) - int(np.count_nonzero(~found.curves.closed))
    if (len(data.vertices), len(data.edges)) != (len(points), edges):
        return False
    now = np.empty(points.size, np.float32)
    data.vertices.foreach_get("co", now)
    return bool(np.array_equal(now, points.ravel()))


def middle(points) -> np.ndarray:
    """(3,) float64, about that of the bounding box, as an object can stand there; zero where there is no point."""
    return held_middle(points) if len(points) else np.zeros(3)
