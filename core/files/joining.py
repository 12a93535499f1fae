# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines joined by position: whatever a file's indices say, what meets in space is one graph of segments.

An end that lies within a tolerance of another line is on it: at a vertex of it the two become one, and inside a
segment that segment is cut there. Segments that are there twice count once. The graph is then split into curves at its
junctions and ends.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..errors import NoCurves
from ..geometry.chains import Chains, chains_of_edges
from ..geometry.rows import distinct_rows
from ..values import Curves
from .reading import Reading, Shares

SLACK = 0.25
"""An end never moves by more than this share of its own segment, so that fine lines keep all their points."""

MOST_PAIRS = 2_000_000
"""Pairs of ends and pieces that are measured at once, about 100 bytes each."""


def join(reading: Reading, tolerance: float) -> Reading:
    """The curves between the junctions and ends of all lines of a reading.

    Parameters
    ----------
    reading : lines in any state; lines of different `kind` are not joined
    tolerance : scene units; 0 joins only what is equal

    Returns
    -------
    Reading, whose curves are in the order of their first segments and run the way of it. An input curve is a line that
    the file names, or else what its single edges were joined to; `shares` says which curves it is a part of.

    Raises NoCurves where no line has a length.

    Notes
    -----
    O(n log n) time where lines are not all in one place; O(n) memory.
    """
    curves = reading.curves
    place = _places(curves)
    tail, head, curve_of = _segments(curves, place)
    tail, head, segment = _welded(curves, place, tail, head, tolerance)
    curve_of = curve_of[segment]
    length = np.linalg.norm(curves.points[head] - curves.points[tail], axis=1)
    used = tail != head
    if not used.any():
        raise NoCurves("no curve has two different points; export edges or polylines")
    tail, head, curve_of, length = tail[used], head[used], curve_of[used], length[used]
    chains = chains_of_edges(np.stack([tail, head], axis=1))
    chain = _chain_of_edges(chains, tail, head)
    line, count = _input_curves(reading, curve_of, chain)
    shares = _shares(chain, line, length)
    made = Curves(
        curves.points[chains.vertices],
        chains.offsets.astype(np.int64),
        chains.closed,
        None if curves.strength is None else curves.strength[chains.vertices],
        _main_lines(shares, len(chains)),
        None if curves.normals is None else curves.normals[chains.vertices],
        None if curves.kind is None else curves.kind[chains.vertices],
    )
    return replace(reading, curves=made, count=count, shares=shares)


def _places(curves) -> np.ndarray:
    """(n,) int64, the first point that is at the same place, and of the same kind, as each point."""
    rows = curves.points + 0.0  # -0 is 0
    if curves.kind is not None:
        rows = np.column_stack([rows, curves.kind])
    _, first, index = distinct_rows(rows)
    return first[index]


def _segments(curves, place):
    """Places at both ends of each segment and its curve, in order; closing segments come in their turn."""
    sizes = np.diff(curves.offsets)
    here = np.arange(len(curves.points))
    after = here + 1
    last = curves.offsets[1:][sizes > 0] - 1
    after[last] = curves.offsets[:-1][sizes > 0]
    keep = np.ones(len(here), bool)
    keep[last[~curves.closed[sizes > 0]]] = False
    keep[last[sizes[sizes > 0] == 1]] = False
    return place[here[keep]], place[after[keep]], np.repeat(np.arange(len(curves)), sizes)[keep]


def _welded(curves, place, tail, head, tolerance):
    """Segments after ends were put on what they touch: places of tails and heads, and the segment each is a part of."""
    whole = np.arange(len(tail))
    if tolerance <= 0 or not len(tail):
        return tail, head, whole
    ends, reach = _ends(curves, place, tail, head, tolerance)
    vertex, segment, position = _touching(curves, ends, reach, tail, head)
    # Where an end is as near to a vertex of the segment, the two are one.
    own = reach[np.searchsorted(ends, vertex)]
    points = curves.points
    near_tail = np.linalg.norm(points[vertex] - points[tail[segment]], axis=1) <= own
    near_head = ~near_tail & (np.linalg.norm(points[vertex] - points[head[segment]], axis=1) <= own)
    at_vertex = near_tail | near_head
    other = np.where(near_tail, tail[segment], head[segment])[at_vertex]
    merged = _merge(len(points), vertex[at_vertex], other)
    inside = ~at_vertex
    tail, head, segment = _cut(tail, head, vertex[inside], segment[inside], position[inside])
    return merged[tail], merged[head], segment


def _ends(curves, place, tail, head, tolerance):
    """Places where open lines end, ascending, and how far each may be from what it touches."""
    sizes = np.diff(curves.offsets)
    open_ = ~curves.closed & (sizes > 1)
    ends = np.unique(place[np.r_[curves.offsets[:-1][open_], curves.offsets[1:][open_] - 1]])
    length = np.linalg.norm(curves.points[head] - curves.points[tail], axis=1)
    shortest = np.full(len(place), np.inf)
    for side in (tail, head):
        np.minimum.at(shortest, side[length > 0], length[length > 0])
    return ends, np.minimum(tolerance, SLACK * shortest[ends])


