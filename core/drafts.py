# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts of templates: clean curves with the places where they recur, and what the network shows of them there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from .geometry.polylines import directions
from .network.network import CurveNetwork


@dataclass(frozen=True)
class Draft:
    """Clean curves of one common cell and the places where the cell recurs.

    curves : list of (k, 3) float64 points in the cell's frame; closed : list of bool
    poses : (a, 4, 4) float64, cell to network; keys : (a, g) int64, powers of the generators
    evidence : (a, c) float64, share of each curve that the network shows in each cell
    transformation : index of the orbit in the model
    orbital : (a,) bool, whether the occurrence is a cell of that orbit; its keys mean nothing where it is not
    """

    curves: list
    closed: list
    poses: np.ndarray
    keys: np.ndarray
    evidence: np.ndarray
    transformation: int
    orbital: np.ndarray

    def part(self, curves=None, cells=None) -> Draft:
        """The draft with only some of its curves and occurrences (indices)."""
        curves = np.arange(len(self.curves)) if curves is None else np.asarray(curves, np.int64)
        cells = np.arange(len(self.poses)) if cells is None else np.asarray(cells, np.int64)
        return replace(
            self,
            curves=[self.curves[i] for i in curves],
            closed=[self.closed[i] for i in curves],
            poses=self.poses[cells],
            keys=self.keys[cells],
            evidence=self.evidence[np.ix_(cells, curves)],
            orbital=self.orbital[cells],
        )

    @property
    def lengths(self) -> np.ndarray:
        """(c,) float64, about the length of each curve, edge lengths."""
        return np.array([len(c) for c in self.curves], float)


def placed(draft: Draft):
    """Points (k, 3), tangents (k, 3), occurrence (k,) and curve (k,) of all curves at all occurrences."""
    one = np.concatenate(draft.curves)
    way = np.concatenate([directions(c) for c in draft.curves])
    curve = np.repeat(np.arange(len(draft.curves)), [len(c) for c in draft.curves])
    r, t = draft.poses[:, :3, :3], draft.poses[:, None, :3, 3]
    points = one @ np.swapaxes(r, 1, 2) + t
    tangents = way @ np.swapaxes(r, 1, 2)
    a = len(draft.poses)
    return points.reshape(-1, 3), tangents.reshape(-1, 3), np.repeat(np.arange(a), len(one)), np.tile(curve, a)


def along(network: CurveNetwork, points, tangents, radius, cosine=0.7):
    """Which samples (n,) bool lie along the given points, the nearest such point (n,) and its distance (n,)."""
    distance, near = cKDTree(points).query(network.points, k=4, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    good = found & (np.abs((tangents[near] * network.tangents[:, None]).sum(-1)) > cosine)
    first = np.argmax(good, axis=1)
    rows = np.arange(len(near))
    return good.any(axis=1), near[rows, first], np.where(good.any(axis=1), distance[rows, first], np.inf)


def explained_samples(network: CurveNetwork, draft: Draft, *, radius, rivals: Draft | None = None):
    """(n,) bool, samples that lie along a curve of the draft at one of its occurrences.

    rivals : curves that samples may belong to instead, where they are clearly nearer
    """
    seen, _, distance = along(network, *placed(draft)[:2], radius)
    if rivals is not None and rivals.curves:
        seen &= distance <= along(network, *placed(rivals)[:2], radius)[2] + RIVAL
    return seen


def explained_length(network: CurveNetwork, drafts, *, radius) -> float:
    """Length of the samples that lie along some of the drafts, edge lengths."""
    if not drafts:
        return 0.0
    shown = np.any([explained_samples(network, d, radius=radius) for d in drafts], axis=0)
    return float(network.weights[shown].sum())


RIVAL = 1.0
"""Edge lengths by which another curve must be nearer to a sample to have it."""

BLOCK = 100_000
"""Points that are looked up at a time; bounds the memory, not the result."""


def seen_share(network: CurveNetwork, curves, poses, *, radius, free=None, cosine=0.75):
    """(a, c) float64, share of each curve, placed by each pose, that lies along samples of the network.

    free : (n,) bool, samples that count; None takes all
    """
    size = np.array([len(c) for c in curves])
    seen = seen_points(network, curves, poses, radius=radius, free=free, cosine=cosine)
    return np.add.reduceat(seen, np.cumsum(size) - size, axis=1, dtype=float) / size


def seen_points(network: CurveNetwork, curves, poses, *, radius, free=None, cosine=0.75):
    """(a, n) bool, which of the n points of all curves lie along samples of the network; as in `seen_share`."""
    points = np.concatenate(curves)
    tangents = np.concatenate([directions(c) for c in curves])
    samples = np.arange(len(network.points)) if free is None else np.flatnonzero(free)
    seen = np.zeros((len(poses), len(points)), bool)
    if not len(samples):
        return seen
    tree, lines = cKDTree(network.points[samples]), network.tangents[samples]
    block = max(1, BLOCK // len(points))
    for begin in range(0, len(poses), block):
        r, t = poses[begin : begin + block, :3, :3], poses[begin : begin + block, None, :3, 3]
        at, way = points @ np.swapaxes(r, 1, 2) + t, tangents @ np.swapaxes(r, 1, 2)
        distance, near = tree.query(at, k=3, distance_upper_bound=radius, workers=-1)
        found = np.isfinite(distance)
        same = np.abs((lines[np.where(found, near, 0)] * way[:, :, None]).sum(-1)) > cosine
        seen[begin : begin + block] = (found & same).any(axis=-1)
    return seen
