# SPDX-License-Identifier: GPL-3.0-or-later
"""Orbits (section 4.1.2, after Pauly et al. 2008): poses that are powers of one or two generators."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.motions import exponential

NEAR, SMALL_TURN = 5.0, 5.0
"""RMS edge lengths on the thing within which a pose is that of a cell, and degrees within which poses are turned alike
(tolerances)."""

NEIGHBOURS, PAIRS = 4, 8
"""Poses about each from which generators are taken, and steps, or translations, that are tried; counts that bound the
work."""


@dataclass(frozen=True)
class Orbit:
    """A recurrence in the network's frame.

    kind : "single", "translation", "grid", "rotation" or "screw"
    twists : (g, 6) float64, one a generator: rotation vector w (radians a step) and velocity u at the origin
    keys : (k, g) int64, the powers of the generators at which each pose of the thing stands
    strand : (k,) int64, which of the bases each pose comes from, -1 for poses that are not of the orbit: rows of seats
        about one axis are strands of one rotation
    bases : (s, 4, 4) float64, the poses at the powers 0
    closed : whether the rotation's order brings it back to the start
    order : int, number of powers of a closed rotation, 0 otherwise
    """

    kind: str
    twists: np.ndarray
    keys: np.ndarray
    strand: np.ndarray
    bases: np.ndarray
    closed: bool = False
    order: int = 0

    def power(self, k):
        """Motions (n, 4, 4) of integer powers k (n, g). Translations commute; only they come in twos."""
        return exponential(np.asarray(k, float) @ self.twists)

    @property
    def fits(self):
        """(k,) bool, which poses are of the orbit."""
        return self.strand >= 0

    def cells(self, strand):
        """(n, g) int64, distinct powers at which the poses of a strand stand."""
        keys = self.keys[self.strand == strand]
        return np.unique(keys % self.order if self.closed else keys, axis=0)

    def poses(self):
        """(k, 4, 4), where the orbit has its poses; meaningless for those that are not of it."""
        return self.power(self.keys) @ self.bases[np.maximum(self.strand, 0)]

    @property
    def generators(self):
        """(g, 4, 4) float64."""
        return exponential(self.twists)

    @property
    def extent(self):
        """(g, 2) int64, lowest and highest power of a strand that is seen, both inclusive; the lowest is 0."""
        if self.kind == "single":
            return np.array([[0, 1]])
        if self.closed:
            return np.array([[0, self.order - 1]])
        high = np.max([np.ptp(self.cells(s), axis=0) for s in range(len(self.bases))], axis=0)
        return np.stack([np.zeros_like(high), high], axis=1)

    @property
    def spans(self) -> int:
        """Cells between the first and the last of each strand, empty ones included."""
        if self.closed:
            return self.order * len(self.bases)
        return int(sum(np.prod(np.ptp(self.cells(s), axis=0) + 1) for s in range(len(self.bases))))

    def empty_poses(self):
        """(n, 4, 4), where no pose stands: in the cells within the extent of each strand, and one beyond it."""
        if self.kind == "single":
            return np.zeros((0, 4, 4))
        out = []
        for s, base in enumerate(self.bases):
            seen = self.cells(s)
            ends = [(0, self.order - 1)] if self.closed else zip(seen.min(axis=0) - 1, seen.max(axis=0) + 1)
            axes = [np.arange(low, high + 1) for low, high in ends]
            cells = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
            empty = cells[~(cells[:, None] == seen[None]).all(axis=2).any(axis=1)]
            out.append(self.power(empty) @ base)
        return np.concatenate(out)
