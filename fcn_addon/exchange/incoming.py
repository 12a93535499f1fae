# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of files as edge meshes in the scene."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from ...core.files.formats import read_curves
from .. import colours
from ..scene.curve_data import EDGE_LENGTH, STRENGTH, mesh_data


def add(context, path):
    """The curves of a file (.txt of CGAL or CrestCODE, .obj, .ply) as a selected edge mesh. Raises InputError."""
    reading = read_curves([path])
    return add_curves(context, Path(path).stem, reading.curves, reading.edge_length)


def add_curves(context, name, curves, edge_length=None):
    """Curves as an edge mesh about their middle, selected and active in the collection of the context."""
    centre = 0.5 * (curves.points.min(axis=0) + curves.points.max(axis=0))
    mesh = mesh_data(name, curves, curves.points - centre)
    if curves.strength is not None:
        strength = mesh.attributes.new(STRENGTH, "FLOAT", "POINT")
        strength.data.foreach_set("value", curves.strength.astype(np.float32))
    item = bpy.data.objects.new(name, mesh)
    item.location = centre
    item.color = (*colours.DETECTED, 1.0)
    if edge_length:
        item[EDGE_LENGTH] = float(edge_length)
    place(context, item)
    return item


def place(context, item, select=True):
    """Link a new object to the collection of the context, and select it alone."""
    context.collection.objects.link(item)
    if select:
        for other in context.selected_objects:
            other.select_set(False)
        item.select_set(True)
        context.view_layer.objects.active = item
