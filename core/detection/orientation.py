# SPDX-License-Identifier: GPL-3.0-or-later
"""Turning faces so that neighbours agree and closed outer shells face outwards."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components


def oriented(points: np.ndarray, faces: np.ndarray, tick=lambda: None) -> np.ndarray:
    """Faces (m, 3) turned so that the two faces of an edge run along it in opposite directions.

    A component keeps the orientation that most of its area has. A closed one that lies in no other and
    encloses a negative volume is turned inside out, because ridges would otherwise be read as valleys.
    Edges with more than two faces do not pass orientation on. One-sided strips (Moebius) keep one seam.
    `tick()` is called between the steps.
    """
    left, right, agree = _face_pairs(faces, len(points))
    m = len(faces)
    graph = sparse.coo_matrix((np.ones(len(left)), (left, right)), (m, m)).tocsr()
    count, label = connected_components(graph, directed=False)
    tick()
    flip = np.zeros(m, bool)
    if not agree.all():
        flip = _parity(graph, left, right, agree, label, count)
    area = np.linalg.norm(
        np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1
    )
    flip ^= (np.bincount(label, np.where(flip, area, -area), count) > 0)[label]
    faces = np.where(flip[:, None], faces[:, [0, 2, 1]], faces)
    tick()
    inward = _inward(points, faces, label, count)
    return np.where(inward[label][:, None], faces[:, [0, 2, 1]], faces)


def _face_pairs(faces, n):
    """Faces on either side of each two-faced edge, and whether they run along it in opposite directions."""
    tail, head = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    key = np.minimum(tail, head) * n + np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    start = np.flatnonzero(np.r_[True, np.diff(key[order]) != 0])
    two = start[np.diff(np.r_[start, len(key)]) == 2]
    a, b = order[two], order[two + 1]
    return a // 3, b // 3, tail[a] != tail[b]


def _parity(graph, left, right, agree, label, count) -> np.ndarray:
    """(m,) bool, faces to turn so that a spanning tree of each component agrees.

    The parity of a face is the exclusive or along its path to the root; doubling the pointers takes
    log2(depth) rounds.
    """
    m = graph.shape[0]
    root = np.full(count, m)
    np.minimum.at(root, label, np.arange(m))
    hub = sparse.coo_matrix((np.ones(count), (np.full(count, m), root)), (m + 1, m + 1))
    whole = sparse.coo_matrix((np.ones(len(left)), (left, right)), (m + 1, m + 1)) + hub
    _, parent = breadth_first_order(whole.tocsr(), m, directed=False)
    parent = parent[: m + 1].astype(np.int64)
    parent[m] = m
    odd = sparse.coo_matrix((2.0 - agree, (left, right)), (m + 1, m + 1)).tocsr()
    odd = odd + odd.T
    child = np.flatnonzero(parent[:m] != m)
    turned = np.zeros(m + 1, bool)
    # two faces can share two edges: their entries are added, and such a pair counts as agreeing when both do
    turned[child] = np.asarray(odd[child, parent[child]]).ravel() % 2 == 0
    while (parent[:m] != m).any():
        turned = turned ^ turned[parent]
        parent = parent[parent]
    return turned[:m]


def _inward(points, faces, label, count) -> np.ndarray:
    """(count,) bool, closed components of negative volume whose bounding box lies in no other's."""
    n = len(points)
    tail, head = faces.ravel(), faces[:, [1, 2, 0]].ravel()
    key = np.minimum(tail, head) * n + np.maximum(tail, head)
    _, inverse, times = np.unique(key, return_inverse=True, return_counts=True)
    open_ = np.zeros(count, bool)
    open_[label[np.repeat(np.arange(len(faces)), 3)[times[inverse] != 2]]] = True
    centre = points.mean(axis=0)
    p = points[faces] - centre
    volume = np.bincount(label, np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])), count)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, label, points[faces].min(axis=1))
    np.maximum.at(high, label, points[faces].max(axis=1))
    inward = ~open_ & (volume < 0)
    for c in np.flatnonzero(inward):
        within = (low < low[c]).all(axis=1) & (high > high[c]).all(axis=1)
        inward[c] = not within.any()
    return inward
