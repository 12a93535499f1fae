# SPDX-License-Identifier: GPL-3.0-or-later
"""Strokes of Grease Pencil as polylines: of the visible layers, at the current frame, under the modifiers.

Blender 4.3 replaced the data; both kinds are read.
"""

from __future__ import annotations

import numpy as np

from .drawn import needs_drawing
from .geometry import Lines, read_lines


def read_old(data) -> list:
    """Lines of each layer of evaluated data as Blender has it until 4.2; layers are already where they are drawn."""
    found = []
    for layer in data.layers:
        frame = layer.active_frame
        if not layer.hide and frame is not None and len(frame.strokes):
            points = []
            for stroke in frame.strokes:
                values = np.empty(3 * len(stroke.points), np.float32)
                stroke.points.foreach_get("co", values)
                points.append(values.reshape(-1, 3).astype(np.float64))
            offsets = np.cumsum([0] + [len(p) for p in points])
            closed = np.array([stroke.use_cyclic for stroke in frame.strokes], bool)
            found.append(Lines(np.concatenate(points), offsets.astype(np.int64), closed))
    return found


def read_new(data, world) -> list:
    """Lines of each layer of evaluated data as Blender has it from 4.3 on, and the (4, 4) matrix that the layer has.

    world : (4, 4), of the object
    """
    found = []
    for layer in data.layers:
        drawing = _drawing(layer)
        if drawing is not None:
            lines = read_lines(drawing.attributes, _sizes(drawing))
            matrix = world @ np.array(layer.matrix_local, float)
            if layer.parent is not None:
                relative = np.array(layer.matrix_parent_inverse, float) @ np.array(layer.matrix_local, float)
                matrix = np.array(layer.parent.matrix_world, float) @ relative
            found.append((lines, matrix))
    return found


def is_curved(data) -> bool:
    """Whether a stroke of a visible layer is drawn otherwise than straight from point to point."""
    drawings = [drawing for drawing in map(_drawing, data.layers) if drawing is not None]
    return any(needs_drawing(d.attributes, 0) for d in drawings)


def _drawing(layer):
    """What a layer shows, None if nothing."""
    frame = layer.current_frame()
    if layer.hide or frame is None or frame.drawing is None or not len(_sizes(frame.drawing)):
        return None
    return frame.drawing


def _sizes(drawing) -> np.ndarray:
    """Number of points of each stroke."""
    return np.diff([offset.value for offset in drawing.curve_offsets])
