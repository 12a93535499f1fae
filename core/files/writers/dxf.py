# SPDX-License-Identifier: GPL-3.0-or-later
"""A plan as DXF: a block for each symbol, an insert for each of its places, a layer for each kind."""

from __future__ import annotations

import numpy as np

from ..readers.dxf import require_ezdxf
from .plan import Plan, Stroke

METRES = 6
"""The code of the unit that a scene has."""


def write_dxf(path, plan: Plan, *, units=METRES):
    """Write a plan; every point is where it belongs within rounding, 1e-9 of the extent of the plan and less.

    An insert has a normal, a turn about it and a place, so that it can stand at any rigid pose; its block is 3D.

    Parameters
    ----------
    units : DXF's code of the unit of all coordinates; 6 are metres, 4 millimetres

    Raises InputError where ezdxf is missing.
    """
    ezdxf = require_ezdxf()
    document = ezdxf.new("R2010", units=units)
    for name, colour in plan.layers.items():
        document.layers.add(name).rgb = tuple(int(round(255 * c)) for c in colour)
    space = document.modelspace()
    for layer, stroke in plan.strokes:
        _add(space, stroke, layer)
    for symbol in plan.symbols:
        block = document.blocks.new(symbol.name)
        for stroke in symbol.strokes:
            _add(block, stroke, "0")  # has the layer of the insert, and its colour
        for pose in symbol.poses:
            place, turned = _insertion(pose)
            space.add_blockref(symbol.name, place, dxfattribs={"layer": symbol.layer, **turned})
    _show_all(document, plan.placed())
    document.saveas(path)


def _add(space, stroke: Stroke, layer):
    """Add a stroke to a layout: its primitives where it has any, else a line or a polyline."""
    attributes = {"layer": layer}
    for piece in stroke.primitives:
        _add_primitive(space, piece, attributes)
    if stroke.primitives:
        return
    points = np.asarray(stroke.points, float).tolist()
    if len(points) == 2:
        space.add_line(*points, dxfattribs=attributes)
    else:
        space.add_polyline3d(points, close=stroke.closed, dxfattribs=attributes)


def _add_primitive(space, piece, attributes):
    if piece.kind == "line":
        space.add_line(_triple(piece.start), _triple(piece.end), dxfattribs=attributes)
    elif piece.kind in ("arc", "circle"):
        axes = _arbitrary_axes(piece.normal)
        centre, radius = _triple(axes @ piece.centre), float(piece.radius)
        attributes = {**attributes, "extrusion": _triple(piece.normal)}
        if piece.kind == "circle":
            space.add_circle(centre, radius, dxfattribs=attributes)
            return
        x, y, _ = axes @ (piece.start - piece.centre)
        first = float(np.degrees(np.arctan2(y, x)))
        space.add_arc(centre, radius, first, first + float(np.degrees(piece.angle)), dxfattribs=attributes)
    else:
        for points in piece.beziers():
            space.add_open_spline(np.asarray(points, float).tolist(), degree=3, dxfattribs=attributes)


def _triple(point):
    return tuple(np.asarray(point, float).tolist())


def _insertion(pose):
    """Where an insert stands, in the axes of its normal, and its normal and turn about that."""
    normal = pose[:3, 2]
    axes = _arbitrary_axes(normal)
    x, y, _ = axes @ pose[:3, 0]
    turned = {"extrusion": _triple(normal), "rotation": float(np.degrees(np.arctan2(y, x)))}
    return _triple(axes @ pose[:3, 3]), turned


def _arbitrary_axes(normal) -> np.ndarray:
    """(3, 3) float64, the rows are the axes that DXF gives to a normal."""
    from ezdxf.math import OCS

    ocs = OCS(_triple(normal))
    return np.array([ocs.ux.xyz, ocs.uy.xyz, ocs.uz.xyz])


def _show_all(document, points):
    """Let the drawing open with all of it in view."""
    if not len(points):
        return
    low, high = points.min(axis=0), points.max(axis=0)
    document.header["$EXTMIN"], document.header["$EXTMAX"] = _triple(low), _triple(high)
    middle, size = (low + high) / 2, high - low
    document.set_modelspace_vport(float(max(size[:2].max(), 1e-9)) * 1.1, tuple(middle[:2].tolist()))
