# SPDX-License-Identifier: GPL-3.0-or-later
"""The feature curve network (section 4): curves as evenly spaced samples in a frame of their own.

The frame makes every later stage independent of the pose, the scale, the order and the direction of the input.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class CurveNetwork:
    """Resampled curves; lengths in edge lengths.

    points : (n, 3) float64, samples about one edge length apart, in the network's frame
    tangents : (n, 3) float64, unit
    weights : (n,) float64, length of curve that a sample stands for
    offsets : (m + 1,) int64; closed : (m,) bool
    curve_of : (n,) int64, the curve of each sample
    strength : (m,) float64, average curvature of each curve (1 / edge length), NaN where unknown
    source : (m,) int64, index of the curve in the Curves it was made from
    rotation, centre, unit : frame to world is ``points * unit @ rotation.T + centre``
    normals, kind : (n, 3) float64, unit, of the surface that the curves are on, and (n,) int64, ridge, valley or
        other; None where unknown
    """

    points: np.ndarray
    tangents: np.ndarray
    weights: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    curve_of: np.ndarray
    strength: np.ndarray
    source: np.ndarray
    rotation: np.ndarray
    centre: np.ndarray
    unit: float
    normals: np.ndarray | None = None
    kind: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def curve(self, i: int) -> np.ndarray:
        """(k, 3) float64, the samples of curve i."""
        return self.points[self.offsets[i] : self.offsets[i + 1]]

    @property
    def lengths(self) -> np.ndarray:
        """(m,) float64, length of each curve in edge lengths."""
        return np.add.reduceat(self.weights, self.offsets[:-1]) if len(self) else np.zeros(0)

    def part(self, curves: np.ndarray) -> CurveNetwork:
        """The network of some curves (k,) int64 alone, in that order and in the same frame."""
        sizes = np.diff(self.offsets)[curves]
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        at = np.arange(offsets[-1]) + np.repeat(self.offsets[curves] - offsets[:-1], sizes)
        return replace(
            self,
            points=self.points[at],
            tangents=self.tangents[at],
            weights=self.weights[at],
            offsets=offsets,
            closed=self.closed[curves],
            curve_of=np.repeat(np.arange(len(curves)), sizes),
            strength=self.strength[curves],
            source=self.source[curves],
            normals=None if self.normals is None else self.normals[at],
            kind=None if self.kind is None else self.kind[at],
        )

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points of the frame, (..., 3), in scene units and world axes."""
        return points * self.unit @ self.rotation.T + self.centre

    def motion_to_world(self, motions: np.ndarray) -> np.ndarray:
        """Rigid motions of the frame, (..., 4, 4), as motions of the world in scene units."""
        frame, back = self._frames()
        return frame @ motions @ back

    def motion_from_world(self, motions: np.ndarray) -> np.ndarray:
        """Rigid motions of the world in scene units, (..., 4, 4), as motions of the frame."""
        frame, back = self._frames()
        return back @ motions @ frame

    def _frames(self):
        """(4, 4) each, frame to world and back."""
        frame, back = np.eye(4), np.eye(4)
        frame[:3, :3], frame[:3, 3] = self.rotation * self.unit, self.centre
        back[:3, :3] = self.rotation.T / self.unit
        back[:3, 3] = -back[:3, :3] @ self.centre
        return frame, back
