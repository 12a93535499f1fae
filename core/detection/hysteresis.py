# SPDX-License-Identifier: GPL-3.0-or-later
"""Which stretches of crest lines stay: clear ones, and the short faint ones between them."""

from __future__ import annotations

import numpy as np

from .chains import Chains, chains


def clear_segments(segments: np.ndarray, points: np.ndarray, clear: np.ndarray, bridge: float) -> np.ndarray:
    """Segments (k, 2) between clear points, and those of faint runs no longer than `bridge` between two clear points.

    Parameters
    ----------
    segments : (s, 2) int64, over the points
    points : (p, 3) float64
    clear : (p,) bool
    bridge : scene units, inclusive
    """
    lines = starting_at(chains(segments, len(points)), clear)
    a, b = lines.following()
    if not len(a):
        return np.zeros((0, 2), np.int64)
    chain = lines.label[a]
    a, b = lines.nodes[a], lines.nodes[b]
    # a run begins after a clear point or with a new chain; it is bridged if it also ends at one
    begins = clear[a] | np.r_[True, chain[1:] != chain[:-1]]
    run = np.cumsum(begins) - 1
    first = np.flatnonzero(begins)
    last = np.r_[first[1:], len(a)] - 1
    length = np.bincount(run, np.linalg.norm(points[b] - points[a], axis=1))
    direct = first == last
    kept = clear[a[first]] & clear[b[last]] & (direct | (length <= bridge))
    return np.stack([a, b], axis=1)[kept[run]]


def starting_at(lines: Chains, wanted: np.ndarray) -> Chains:
    """The chains with every closed one turned so that it starts at a wanted node, if it has any.

    A run that passes the start of a loop would be seen as two otherwise.
    """
    sizes = np.diff(lines.offsets)
    label = lines.label
    local = np.arange(len(lines.nodes)) - lines.offsets[label]
    shift = np.full(len(lines), np.iinfo(np.int64).max)
    hit = wanted[lines.nodes]
    np.minimum.at(shift, label[hit], local[hit])
    shift[~lines.closed | (shift == np.iinfo(np.int64).max)] = 0
    turned = lines.nodes[lines.offsets[label] + (local + shift[label]) % sizes[label]]
    return Chains(turned, lines.offsets, lines.closed)
