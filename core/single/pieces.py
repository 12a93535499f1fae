# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of curves: what templates and courses leave of each curve, and what they explain of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..network.network import CurveNetwork

REST, MOSTLY = 8.0, 0.5
"""Shortest rest (edge lengths) of a curve that is explained in part, and the share from which on it is explained."""


@dataclass(frozen=True)
class Piece:
    """Neighbouring samples of one curve.

    points : (k, 3) float64, one edge apart, in the network's frame; closed : bool
    curve : index of the curve in the network; length : edge lengths
    """

    points: np.ndarray
    closed: bool
    curve: int
    length: float


def pieces_of(network: CurveNetwork, free) -> tuple[list[Piece], list[Piece]]:
    """Pieces that nothing explains, and pieces that templates or courses explain.

    free : (n,) bool, samples that nothing explains. A curve that is mostly explained leaves no free piece, and a
    curve that is explained in part none shorter than `REST`.
    """
    left, known, lengths = [], [], network.lengths
    share = np.add.reduceat(free, network.offsets[:-1], dtype=float) / np.diff(network.offsets)
    for i, (first, stop) in enumerate(zip(network.offsets[:-1], network.offsets[1:])):
        own = free[first:stop]
        if own.all() or not own.any():
            whole = Piece(network.points[first:stop], bool(network.closed[i]), i, float(lengths[i]))
            (left if own.all() else known).append(whole)
            continue
        for run in runs(own, network.closed[i]):
            piece = Piece(network.points[first + run], False, i, len(run) - 1.0)
            if not own[run[0]]:
                known.append(piece)
            elif share[i] > 1 - MOSTLY and piece.length >= REST:
                left.append(piece)
    return left, known


def runs(flags, ring):
    """List of int64 arrays, the indices of each stretch of equal flags; on a ring the first and last may be one."""
    parts = np.split(np.arange(len(flags)), np.flatnonzero(flags[1:] != flags[:-1]) + 1)
    if ring and len(parts) > 1 and flags[0] == flags[-1]:
        parts = [np.concatenate([parts[-1], parts[0]]), *parts[1:-1]]
    return parts
