# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a moved point meets the network: the only place that answers "is it seen there"."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from time import monotonic

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from ..network.network import CurveNetwork
from .nearest import NearestTable

COSINE = 0.8
"""Least cosine between the tangent of a moved point and that of the sample that shows it (tolerance)."""

FACING = 0.7
"""Least cosine between the normals of the surface at a sample and at its image (tolerance). Noise turns them by 20
degrees; the inner and the outer side of a moulding, which runs beside itself, lie farther apart."""

PAUSE = 0.1
"""Seconds between two ticks."""

REACH = 6.0
"""Largest distance at which a sample is looked up, edge lengths (bounds the table)."""


@dataclass(frozen=True)
class Probe:
    """Points with the directions of their curves.

    points, tangents : (..., m, 3) float64; normals : (..., m, 3) of the surface, or None; kind : (..., m) int64 or None
    """

    points: np.ndarray
    tangents: np.ndarray
    normals: np.ndarray | None = None
    kind: np.ndarray | None = None

    def __len__(self):
        return self.points.shape[-2]

    def take(self, which) -> Probe:
        """The probe of some of its points (indices or flags), along the second last axis of the points."""
        pick = lambda x: None if x is None else x[which]  # noqa: E731
        return Probe(self.points[which], self.tangents[which], pick(self.normals), pick(self.kind))

    def moved(self, poses) -> Probe:
        """The probe under motions (k, 4, 4): arrays of (k, m, 3)."""
        r, t = np.swapaxes(poses[:, :3, :3], 1, 2), poses[:, None, :3, 3]
        normals = None if self.normals is None else self.normals @ r
        return Probe(self.points @ r + t, self.tangents @ r, normals, self.kind)


class Field:
    """The samples of a network, with a table of the nearest ones and the graph of their neighbourhood.

    Parameters
    ----------
    radius : edge lengths, within which a sample shows a point
    tick : called every tenth of a second while the field is asked; may raise Cancelled, which is passed on
    """

    def __init__(self, network: CurveNetwork, *, radius, tick=None):
        self.network, self.radius = network, radius
        self._tick, self._ticked = tick, monotonic()
        self.points, self.tangents, self.weights = network.points, network.tangents, network.weights
        self.tree = cKDTree(self.points)
        self._table = NearestTable(self.points, REACH, radius / 2)

    def __len__(self):
        return len(self.points)

    def probe(self, samples) -> Probe:
        """Samples (..., m) int64 of the network as a probe."""
        n = self.network
        pick = lambda x: None if x is None else x[samples]  # noqa: E731
        return Probe(n.points[samples], n.tangents[samples], pick(n.normals), pick(n.kind))

    def nearest(self, points, radius=None):
        """Nearest samples (...,) int32 of points (..., 3), -1 where none is within the radius."""
        near = self._table.look_up(points)
        gap = points - np.take(self.points, near, axis=0)
        radius = self.radius if radius is None else radius
        near[np.einsum("...i,...i->...", gap, gap) > radius * radius] = -1
        return near

    def shown_by(self, probe: Probe, radius=None):
        """Samples (...,) int32 that show a probe's points, or -1: near, along the same line, facing the same way."""
        if self._tick and monotonic() - self._ticked > PAUSE:
            self._ticked = monotonic()
            self._tick()
        near = self.nearest(probe.points, radius)
        same = np.abs(np.einsum("...i,...i->...", np.take(self.tangents, near, axis=0), probe.tangents)) > COSINE
        if probe.normals is not None and self.network.normals is not None:
            same &= np.einsum("...i,...i->...", np.take(self.network.normals, near, axis=0), probe.normals) > FACING
        if probe.kind is not None and self.network.kind is not None:
            same &= self.network.kind[near] == probe.kind
        near[~same] = -1
        return near

    def targets(self, poses, probe: Probe, radius=None):
        """(k, m) int32, the sample that shows each point of a probe at each pose (k, 4, 4), or -1."""
        return self.shown_by(probe.moved(poses), radius)

    @cached_property
    def beside(self):
        """(n, n) sparse bool, samples within 1.25 radii of each other."""
        pairs = self.tree.query_pairs(1.25 * self.radius, output_type="ndarray")
        own = np.arange(len(self))
        i, j = np.r_[pairs[:, 0], pairs[:, 1], own], np.r_[pairs[:, 1], pairs[:, 0], own]
        return coo_matrix((np.ones(len(i), np.float32), (i, j)), shape=(len(self),) * 2).tocsr()

    def widened(self, flags):
        """(n,) bool, the flagged samples and those beside them."""
        return self.beside @ flags.astype(np.float32) > 0

    @cached_property
    def graph(self):
        """Every third sample as a node; near ones are joined at the cost of their squared distance."""
        node = np.arange(0, len(self), 3)
        tree = cKDTree(self.points[node])
        i, j = tree.query_pairs(14.0, output_type="ndarray").T
        cost = ((self.points[node[i]] - self.points[node[j]]) ** 2).sum(axis=1) + 0.1
        k = len(node)
        return coo_matrix((np.r_[cost, cost], (np.r_[i, j], np.r_[j, i])), shape=(k, k)).tocsr(), tree.query(
            self.points
        )[1]

    def watershed(self, label):
        """(n,) int64, for each sample the label of the labelled sample that is nearest through the network.

        label : (n,) int64, -1 where unknown, and where nothing labelled can be reached
        """
        graph, node_of = self.graph
        node = np.full(graph.shape[0], -1)
        known = label >= 0
        node[node_of[known]] = label[known]
        source = np.flatnonzero(node >= 0)
        if not len(source):
            return np.full(len(label), -1)
        _, _, root = dijkstra(graph, indices=source, min_only=True, return_predecessors=True)
        out = np.where(root >= 0, node[np.maximum(root, 0)], -1)[node_of]
        return np.where(known, label, out)
