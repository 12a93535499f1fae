# SPDX-License-Identifier: GPL-3.0-or-later
"""A graph of edges as curves that meet only at their ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Chains:
    """Vertex sequences, one after the other.

    vertices : (n,) int64, indices of vertices; the closing vertex of a loop is not repeated
    offsets : (m + 1,) int64, chain i is ``vertices[offsets[i]:offsets[i + 1]]``
    closed : (m,) bool
    source : (m,) int64, what chain i is a part of: itself
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
