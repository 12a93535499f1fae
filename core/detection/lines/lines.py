# SPDX-License-Identifier: GPL-3.0-or-later
"""A graph of points on the surface and segments between them: what every stage after tracing works on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..chains import Chains, chains


@dataclass(frozen=True)
class Lines:
    """Points on the surface joined by segments, all of one kind.

    points, normals : (p, 3) float64
    strength : (p,) float64, maximal absolute principal curvature, 1 / length
    fold : (p,) float64, radians, the angle of the fold that the strength stands for at the smoothing used
    segments : (s, 2) int64, over the points
    """

    points: np.ndarray
    normals: np.ndarray
    strength: np.ndarray
    fold: np.ndarray
    segments: np.ndarray

    def chains(self) -> Chains:
        """The polylines of the segments."""
        return chains(self.segments, len(self.points))

    def with_segments(self, segments: np.ndarray) -> Lines:
        """The same points joined otherwise."""
        return replace(self, segments=np.asarray(segments, np.int64).reshape(-1, 2))

    def extended(self, points, normals, strength, fold, segments) -> Lines:
        """More points, and segments over old and new points."""
        return Lines(
            np.concatenate([self.points, points]),
            np.concatenate([self.normals, normals]),
            np.concatenate([self.strength, strength]),
            np.concatenate([self.fold, fold]),
            np.concatenate([self.segments, np.reshape(segments, (-1, 2))]).astype(np.int64),
        )


def weights(lines: Chains, points: np.ndarray) -> np.ndarray:
    """(k,) float64, the length that each entry of `lines.nodes` stands for: half of its segments."""
    a, b = lines.following()
    half = 0.5 * np.linalg.norm(points[lines.nodes[b]] - points[lines.nodes[a]], axis=1)
    k = len(lines.nodes)
    return np.bincount(a, half, k) + np.bincount(b, half, k)


def travelled(lines: Chains, points: np.ndarray) -> np.ndarray:
    """(k,) float64, the length up to each entry of `lines.nodes`, rising along the array from chain to chain."""
    along = points[lines.nodes]
    step = np.linalg.norm(np.diff(along, axis=0, prepend=along[:1]), axis=1)
    step[lines.offsets[:-1]] = 0
    return np.cumsum(step)


def tangents(lines: Chains, points: np.ndarray) -> np.ndarray:
    """(k, 3) float64, unit direction at each entry of `lines.nodes`, from the entry before to the one after."""
    a, b = lines.following()
    step = points[lines.nodes[b]] - points[lines.nodes[a]]
    k = len(lines.nodes)
    total = np.stack([np.bincount(a, step[:, c], k) + np.bincount(b, step[:, c], k) for c in range(3)], axis=1)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
