# SPDX-License-Identifier: GPL-3.0-or-later
"""A graph of edges, and paths over shared vertices, as curves that meet only at their ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Chains:
    """Vertex sequences, one after the other.

    vertices : (n,) int64, indices of vertices; the closing vertex of a loop is not repeated
    offsets : (m + 1,) int64, chain i is ``vertices[offsets[i]:offsets[i + 1]]``
    closed : (m,) bool
    source : (m,) int64, the path that chain i is a part of
    """

    vertices: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    source: np.ndarray

    def __len__(self) -> int:
        return len(self.offsets) - 1


def chains_of_edges(edges) -> Chains:
    """Split a graph at its ends and junctions, the vertices that have not just two neighbours.

    A loop stays closed; so does one that hangs on a single junction. Self-loops and repeated edges are ignored.

    Parameters
    ----------
    edges : (k, 2) int64, vertex indices, not negative

    Returns
    -------
    Chains, ordered by the first edge in `edges` that each one has.

    Notes
    -----
    O(k log k), without a loop over edges. Each edge becomes two opposite half-edges; at a vertex with two neighbours
    a half-edge has one successor. That makes linked lists, and the place of a half-edge in its list comes from
    doubling the step: when the successor's successors are known, so are those 2, 4, 8, ... steps ahead.
    """
    edges = _distinct_edges(np.reshape(np.asarray(edges, np.int64), (-1, 2)))
    k = len(edges)
    if k == 0:
        none = np.zeros(0, np.int64)
        return Chains(none, np.zeros(1, np.int64), np.zeros(0, bool), none)
    tail = edges.ravel()  # half-edge 2 e leaves edges[e, 0], half-edge 2 e + 1 leaves edges[e, 1]
    twin = np.arange(2 * k) ^ 1
    successor = _successors(tail, twin)
    last, ahead = _walk_to_end(successor)
    looping = successor[last] >= 0
    if looping.any():
        smallest = _smallest_in_loop(successor, looping)
        # Cut every loop before its smallest half-edge; the two directions of a loop start with twins.
        successor[looping & (successor == smallest)] = -1
        last, ahead = _walk_to_end(successor)
    first = twin[last[twin]]  # the reversed chain ends with the twin of this one's first half-edge
    first[looping] = smallest[looping] if looping.any() else 0
    forward = np.where(looping | (first >> 1 == last >> 1), first & 1 == 0, first < last)
    half = np.flatnonzero(forward)
    order = half[np.lexsort((-ahead[half], _smallest_edge(first, half)))]
    starts = np.flatnonzero(np.r_[True, first[order][1:] != first[order][:-1]])
    return _chains_of_half_edges(order, starts, tail, twin)


def _chains_of_half_edges(order, starts, tail, twin) -> Chains:
    ends = np.r_[starts[1:], len(order)]
    closed = tail[order[starts]] == tail[twin[order[ends - 1]]]
    # The tails of a chain's half-edges, and the head of its last one where it is open.
    open_at = ends[~closed]
    vertices = np.insert(tail[order], open_at, tail[twin[order[open_at - 1]]])
    lengths = ends - starts + ~closed
    return Chains(vertices, np.r_[0, np.cumsum(lengths)], closed, np.arange(len(starts)))


def _distinct_edges(edges) -> np.ndarray:
    """(j, 2) int64, without self-loops and repetitions (in either direction), in the order of the input."""
    edges = edges[edges[:, 0] != edges[:, 1]]
    if len(edges) == 0:
        return edges
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, kept = np.unique(low * (int(high.max()) + 1) + high, return_index=True)
    return edges[np.sort(kept)]


def _successors(tail, twin) -> np.ndarray:
    """(2 k,) int64, the half-edge that follows each one, -1 at ends and junctions."""
    by_tail = np.argsort(tail, kind="stable")
    degree = np.bincount(tail)
    first = np.r_[0, np.cumsum(degree)[:-1]][degree == 2]
    a, b = by_tail[first], by_tail[first + 1]
    successor = np.full(len(tail), -1)
    successor[twin[a]], successor[twin[b]] = b, a
    return successor


def _walk_to_end(successor):
    """The last half-edge of each one's list and the steps to it; in a loop, some half-edge of it."""
    here = np.arange(len(successor))
    jump = np.where(successor < 0, here, successor)
    steps = (successor >= 0).astype(np.int64)
    for _ in range(len(successor).bit_length()):
        steps = steps + steps[jump]
        jump = jump[jump]
        if (successor[jump] < 0).all():
            break
    return jump, steps


