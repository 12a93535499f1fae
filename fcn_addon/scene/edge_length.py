# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean edge length of a scan in a scene."""

from __future__ import annotations

import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError


def mean_edge_length(item, depsgraph) -> float:
    """Mean length of the edges of a mesh object, evaluated and in world space."""
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.edges:
            text = rpt_("object {name!r} has no edges; choose the scan that the curves come from")
            raise InputError(text.format(name=item.name))
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        edges = np.empty(2 * len(mesh.edges), np.int32)
        mesh.edges.foreach_get("vertices", edges)
    finally:
        evaluated.to_mesh_clear()
    turn = np.array(evaluated.matrix_world, float)[:3, :3]
    points, edges = points.reshape(-1, 3) @ turn.T, edges.reshape(-1, 2)
    mean = float(np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1).mean())
    if not (np.isfinite(mean) and mean > 0):
        text = rpt_("object {name!r} has a mean edge length of {mean:g}; choose another scan")
        raise InputError(text.format(name=item.name, mean=mean))
    return mean
