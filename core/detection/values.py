# SPDX-License-Identifier: GPL-3.0-or-later
"""What detection returns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..values import Curves

KINDS = ("ridge", "valley", "sharp", "boundary")
RIDGE, VALLEY, SHARP, BOUNDARY = range(4)


@dataclass(frozen=True)
class FeatureCurves:
    """Feature curves of a surface, longest first.

    curves : points on the surface, with the maximal absolute principal curvature as strength (1 / length)
    kind : (m,) int64, index into `KINDS`
    length : (m,) float64, scene units
    mean_strength : (m,) float64, 1 / length, average along the curve
    mean_fold : (m,) float64, degrees, average angle of the fold that the strength stands for (docs/detection.md)
    edge_length : mean edge length of the mesh, scene units
    detail : the smoothing scale that was used, edge lengths
    """

    curves: Curves
    kind: np.ndarray
    length: np.ndarray
    mean_strength: np.ndarray
    mean_fold: np.ndarray
    edge_length: float
    detail: float

    def __len__(self) -> int:
        return len(self.kind)

    def select(self, wanted: np.ndarray) -> FeatureCurves:
        """The curves of a mask (m,) bool or of indices (k,), in that order; cheap enough for a slider."""
        index = np.arange(len(self))[wanted]
        c = self.curves
        sizes = np.diff(c.offsets)[index]
        offsets = np.r_[0, np.cumsum(sizes)].astype(np.int64)
        at = np.arange(offsets[-1]) + np.repeat(c.offsets[index] - offsets[:-1], sizes)
        curves = Curves(c.points[at], offsets, c.closed[index], c.strength[at], normals=c.normals[at], kind=c.kind[at])
        values = (x[index] for x in (self.kind, self.length, self.mean_strength, self.mean_fold))
        return FeatureCurves(curves, *values, self.edge_length, self.detail)

    def at_least(self, *, fold: float = 0.0, length: float = 0.0) -> FeatureCurves:
        """The curves with a mean fold of at least `fold` degrees and a length of at least `length` edges.

        Sharp edges and boundaries are asked for their length only.
        """
        sharp = self.mean_fold >= fold
        return self.select((sharp | (self.kind >= SHARP)) & (self.length >= length * self.edge_length))
