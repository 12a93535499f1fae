# SPDX-License-Identifier: GPL-3.0-or-later
"""Turning faces so that neighbours agree and closed outer shells face outwards."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components

from .edges import face_pairs
from .ordering import group_starts, order_by


def oriented(points: np.ndarray, faces: np.ndarray, face_edges: np.ndarray, tick=lambda: None) -> np.ndarray:
    """(m,) bool: which faces (m, 3) to turn so that the two faces of an edge run along it in opposite directions.

    A component keeps the orientation that most of its area has. A closed one that lies in no other and
    encloses a negative volume is turned inside out, because ridges would otherwise be read as valleys.
    Edges with more than two faces do not pass orientation on. One-sided strips (Moebius) keep one seam.
    `face_edges` is that of `edge_table`; `tick()` is called between the steps.
    """
    edge_faces = np.bincount(face_edges.ravel())
    one, two = face_pairs(face_edges, edge_faces)
    tick()
    tail = faces[:, [1, 2, 0]].ravel()  # of the edge opposite each corner
    left, right, agree = one // 3, two // 3, tail[one] != tail[two]
    m = len(faces)
    graph = sparse.coo_matrix((np.ones(len(left), np.int8), (left, right)), (m, m)).tocsr()
    tick()
    count, label = connected_components(graph, directed=False)
    tick()
    flip = np.zeros(m, bool)
    if not agree.all():
        flip = _parity(graph, left, right, agree, label, count, tick)
    p = points[faces]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    tick()
    area = np.linalg.norm(normal, axis=1)
    flip ^= (np.bincount(label, np.where(flip, area, -area), count) > 0)[label]
    tick()
    volume = np.einsum("ij,ij->i", p[:, 0] - points.mean(axis=0), normal)
    volume = np.bincount(label, np.where(flip, -volume, volume), count)
    tick()
    closed = np.ones(count, bool)
    closed[label[(edge_faces[face_edges] != 2).any(axis=1)]] = False
    inward = closed & (volume < 0)
    if inward.any():
        inward = _outermost(p, label, count, inward)
    return flip ^ inward[label]


def _parity(graph, left, right, agree, label, count, tick) -> np.ndarray:
    """(m,) bool, faces to turn so that a spanning tree of each component agrees.

    The parity of a face is the exclusive or along its path to the root; doubling the pointers takes
    log2(depth) rounds.
    """
    m = graph.shape[0]
    root = np.empty(count, np.int64)
    root[label] = np.arange(m)  # any of its faces
    hub = sparse.coo_matrix((np.ones(count), (np.full(count, m), root)), (m + 1, m + 1))
    whole = sparse.coo_matrix((np.ones(len(left)), (left, right)), (m + 1, m + 1)) + hub
    _, parent = breadth_first_order(whole.tocsr(), m, directed=False)
    parent = parent[: m + 1].astype(np.int64)
    parent[m] = m
    tick()
    odd = sparse.coo_matrix((2.0 - agree, (left, right)), (m + 1, m + 1)).tocsr()
    odd = odd + odd.T
    child = np.flatnonzero(parent[:m] != m)
    turned = np.zeros(m + 1, bool)
    # two faces can share two edges: their entries are added, and such a pair counts as agreeing when both do
    turned[child] = np.asarray(odd[child, parent[child]]).ravel() % 2 == 0
    while (parent[:m] != m).any():
        turned = turned ^ turned[parent]
        parent = parent[parent]
        tick()
    return turned[:m]


def _outermost(corners, label, count, wanted) -> np.ndarray:
    """(count,) bool, the wanted components whose bounding box lies in no other's; corners (m, 3, 3) of the faces."""
    order = order_by(label, count=count)
    start = np.flatnonzero(group_starts(label[order]))
    low = np.minimum.reduceat(corners.min(axis=1)[order], start)
    high = np.maximum.reduceat(corners.max(axis=1)[order], start)
    found = wanted.copy()
    for c in np.flatnonzero(wanted):
        found[c] = not ((low < low[c]).all(axis=1) & (high > high[c]).all(axis=1)).any()
    return found
