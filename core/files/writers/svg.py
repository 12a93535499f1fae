# SPDX-License-Identifier: GPL-3.0-or-later
"""A plan as SVG, seen along the normal of its main plane: a symbol for each template, a use for each of its places.

A template is seen from one side at places that differ by a shift or a turn in the plane. At others it is seen from
another side: then there is one symbol for each.
"""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

import numpy as np

from .plan import Plan, Stroke, main_plane

SAME = 1e-7
"""How far two views of a template may differ and be one, as a share of the extent of the plan."""


def write_svg(path, plan: Plan, *, width=1200):
    """Write a plan as seen along the normal of its main plane.

    Parameters
    ----------
    width : of the picture, pixels; its coordinates are scene units about its middle
    """
    placed = plan.placed()
    if not len(placed):
        placed = np.zeros((1, 3))
    axes = main_plane(placed)
    middle = (placed.min(axis=0) + placed.max(axis=0)) / 2
    flat = _flat(placed - middle, axes)
    low, size = flat.min(axis=0), np.ptp(flat, axis=0)
    extent = float(size.max()) or 1.0
    size = np.maximum(size, 1e-3 * extent)
    low, size = low - 0.03 * extent, size + 0.06 * extent
    right, up, origin = (" ".join(f"{v:.17g}" for v in row) for row in (*axes, middle))
    rows = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{width * size[1] / size[0]:.0f}" '
        f'viewBox="{low[0]:.9g} {low[1]:.9g} {size[0]:.9g} {size[1]:.9g}">',
        f"<desc>right {right}; up {up}; the origin is at {origin}</desc>",
        "<style>path { fill: none; stroke-width: 1.2px; stroke-linejoin: round; vector-effect: non-scaling-stroke }"
        "</style>",
    ]
    uses = {layer: [] for layer in plan.layers}
    for symbol in plan.symbols:
        for i, (frame, poses) in enumerate(_views(symbol, axes, SAME * extent)):
            name = symbol.name if i == 0 else f"{symbol.name}_view_{i + 1}"
            strokes = "".join(f"<path d={quoteattr(_path(s, lambda p, f=frame: p @ f.T))}/>" for s in symbol.strokes)
            rows.append(f'<symbol id={quoteattr(name)} overflow="visible">{strokes}</symbol>')
            for pose in poses:
                matrix = " ".join(f"{v:.12g}" for v in _affine(pose, frame, axes, middle))
                uses[symbol.layer].append(f'<use href={quoteattr("#" + name)} transform="matrix({matrix})"/>')
    for layer, stroke in plan.strokes:
        uses[layer].append(f"<path d={quoteattr(_path(stroke, lambda p: _flat(p - middle, axes)))}/>")
    for layer, colour in plan.layers.items():
        red, green, blue = (int(round(255 * c)) for c in colour)
        rows += [f'<g id={quoteattr(layer)} stroke="#{red:02x}{green:02x}{blue:02x}">', *uses[layer], "</g>"]
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join([*rows, "</svg>", ""]))


def _flat(points, axes) -> np.ndarray:
    """(..., 2) float64, points as SVG has them: y goes down."""
    return points @ axes.T * (1.0, -1.0)


def _views(symbol, axes, tolerance):
    """(frame (2, 3), poses) for each side from which the symbol is seen; the frame is right and up on it."""
    normal = np.cross(*axes)
    size = max(float(np.linalg.norm(s.points, axis=1).max()) for s in symbol.strokes)
    views = []
    for pose in symbol.poses:
        seen = pose[:3, :3].T @ normal
        for frame, poses in views:
            if np.linalg.norm(frame @ seen) * size <= tolerance:
                poses.append(pose)
                break
        else:
            views.append((axes @ pose[:3, :3], [pose]))
    return views


def _affine(pose, frame, axes, middle):
    """The six numbers of SVG's matrix that takes a view of a symbol to a place."""
    linear = axes @ pose[:3, :3] @ frame.T * np.array([[1.0], [-1.0]])
    shift = _flat(pose[:3, 3] - middle, axes)
    return [*linear.T.ravel(), *shift]


def _path(stroke: Stroke, flatten) -> str:
    """The data of a path element; what is no straight line or polyline is cubic Bezier curves."""
    if not stroke.primitives:
        points = flatten(stroke.points)
        return "M" + " L".join(_numbers(p) for p in points) + (" Z" if stroke.closed else "")
    parts = []
    for piece in stroke.primitives:
        if piece.kind == "line":
            parts.append(f"M{_numbers(flatten(piece.start))} L{_numbers(flatten(piece.end))}")
            continue
        segments = [flatten(segment) for segment in piece.beziers()]
        curves = " ".join("C" + " ".join(map(_numbers, segment[1:])) for segment in segments)
        parts.append(f"M{_numbers(segments[0][0])} {curves}")
    return " ".join(parts)


def _numbers(point) -> str:
    return f"{point[0]:.9g} {point[1]:.9g}"
