# SPDX-License-Identifier: GPL-3.0-or-later
"""Longest shortest paths through points that lie along curves (section 5.2)."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from ..geometry.rows import distinct_rows

SPACING, LINK = 0.7, 2.6
"""Distance of the nodes, longest edge between them; edge lengths."""


def trace_curves(points, tangents, *, shortest=3.0, tick=None):
    """Longest shortest paths through points that lie along curves.

    Returns a list of (points (k, 3) float64, closed bool), longest first.
    """
    if len(points) < 2:
        return []
    pick = _spread(points, SPACING)
    points, tangents = points[pick], tangents[pick]
    graph = _graph(points, tangents)
    tree = cKDTree(points)
    # Arms that meet are traced apart and joined as they fit best, not as the shortest way happens to turn.
    alive = ~_junctions(points, graph, tree)
    curves = []
    while alive.any():
        if tick:
            tick()
        nodes = np.flatnonzero(alive)
        part = graph[nodes][:, nodes]
        number, label = connected_components(part, directed=False)
        for c in range(number):
            member = np.flatnonzero(label == c)
            if len(member) < 3:
                alive[nodes[member]] = False
                continue
            path = _longest_shortest_path(part[member][:, member])
            path = nodes[member[path]]
            length = np.linalg.norm(np.diff(points[path], axis=0), axis=1).sum()
            near = np.unique(np.concatenate(tree.query_ball_point(points[path], 1.5)).astype(np.int64))
            line = tangents[path[tree_nearest(points[path], points[near])]]
            same = np.abs((line * tangents[near]).sum(1)) > 0.6
            alive[near[same]] = False
            alive[path] = False
            if length >= shortest:
                curves.append(points[path])
    return sorted(curves, key=lambda p: -len(p))


def tree_nearest(line, points):
    """(n,) int64, the point of a line (k, 3) nearest to each point."""
    return cKDTree(line).query(points)[1]


def _spread(points, spacing):
    """One point a voxel of the given size, the one nearest to the mean of the voxel's points."""
    key = np.floor(points / spacing).astype(np.int64)
    _, _, cell = distinct_rows(key)
    count = np.bincount(cell)
    mean = np.stack([np.bincount(cell, points[:, c]) for c in range(3)], 1) / count[:, None]
    distance = ((points - mean[cell]) ** 2).sum(1)
    order = np.lexsort((distance, cell))
    first = np.ones(len(order), bool)
    first[1:] = cell[order[1:]] != cell[order[:-1]]
    return order[first]


def _graph(points, tangents):
    """Edges between nodes that follow each other along their tangents, weighted by their length."""
    pair = cKDTree(points).query_pairs(LINK, output_type="ndarray")
    i, j = pair.T
    edge = points[j] - points[i]
    length = np.linalg.norm(edge, axis=1)
    way = edge / np.maximum(length, 1e-9)[:, None]
    short = length < 0.8
    good = np.abs((tangents[i] * tangents[j]).sum(1)) > 0.8
    along_i, along_j = np.abs((way * tangents[i]).sum(1)), np.abs((way * tangents[j]).sum(1))
    good &= short | ((along_i > 0.75) & (along_j > 0.75))
    i, j, length = i[good], j[good], length[good]
    # A little more than the length: many short steps are better than one long one over a gap.
    cost = np.maximum(length, 1e-6) ** 1.5
    n = len(points)
    return coo_matrix((np.r_[cost, cost], (np.r_[i, j], np.r_[j, i])), shape=(n, n)).tocsr()


def _junctions(points, graph, tree, *, inner=2.2, outer=4.0):
    """(n,) bool, nodes from which three or more arms lead through the ring between two radii.

    Notes
    -----
    All nodes at once: node (k, b) of one large graph is node b as seen from node k, in the ball around it.
    """
    n = len(points)
    pair = tree.query_pairs(outer, output_type="ndarray")
    own = np.arange(n)
    centre, node = np.concatenate([pair[:, 0], pair[:, 1], own]), np.concatenate([pair[:, 1], pair[:, 0], own])
    key = np.sort(centre * n + node)
    centre, node = key // n, key % n
    # Each edge of the graph, as seen from every node that has both its ends in its ball.
    degree = np.diff(graph.indptr)[node]
    source = np.repeat(np.arange(len(key)), degree)
    step = np.arange(len(source)) - np.repeat(np.cumsum(degree) - degree, degree)
    target = graph.indices[np.repeat(graph.indptr[node], degree) + step]
    wanted = centre[source] * n + target
    at = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
    inside = key[at] == wanted
    a, b = source[inside], at[inside]
    ball = _parts_of(len(key), a, b)
    reached = ball == ball[np.searchsorted(key, own * n + own)][centre]
    ring = reached & (((points[node] - points[centre]) ** 2).sum(1) > inner**2)
    both = ring[a] & ring[b]
    arm = _parts_of(len(key), a[both], b[both])[ring]
    arms = distinct_rows(np.stack([centre[ring], arm], axis=1))[0][:, 0]
    return np.bincount(arms, minlength=n) >= 3


def _parts_of(count, a, b):
    """(count,) int, the connected component of each node of a graph with edges (a, b)."""
    return connected_components(coo_matrix((np.ones(len(a), bool), (a, b)), shape=(count, count)), directed=False)[1]


def _longest_shortest_path(graph):
    """Nodes of the longest shortest path of a connected graph, found by two sweeps (exact on trees)."""
    start = 0
    for _ in range(2):
        distance, before = dijkstra(graph, indices=start, return_predecessors=True)
        start = int(np.argmax(np.where(np.isfinite(distance), distance, -1)))
    path, at = [start], start
    while before[at] >= 0:
        at = before[at]
        path.append(at)
    return np.array(path)
