# SPDX-License-Identifier: GPL-3.0-or-later
"""Doubled lines made one, and spurs pruned."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from .lines import Lines, tangents, weights

_PARALLEL = 0.8
"""Lines beside each other are doubles of one feature below an angle of 37 degrees; crossings are steeper."""


def without_doubles(lines: Lines, distance: float, tick=lambda: None) -> Lines:
    """Of two lines that run beside each other within `distance` (scene units), the stretch of the weaker goes.

    Weaker is the line with the smaller integral of the fold angle over its length. Short stretches go
    too, so that a spur beside its own line is pruned; what is left of the weaker line stays.
    """
    pieces = lines.chains()
    if distance <= 0 or len(pieces) < 2:
        return lines
    points, tangent = lines.points[pieces.nodes], tangents(pieces, lines.points)
    total = np.bincount(pieces.label, lines.fold[pieces.nodes] * weights(pieces, lines.points), len(pieces))
    rank = np.empty(len(pieces), np.int64)
    rank[np.argsort(total, kind="stable")] = np.arange(len(pieces))
    standing = rank[pieces.label]
    tick()
    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray")
    tick()
    beside = np.abs(np.einsum("ij,ij->i", tangent[pairs[:, 0]], tangent[pairs[:, 1]])) >= _PARALLEL
    lower = np.where(standing[pairs[:, 0]] < standing[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    covered = np.zeros(len(points), bool)
    covered[lower[beside & (standing[pairs[:, 0]] != standing[pairs[:, 1]])]] = True
    a, b = pieces.following()
    keep = ~(covered[a] | covered[b])
    return lines.with_segments(np.stack([pieces.nodes[a], pieces.nodes[b]], axis=1)[keep])


def without_spurs(lines: Lines, length: float) -> Lines:
    """Lines without the branches shorter than `length` that leave a junction and end freely."""
    pieces = lines.chains()
    if not len(pieces):
        return lines
    degree = np.bincount(lines.segments.ravel(), minlength=len(lines.points))
    first, last = degree[pieces.nodes[pieces.offsets[:-1]]], degree[pieces.nodes[pieces.offsets[1:] - 1]]
    spur = ~pieces.closed & (np.minimum(first, last) == 1) & (np.maximum(first, last) > 2)
    spur &= pieces.lengths(lines.points) < length
    a, b = pieces.following()
    return lines.with_segments(np.stack([pieces.nodes[a], pieces.nodes[b]], axis=1)[~spur[pieces.label[a]]])