def _touching(curves, ends, reach, tail, head):
    """Ends and the segments of their kind within their reach that they do not belong to, each pair once.

    Returns the place of the end, the segment, and the position along it from 0 to 1, (k,) each.
    """
    points = curves.points
    step = points[head] - points[tail]
    length = np.linalg.norm(step, axis=1)
    mean = length.mean() or 1.0
    pieces = np.maximum(np.ceil(length / mean), 1).astype(np.int64)  # at most twice as many as segments
    of = np.repeat(np.arange(len(tail)), pieces)
    nth = np.arange(len(of)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = points[tail[of]] + ((nth + 0.5) / pieces[of])[:, None] * step[of]
    size = length[of] / pieces[of]
    group = np.frexp(size)[1]
    found = [np.zeros((2, 0), np.int64)]
    for g in np.unique(group[size > 0]):
        chosen = np.flatnonzero((group == g) & (size > 0))
        tree = cKDTree(middle[chosen])
        radius = reach.max(initial=0.0) + 0.5 * size[chosen].max() * (1 + 1e-9)
        for batch in _batches(tree, points[ends], radius):
            pair = cKDTree(points[ends[batch]]).sparse_distance_matrix(tree, radius, output_type="ndarray")
            vertex, segment = batch[pair["i"]], of[chosen[pair["j"]]]
            if curves.kind is not None:
                same = curves.kind[ends[vertex]] == curves.kind[tail[segment]]
                vertex, segment = vertex[same], segment[same]
            found.append(_within(points, ends, reach, tail, head, step, vertex, segment))
    vertex, segment = np.unique(np.concatenate(found, axis=1), axis=1)
    along = ((points[ends[vertex]] - points[tail[segment]]) * step[segment]).sum(axis=1) / length[segment] ** 2
    return ends[vertex], segment, np.clip(along, 0, 1)


def _batches(tree, points, radius):
    """Indices of points in parts, so that each part has not many more than MOST_PAIRS neighbours in all."""
    if not len(points):
        return []
    counts = tree.query_ball_point(points, radius, return_length=True)
    cuts = np.flatnonzero(np.diff(np.cumsum(counts) // MOST_PAIRS)) + 1
    return np.split(np.arange(len(points)), cuts)


def _within(points, ends, reach, tail, head, step, vertex, segment) -> np.ndarray:
    """(2, j) int64, of pairs of ends and segments those that touch and do not belong together."""
    place = ends[vertex]
    away = points[place] - points[tail[segment]]
    along = np.clip((away * step[segment]).sum(axis=1) / (step[segment] ** 2).sum(axis=1), 0, 1)
    distance = np.linalg.norm(away - along[:, None] * step[segment], axis=1)
    good = (distance <= reach[vertex]) & (place != tail[segment]) & (place != head[segment])
    return np.stack([vertex[good], segment[good]])


def _merge(count, a, b) -> np.ndarray:
    """(count,) int64, the first of all that each is connected with by the pairs a, b."""
    graph = coo_matrix((np.ones(len(a), bool), (a, b)), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    return first[label]


def _cut(tail, head, vertex, segment, position):
    """Segments cut at vertices inside them; also the segment that each new one is a part of."""
    every = np.arange(len(tail))
    place = np.concatenate([tail, vertex, head])
    of = np.concatenate([every, segment, every])
    at = np.concatenate([np.full(len(tail), -1.0), position, np.full(len(tail), 2.0)])
    order = np.lexsort((at, of))
    place, of = place[order], of[order]
    inside = of[1:] == of[:-1]
    return place[:-1][inside], place[1:][inside], of[:-1][inside]


def _chain_of_edges(chains: Chains, tail, head) -> np.ndarray:
    """(k,) int64, the chain that each edge is in."""
    sizes = np.diff(chains.offsets)
    after = np.arange(len(chains.vertices)) + 1
    last = chains.offsets[1:] - 1
    after[last] = chains.offsets[:-1]
    keep = np.ones(len(after), bool)
    keep[last[~chains.closed]] = False
    a, b = chains.vertices[keep], chains.vertices[after[keep]]
    many = int(chains.vertices.max()) + 1
    key = np.minimum(a, b) * many + np.maximum(a, b)
    order = np.argsort(key)
    wanted = np.minimum(tail, head) * many + np.maximum(tail, head)
    found = order[np.searchsorted(key, wanted, sorter=order)]
    return np.repeat(np.arange(len(chains)), sizes)[keep][found]


def _input_curves(reading, curve_of, chain):
    """The input curve of each edge, in the order in which the reading begins them, and how many there are.

    A line with a name is one; edges without are what they were joined to.
    """
    source = reading.curves.source
    named = source[curve_of] >= 0
    begin = np.full(reading.count, -1, np.int64)  # the curve with which each named line begins
    at = np.flatnonzero(source >= 0)[::-1]
    begin[source[at]] = at
    begin = np.maximum.accumulate(begin) if len(begin) else begin  # one that left no curve stands behind the one before
    loose, first = np.unique(chain[~named], return_index=True)
    key = np.concatenate([begin, curve_of[~named][first]])
    place = np.empty(len(key), np.int64)
    place[np.argsort(key, kind="stable")] = np.arange(len(key))
    line = np.empty(len(curve_of), np.int64)
    line[named] = place[: reading.count][source[curve_of[named]]]
    line[~named] = place[reading.count :][np.searchsorted(loose, chain[~named])]
    return line, len(key)


def _shares(chain, line, length) -> Shares:
    pair, index = np.unique(np.stack([chain, line]), axis=1, return_inverse=True)
    return Shares(pair[0], pair[1], np.bincount(index.ravel(), length, pair.shape[1]))


def _main_lines(shares, count) -> np.ndarray:
    """(count,) int64, the input curve that most of each curve comes from."""
    order = np.lexsort((-shares.length, shares.curve))
    first = np.searchsorted(shares.curve[order], np.arange(count))
    return shares.line[order][first]