def _smallest_in_loop(successor, looping) -> np.ndarray:
    """(2 k,) int64, the smallest half-edge of the loop that each looping half-edge is in."""
    smallest = np.arange(len(successor))
    jump = np.where(looping, successor, smallest)
    for _ in range(int(looping.sum()).bit_length()):
        smallest = np.minimum(smallest, smallest[jump])
        jump = jump[jump]
    return smallest


def _smallest_edge(first, half) -> np.ndarray:
    """(len(half),) int64, the smallest edge of the chain of each half-edge in `half`."""
    smallest = np.full(len(first), len(first))
    np.minimum.at(smallest, first[half], half >> 1)
    return smallest[first[half]]


def split_paths(vertices, offsets) -> Chains:
    """Cut each path where others, or itself, meet it inside: at vertices with more than two distinct neighbours.

    Parameters
    ----------
    vertices : (n,) int64, vertex indices of all paths; a path that is a loop repeats its first vertex at its end
    offsets : (m + 1,) int64

    Returns
    -------
    Chains; the pieces of one path are consecutive. A loop is cut at its junctions, not at its first vertex.

    Notes
    -----
    O(n log n).
    """
    vertices, offsets = np.asarray(vertices, np.int64), np.asarray(offsets, np.int64)
    path = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    inside = path[1:] == path[:-1]
    degree = np.zeros(int(vertices.max(initial=0)) + 1, np.int64)
    met = _distinct_edges(np.stack([vertices[:-1][inside], vertices[1:][inside]], axis=1)).ravel()
    degree += np.bincount(met, minlength=len(degree))
    junction = degree[vertices] > 2
    count = np.diff(offsets)
    looped = (count > 3) & (vertices[offsets[:-1]] == vertices[np.maximum(offsets[1:] - 1, 0)])
    inner = np.ones(len(vertices), bool)
    inner[offsets[:-1][count > 0]] = inner[offsets[1:][count > 0] - 1] = False
    cut_paths = np.unique(path[junction & (inner | looped[path])])
    whole = np.ones(len(offsets) - 1, bool)
    whole[cut_paths] = False
    pieces = {
        int(i): _cut(vertices[offsets[i] : offsets[i + 1]], junction[offsets[i] : offsets[i + 1]], looped[i])
        for i in cut_paths
    }
    return _joined(vertices, offsets, whole, looped, pieces)


def _cut(vertices, junction, looped):
    """List of (vertices, closed), the pieces of one path."""
    if looped:
        ring, at = vertices[:-1], np.flatnonzero(junction[:-1])
        ring = np.roll(ring, -at[0])
        if len(at) == 1:
            return [(ring, True)]
        vertices, at = np.r_[ring, ring[0]], np.r_[at - at[0], len(ring)]
    else:
        at = np.r_[0, np.flatnonzero(junction[1:-1]) + 1, len(vertices) - 1]
    parts = [vertices[a : b + 1] for a, b in zip(at[:-1], at[1:])]
    return [(p[:-1], True) if len(p) > 3 and p[0] == p[-1] else (p, False) for p in parts]


def _joined(vertices, offsets, whole, looped, pieces) -> Chains:
    """All paths again in their order, those in `pieces` replaced by their pieces."""
    out, closed, source = [], [], []
    for i in range(len(offsets) - 1):
        if whole[i]:
            out.append(vertices[offsets[i] : offsets[i + 1] - bool(looped[i])])
            closed.append(bool(looped[i]))
            source.append(i)
        else:
            out.extend(p for p, _ in pieces[i])
            closed.extend(c for _, c in pieces[i])
            source.extend([i] * len(pieces[i]))
    lengths = np.array([len(p) for p in out], np.int64)
    return Chains(
        np.concatenate(out) if out else np.zeros(0, np.int64),
        np.r_[0, np.cumsum(lengths)].astype(np.int64),
        np.array(closed, bool),
        np.array(source, np.int64),
    )
