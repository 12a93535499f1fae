# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of files as edge meshes in the scene."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from ...core.files.formats import FORMATS, read_curves
from .. import colours
from ..installation import require_scipy
from ..scene import origin
from ..scene.curve_data import EDGE_LENGTH, STRENGTH, mesh_data
from ..shifts import held_middle, moved_curves


def add(context, path):
    """The curves of a file as a selected edge mesh, near the origin of the scene where that is shifted.

    Raises InputError.
    """
    require_scipy()
    reading = read_curves([path])
    curves = moved_curves(reading.curves, -origin.of(context.scene))
    return add_curves(context, Path(path).stem, curves, reading.edge_length)


def patterns() -> str:
    """The names of files that can hold curves, for Blender's file browser."""
    return ";".join(sorted(f"*{ending}" for form in FORMATS if form.read_curves for ending in form.endings))


def add_curves(context, name, curves, edge_length=None):
    """Curves as an edge mesh about their middle, selected and active in the collection of the context."""
    centre = held_middle(curves.points)
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
