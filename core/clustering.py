# SPDX-License-Identifier: GPL-3.0-or-later
"""Clusters of transformations over all pairs of curves (section 4.1.2), refined on the curves they map.

A vote from one short stretch is exact there and wrong far away, so that votes for one transformation lie apart
in transformation space. Therefore the votes are first ranked by what they explain of the whole network and
refined on it; then those for one transformation agree to a fraction of an edge length and clustering is easy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import pdist, squareform

from .geometry.motions import exponential, inverse, screw_velocity
from .matching.voting import Votes
from .network.network import CurveNetwork
from .support import Screen


@dataclass(frozen=True)
class Clusters:
    """Transformations that recur. motions : (k, 4, 4) float64, best supported first; support : (k,) float64,
    length of the network, in edge lengths, that the motion explains; chance : what a wrong motion explains."""

    motions: np.ndarray
    support: np.ndarray
    chance: float

    def __len__(self):
        return len(self.support)


PROBES, SURVIVORS, REFINED = 500, 2000, 400
"""Samples that rank all votes, votes that are ranked on more samples, votes that are refined."""


def cluster_votes(
    network: CurveNetwork, votes: Votes, screen: Screen, *, cluster_translation, cluster_rotation, progress=None
):
    """Clusters of the votes.

    Parameters
    ----------
    screen : support on all samples, within the final tolerance
    cluster_translation : edge lengths, between two motions of the network's centre
    cluster_rotation : degrees
    """
    report = (lambda f: progress("clustering", f)) if progress else (lambda f: None)
    n = len(network.points)
    if not len(votes):
        return Clusters(np.zeros((0, 4, 4)), np.zeros(0), chance_support(screen, np.zeros((0, 4, 4))))
    wide = {"radius": 2 * screen.radius, "threads": screen.threads, "tick": screen.tick}
    motions = votes.motions
    if len(motions) > SURVIVORS:
        probe = Screen(network, stride=max(1, n // PROBES), stretch=0, **wide)
        motions = _best(probe, motions, SURVIVORS, lambda f: report(0.3 * f))
    middle = Screen(network, stride=3, stretch=10, **wide)
    motions = _best(middle, motions, SURVIVORS, lambda f: report(0.3 + 0.2 * f))
    # Votes near each other are refined to the same motion: one of them is enough, and others get their turn.
    _, lead = np.unique(group_motions(motions, 6.0, 3.0), return_index=True)
    motions = motions[np.sort(lead)[:REFINED]]
    motions = _refined(middle, motions, 4, lambda f: report(0.5 + 0.2 * f))
    motions, _ = _leading(middle, motions, cluster_translation, cluster_rotation)
    # T and its inverse are one fact: turn all the same way.
    motions = np.where(_backward(motions)[:, None, None], inverse(motions), motions)
    motions = _refined(screen, motions, 2, lambda f: report(0.7 + 0.15 * f))
    motions, _ = _leading(screen, motions, cluster_translation, cluster_rotation)
    motions = _refined(screen, motions, 2, lambda f: report(0.85 + 0.1 * f))
    motions, support = _leading(screen, motions, cluster_translation, cluster_rotation)
    report(1.0)
    return Clusters(motions, support, chance_support(screen, motions[:40]))


def _leading(screen, motions, translation, rotation):
    """The best supported motion of each cluster, best first, and what supports it."""
    support = screen.score(motions)
    order = np.argsort(-support, kind="stable")
    order = order[support[order] > 0]
    _, lead = np.unique(group_motions(motions[order], translation, rotation), return_index=True)
    order = order[np.sort(lead)]
    return motions[order], support[order]


def group_motions(motions, translation, rotation):
    """(k,) int labels of the hierarchical clustering with complete linkage.

    Two motions are in one cluster when they take the centre to within `translation` edge lengths of each other
    and their rotations differ by at most `rotation` degrees, and so do all others of the cluster.
    """
    if len(motions) < 2:
        return np.zeros(len(motions), np.int64)
    r = motions[:, :3, :3].reshape(-1, 9)
    # |R1 - R2| = 2 sqrt(2) sin(angle / 2) in the Frobenius norm.
    angle = pdist(r) / (2 * np.sqrt(2) * np.sin(np.radians(rotation) / 2))
    gap = squareform(np.maximum(angle, pdist(motions[:, :3, 3]) / translation))
    # Clusters do not reach from one island of near motions to another, and scipy holds the GIL for each linkage.
    count, island = connected_components(coo_matrix(gap <= 1.0), directed=False)
    members = np.split(np.argsort(island, kind="stable"), np.cumsum(np.bincount(island))[:-1])
    labels = np.zeros(len(motions), np.int64)
    for own in members:
        if len(own) > 1:
            tree = linkage(squareform(gap[np.ix_(own, own)], checks=False), "complete")
            labels[own] = fcluster(tree, 1.0, "distance") - 1
    return labels * count + island


def chance_support(screen: Screen, motions, *, tries=4, seed=0):
    """Length that motions explain by chance, in edge lengths: those beside the true ones, a few edges and degrees off.

    The network is as dense there as under the true motion, but nothing corresponds. Four in five explain less.
    """
    if not len(motions):
        return 0.0
    off = perturbed(np.repeat(motions, tries, axis=0), screen.points.std(axis=0), seed)
    return float(np.quantile(screen.score(off), 0.8))


def perturbed(motions, spread, seed=0):
    """Motions 7 to 13 edge lengths and 4 to 8 degrees beside the given ones; the shift is in proportion to the
    spread (3,) of the curves along the axes, so that a flat network stays in its plane."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(len(motions), 3)) * spread / np.linalg.norm(spread)
    way *= rng.uniform(7, 13, size=(len(way), 1)) / np.linalg.norm(way, axis=1)[:, None]
    turn = rng.normal(size=way.shape)
    turn *= np.radians(rng.uniform(4, 8, size=(len(way), 1))) / np.linalg.norm(turn, axis=1)[:, None]
    return exponential(np.concatenate([turn, way], axis=1)) @ motions


def _backward(motions):
    """Whether the motion's axis or, without a turn, its translation points against the network's axes."""
    w, u = screw_velocity(motions)
    turn = np.linalg.norm(w, axis=1) > np.radians(2)
    v = np.where(turn[:, None], w, u)
    lead = np.argmax(np.abs(v) > 0.3 * np.abs(v).max(axis=1, keepdims=True), axis=1)
    return v[np.arange(len(v)), lead] < 0


def _slices(count, report, size):
    for i in range(0, count, size):
        yield slice(i, i + size)
        report(min(1.0, (i + size) / count))


def _best(screen, motions, most, report):
    score = np.concatenate([screen.score(motions[part]) for part in _slices(len(motions), report, 1000)])
    return motions[np.argsort(-score, kind="stable")[:most]]


def _refined(screen, motions, rounds, report):
    parts = [screen.refine(motions[part], rounds) for part in _slices(len(motions), report, 100)]
    return np.concatenate([motions[:0], *parts])
