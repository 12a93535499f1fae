# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible curves of results as line segments with colours, ready to be drawn."""

from __future__ import annotations

import numpy as np

from ..scene.curve_data import spline_points
from ..scene.families import within
from . import stored


def collect(context, viewport=None):
    """Line segments of all result curves that are visible and not selected.

    Parameters
    ----------
    viewport : the space whose local view counts, by default that of the context

    Returns
    -------
    (n, 2, 3) float32 in world space, (n, 4) float32 sRGB, and the set of `session_uid` of all that they depend on

    Notes
    -----
    O(segments); objects that share their curve are handled together.
    """
    groups, known = {}, set()
    for root in stored.shown_in(context.scene):
        known.update((root.session_uid, *(c.session_uid for c in root.children_recursive)))
        for item in within(root):
            known.add(item.session_uid)
            if item.type == "CURVE":
                known.add(item.data.session_uid)
                if item.visible_get(viewport=viewport) and not item.select_get() and item.mode == "OBJECT":
                    groups.setdefault(item.data, []).append(item)
    segments, colours = [np.zeros((0, 2, 3), np.float32)], [np.zeros((0, 4), np.float32)]
    for data, items in groups.items():
        local = _segments(data)
        matrices = np.array([item.matrix_world for item in items], np.float64)
        world = np.einsum("oij,kej->okei", matrices[:, :3, :3], local) + matrices[:, None, None, :3, 3]
        segments.append(world.reshape(-1, 2, 3).astype(np.float32))
        colours.append(np.repeat(_srgb(np.array([item.color for item in items])), len(local), axis=0))
    return np.concatenate(segments), np.concatenate(colours), known


def _segments(data) -> np.ndarray:
    """(k, 2, 3) float64, the segments of the splines of a curve in its own space."""
    parts = [np.zeros((0, 2, 3))]
    for spline in data.splines:
        points = spline_points(spline)
        if spline.use_cyclic_u and len(points):
            points = np.concatenate([points, points[:1]])
        parts.append(np.stack([points[:-1], points[1:]], axis=1))
    return np.concatenate(parts)


def _srgb(linear) -> np.ndarray:
    """(n, 4) float32, colours of objects, which are linear, as the screen has them."""
    linear = np.clip(linear, 0, 1)
    rgb = linear[:, :3]
    rgb = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1 / 2.4) - 0.055)
    return np.c_[rgb, linear[:, 3]].astype(np.float32)
