# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines of a graph of segments, without a loop over segments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Chains:
    """Maximal paths of a graph, one after the other.

    nodes : (k,) int64, node ids in order along each chain; a junction appears in every chain that ends there
    offsets : (c + 1,) int64, chain i is ``nodes[offsets[i]:offsets[i + 1]]``
    closed : (c,) bool, the first node is not repeated
    """

    nodes: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray

    def __len__(self) -> int:
        return len(self.offsets) - 1

    @property
    def label(self) -> np.ndarray:
        """(k,) int64, the chain of each entry of `nodes`."""
        return np.repeat(np.arange(len(self)), np.diff(self.offsets))

    def following(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions in `nodes` of the two ends of every segment, in order; a closing segment comes in its turn."""
        position = np.arange(len(self.nodes))
        after = position + 1
        last = self.offsets[1:] - 1
        after[last] = self.offsets[:-1]
        keep = np.ones(len(self.nodes), bool)
        keep[last[~self.closed]] = False
        return position[keep], after[keep]

    def lengths(self, points: np.ndarray) -> np.ndarray:
        """(c,) float64, arc lengths; `points` (n, 3) are those of the nodes."""
        a, b = self.following()
        step = np.linalg.norm(points[self.nodes[b]] - points[self.nodes[a]], axis=1)
        return np.bincount(self.label[a], step, len(self))


def chains(segments: np.ndarray, count: int) -> Chains:
    """Split the graph of `segments` (s, 2) over `count` nodes at every node that has not exactly two segments.

    Repeated segments and segments from a node to itself are ignored.

    Notes
    -----
    Each segment is two half edges h and h ^ 1. The successor of h is the half edge that leaves its head, if the
    head has degree two. Doubling the successor pointers gives every half edge its distance to the end of its
    chain in log2(longest) rounds, and sorting by that distance puts the chain in order.
    """
    segments = _simple(np.asarray(segments, np.int64).reshape(-1, 2), count)
    if not len(segments):
        return Chains(np.zeros(0, np.int64), np.zeros(1, np.int64), np.zeros(0, bool))
    tail, head = segments.ravel(), segments[:, ::-1].ravel()  # half edge 2s runs forward along s, 2s + 1 back
    half = np.arange(len(tail))
    degree = np.bincount(tail, minlength=count)
    after = half.copy()
    leaving = np.argsort(tail, kind="stable")
    leaving = leaving[degree[tail[leaving]] == 2].reshape(-1, 2)
    after[leaving[:, 0] ^ 1], after[leaving[:, 1] ^ 1] = leaving[:, 1], leaving[:, 0]
    end, _ = _jump(after)
    loop = after[end] != end
    # the two directions of a chain have different names; the lower one is kept, and a loop is cut before its name
    name = np.where(loop, _lowest(after), end)
    keep = name < name[half ^ 1]
    cut = loop & (after == name)
    after[cut] = half[cut]
    _, distance = _jump(after)
    h = half[keep]
    order = h[np.lexsort((-distance[h], name[h]))]
    name = name[order]
    start = np.flatnonzero(np.r_[True, name[1:] != name[:-1]])
    closed = loop[order[start]]
    sizes = np.diff(np.r_[start, len(order)])
    offsets = np.r_[0, np.cumsum(sizes + ~closed)]
    nodes = np.empty(offsets[-1], np.int64)
    place = np.arange(len(order)) + np.repeat(offsets[:-1] - start, sizes)
    nodes[place] = tail[order]
    final = np.r_[start[1:], len(order)][~closed] - 1
    nodes[offsets[1:][~closed] - 1] = head[order[final]]
    return Chains(nodes, offsets, closed)


def _simple(segments, count):
    """Segments without repeats and without those of one node, in order."""
    low, high = segments.min(axis=1, initial=count), segments.max(axis=1, initial=-1)
    _, first = np.unique(low * count + high, return_index=True)
    first.sort()
    return segments[first[low[first] != high[first]]]


def _jump(after):
    """Last half edge that the pointers lead to, and the number of steps; meaningless on loops."""
    distance = (after != np.arange(len(after))).astype(np.int64)
    for _ in range(max(1, int(len(after)).bit_length())):
        onward = after[after]
        if (onward == after).all():
            break
        distance = distance + distance[after]
        after = onward
    return after, distance


def _lowest(after):
    """Lowest half edge among those that follow, itself included."""
    lowest = np.minimum(np.arange(len(after)), after)
    for _ in range(max(1, int(len(after)).bit_length())):
        after = after[after]
        lowest = np.minimum(lowest, lowest[after])
    return lowest
