# SPDX-License-Identifier: GPL-3.0-or-later
"""Detected feature curves as an edge mesh with the attributes `curvature` and `kind` on its points."""

from __future__ import annotations

import bpy
import numpy as np

from . import colours, scene_writer
from .scene_reader import EDGE_LENGTH, STRENGTH

KIND = "kind"  # an int attribute of the points, index into core.detection.KINDS


def make(name, found):
    """A new object of FeatureCurves about their middle, so that float32 holds them far from the origin too.

    It is in no collection yet. On any fault nothing is left behind.
    """
    made = []
    try:
        centre = middle(found.curves.points)
        data = mesh(name, found, centre)
        made.append(data)
        item = bpy.data.objects.new(name, data)
        made.append(item)
        item.matrix_world = np.block([[np.eye(3), np.zeros((3, 1))], [centre, 1.0]]).tolist()  # columns
        item.color = (*colours.DETECTED, 1.0)
        item.show_wire = True
        item[EDGE_LENGTH] = found.edge_length
    except BaseException:
        bpy.data.batch_remove(made)
        raise
    return item


def mesh(name, found, centre):
    """A mesh of FeatureCurves with `centre` (3,) as its origin."""
    curves = found.curves
    data = scene_writer.mesh_data(name, curves, curves.points - centre)
    try:
        strength = curves.strength.astype(np.float32)
        data.attributes.new(STRENGTH, "FLOAT", "POINT").data.foreach_set("value", strength)
        kind = np.repeat(found.kind, np.diff(curves.offsets)).astype(np.int32)
        data.attributes.new(KIND, "INT", "POINT").data.foreach_set("value", kind)
    except BaseException:
        bpy.data.meshes.remove(data)
        raise
    return data


def middle(points) -> np.ndarray:
    """(3,) float64, of the bounding box; zero where there is no point."""
    return 0.5 * (points.min(axis=0) + points.max(axis=0)) if len(points) else np.zeros(3)
