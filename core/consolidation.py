# SPDX-License-Identifier: GPL-3.0-or-later
"""Consolidation (section 5.2): from overlaid occurrences to one clean curve where the object has one.

The paper selects one of the occurrences by shortest paths. Here the occurrences are first averaged, being
repeated measurements of one curve; the longest shortest paths then run through the averages.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from .linking import bend_of_ends, continuations, join_paths, split_at_corners
from .network import resample_polyline, smooth_polyline
from .rows import distinct_rows
from .traversal import find_passages, part_shared, split_where_none_pass

SPACING, LINK, SHORTEST = 0.7, 2.6, 5.0
"""Distance of the nodes, longest edge between them, shortest curve that is kept; edge lengths."""


def condense(points, tangents, weight, *, radius, rounds=3, cosine=0.75, tick=None):
    """Points moved onto the middle line of those around them that run the same way.

    Returns (n, 3) points and (n, 3) tangents. Each round takes the weighted mean across the tangent within
    `radius`, which shrinks by a third a round, and the main direction of the neighbours' tangents.
    """
    points, tangents = points.copy(), tangents.copy()
    for _ in range(rounds):
        if tick:
            tick()
        i, j, w = _pairs(points, tangents, weight, radius, cosine)
        total = np.bincount(i, w, minlength=len(points))
        offset = points[j] - points[i]
        offset -= tangents[i] * (offset * tangents[i]).sum(1)[:, None]
        move = np.stack([np.bincount(i, w * offset[:, c], minlength=len(points)) for c in range(3)], 1)
        points = points + move / total[:, None]
        sign = np.sign((tangents[i] * tangents[j]).sum(1))
        line = np.stack([np.bincount(i, w * sign * tangents[j, c], minlength=len(points)) for c in range(3)], 1)
        tangents = line / np.maximum(np.linalg.norm(line, axis=1), 1e-12)[:, None]
        radius *= 2 / 3
    return points, tangents


def _pairs(points, tangents, weight, radius, cosine):
    """Neighbours (i, j) within radius and with like tangents, each point with itself, and their weights."""
    tree = cKDTree(points)
    pair = tree.query_pairs(radius, output_type="ndarray")
    own = np.arange(len(points))
    i, j = np.concatenate([pair[:, 0], pair[:, 1], own]), np.concatenate([pair[:, 1], pair[:, 0], own])
    good = np.abs((tangents[i] * tangents[j]).sum(1)) > cosine
    i, j = i[good], j[good]
    square = ((points[i] - points[j]) ** 2).sum(1)
    return i, j, weight[j] * np.exp(-0.5 * square / (radius / 2) ** 2)


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


def fit_curves(paths, points, tangents, weight, run, *, trails=None, radius=1.5, smoothing=1.0, tick=None):
    """Smooth curves along paths through the points, one edge length between their samples.

    run : (n,) int64, the same for points that follow each other on one input curve, which are in its order
    trails : points, tangents and runs of all input curves of the cell, which tell what continues what; None takes
        the points that the curves are fitted to

    Pieces that continue each other are joined first; a path whose ends meet is closed.
    Returns a list of (k, 3) points and a list of bool.
    """
    pieces = [piece for path in paths for piece in split_at_corners(_even(path))]
    trails = trails or (points, tangents, run)
    tick = tick or (lambda: None)
    tick()
    joined = _join_across(split_where_none_pass(pieces, *trails), trails)
    joined = [(p, ring) for p, ring in joined if np.linalg.norm(np.diff(p, axis=0), axis=1).sum() >= SHORTEST]
    closed = [ring for _, ring in joined]
    tick()
    lines = [smooth_polyline(resample_polyline(path, 1.0, ring), smoothing, ring) for path, ring in joined]
    return settle(lines, closed, points, tangents, weight, run, radius=radius, smoothing=smoothing, tick=tick), closed


def settle(lines, closed, points, tangents, weight, run, *, radius=1.5, smoothing=1.0, tick=None):
    """Lines moved onto the middle of the points along them, smooth and one edge length between their samples.

    run : (n,) int64, the same for points that follow each other on one input curve
    """
    out = []
    owned = own_points(lines, points, tangents, run, radius=radius + 0.5, tick=tick)
    for line, ring, own in zip(lines, closed, owned):
        if tick:
            tick()
        for _ in range(2):
            line = pull(line, points[own], tangents[own], weight[own], radius, ring)
        out.append(resample_polyline(smooth_polyline(line, smoothing, ring), 1.0, ring))
    return out


def own_points(lines, points, tangents, run, *, radius, cosine=0.75, most=0.8, tick=None):
    """For each line, the points (k,) int64 along it that belong to it.

    Where lines share a stretch, a point belongs to those that its run follows for the longest way.
    """
    if not lines:
        return []
    found, followed, best = [], [], np.zeros(len(points), np.int64)
    for line in lines:
        if tick:
            tick()
        way = np.gradient(line, axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]
        low, high = line.min(axis=0) - radius, line.max(axis=0) + radius
        near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        distance, at = cKDTree(line).query(points[near], distance_upper_bound=radius)
        hit = np.flatnonzero(np.isfinite(distance))
        near, at = near[hit], at[hit]
        near = near[np.abs((way[at] * tangents[near]).sum(1)) > cosine]
        _, name, count = np.unique(run[near], return_inverse=True, return_counts=True)
        found.append(near)
        followed.append(count[name])
        best[near] = np.maximum(best[near], followed[-1])
    return [near[count >= most * best[near]] for near, count in zip(found, followed)]


def _join_across(pieces, trails, *, short=10.0, gap=14.0, cover=2.5):
    """Pieces joined; where curves cross or touch, arms are joined over the short piece that they share."""
    passages = find_passages(pieces, *trails)
    smooth = continuations(pieces)
    smooth = smooth[~passages.parted[smooth[:, 0], smooth[:, 1]]]
    pieces, forced = part_shared(pieces, passages, smooth, partial(bend_of_ends, pieces))
    size = np.array([np.linalg.norm(np.diff(p, axis=0), axis=1).sum() for p in pieces])
    tips = np.array([[p[0], p[-1]] for p in pieces]).reshape(-1, 3)
    pair = cKDTree(tips).query_pairs(5.0, output_type="ndarray").reshape(-1, 2)
    pair = pair[pair[:, 0] // 2 != pair[:, 1] // 2]
    meets = np.bincount(pair.ravel(), minlength=len(tips)).reshape(-1, 2)
    shared = (size < short) & (meets >= 2).all(axis=1)
    shared[forced.ravel() // 2] = False
    if not shared.any():
        return join_paths(pieces, passed=passages.pairs, parted=passages.parted, forced=forced)
    kept = np.flatnonzero(~shared)
    place = np.full(2 * len(pieces), -1)
    place[2 * kept], place[2 * kept + 1] = 2 * np.arange(len(kept)), 2 * np.arange(len(kept)) + 1
    long = [pieces[k] for k in kept]
    passages = find_passages(long, *trails)
    long = join_paths(long, gap=gap, passed=passages.pairs, parted=passages.parted, forced=place[forced])
    # A shared piece that no arm was joined over is a piece like any other.
    shown = cKDTree(np.concatenate([_dense(p, ring) for p, ring in long])) if long else None
    left = [p for p, s in zip(pieces, shared) if s and (shown is None or shown.query(p)[0].max() > cover)]
    open_ = [p for p, ring in long if not ring] + left
    passages = find_passages(open_, *trails)
    return join_paths(open_, passed=passages.pairs, parted=passages.parted) + [(p, ring) for p, ring in long if ring]


def _dense(path, ring):
    return resample_polyline(path, 1.0, ring)


def _even(path):
    """A path through nodes as a smooth line of samples one edge length apart."""
    return resample_polyline(smooth_polyline(resample_polyline(path, 1.0, False), 1.0, False), 1.0, False)


def pull(line, points, tangents, weight, radius, ring, *, spread=3.0):
    """A line moved onto the middle of the points along it.

    Each point gives its displacement from the line where it is nearest; displacements, not places, are averaged
    along the line, so that a bend is not flattened. `spread` is the standard deviation of that mean, in samples.
    """
    step = np.roll(line, -1, 0) - np.roll(line, 1, 0) if ring else np.gradient(line, axis=0)
    way = step / np.maximum(np.linalg.norm(step, axis=1), 1e-12)[:, None]
    distance, near = cKDTree(line).query(points, distance_upper_bound=radius + 0.5)
    found = np.flatnonzero(np.isfinite(distance))
    near = near[found]
    good = np.abs((way[near] * tangents[found]).sum(1)) > 0.75
    found, near = found[good], near[good]
    offset = points[found] - line[near]
    offset -= way[near] * (offset * way[near]).sum(1)[:, None]
    n = len(line)
    amount = np.bincount(near, weight[found], minlength=n)
    total = np.stack([np.bincount(near, weight[found] * offset[:, c], minlength=n) for c in range(3)], 1)
    mode = "wrap" if ring else "constant"
    amount = gaussian_filter1d(amount, spread, mode=mode)
    total = gaussian_filter1d(total, spread, axis=0, mode=mode)
    return line + total / np.maximum(amount, 1e-9)[:, None]
