# SPDX-License-Identifier: GPL-3.0-or-later
"""The edges of triangles."""

from __future__ import annotations

import numpy as np

from .ordering import group_starts, order_by


def edge_table(faces: np.ndarray, count: int, tick=lambda: None) -> tuple[np.ndarray, np.ndarray]:
    """Edges (e, 2) int64 of the faces (m, 3) over `count` vertices, lower vertex first, in order; and face_edges (m, 3)
    int64, whose column j is the edge opposite corner j."""
    a, b = faces[:, [1, 2, 0]].ravel(), faces[:, [2, 0, 1]].ravel()
    low, high = np.minimum(a, b), np.maximum(a, b)
    tick()
    order = order_by(low, high, count=count, tick=tick)
    low, high = low[order], high[order]
    new = group_starts(low, high)
    face_edges = np.empty(len(order), np.int64)
    face_edges[order] = np.cumsum(new) - 1
    tick()
    return np.stack([low[new], high[new]], axis=1), face_edges.reshape(-1, 3)


def face_pairs(face_edges: np.ndarray, edge_faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (k,) in `face_edges.ravel()` of the two faces at each edge with exactly two, in order of the edges."""
    order = order_by(face_edges.ravel(), count=len(edge_faces))
    first = (np.cumsum(edge_faces) - edge_faces)[edge_faces == 2]
    return order[first], order[first + 1]
