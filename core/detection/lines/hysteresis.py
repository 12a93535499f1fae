# SPDX-License-Identifier: GPL-3.0-or-later
"""Which stretches of crest lines stay: clear ones, and the short faint ones between them."""

from __future__ import annotations

import numpy as np

from ..chains import Chains, chains


def clear_segments(
    segments: np.ndarray, points: np.ndarray, clear: np.ndarray, bridge: float, tick=lambda: None
) -> np.ndarray:
    """Segments (k, 2) between clear points, and those of faint runs no longer than `bridge` between two clear points.

    Parameters
    ----------
    segments : (s, 2) int64, over the points
    points : (p, 3) float64
    clear : (p,) bool
    bridge : scene units, inclusive
    """
    lines = chains(segments, len(points))
    tick()
    lines = starting_at(lines, clear)
    tick()
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


def without_faint_tails(segments: np.ndarray, count: int, strong: np.ndarray, bridge: np.ndarray) -> np.ndarray:
    """Segments without the ends of lines that hang on by a bridge and are nowhere strong.

    A faint piece between two strong ones carries a line on; one behind the last strong point was joined by
    chance as often as not.

    Parameters
    ----------
    segments : (s, 2) int64, over `count` points
    strong, bridge : (count,) bool, strong points, and points of bridges over gaps
    """
    lines = chains(segments, count)
    label, position = lines.label, np.arange(len(lines.nodes))
    is_strong, is_bridge = strong[lines.nodes], bridge[lines.nodes]
    first, last = lines.offsets[1:].copy(), np.full(len(lines), -1)
    np.minimum.at(first, label[is_strong], position[is_strong])
    np.maximum.at(last, label[is_strong], position[is_strong])
    # lines without a strong point have first beyond and last before all of theirs: they are left as they are
    some = last >= 0
    head, tail = np.full(len(lines), -1), lines.offsets[1:].copy()
    before = is_bridge & (position < first[label]) & some[label]
    behind = is_bridge & (position > last[label]) & some[label]
    np.maximum.at(head, label[before], position[before])
    np.minimum.at(tail, label[behind], position[behind])
    kept = (position > head[label]) & (position < tail[label]) | lines.closed[label]
    a, b = lines.following()
    return np.stack([lines.nodes[a], lines.nodes[b]], axis=1)[kept[a] & kept[b]]


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
