# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses of a known thing anywhere in the network: pairs of its points against all pairs of the network.

Seeds come from matches of two noisy fragments. A thing that is known is the mean of many: where it is seen by short
pieces only, no match leads to it. Two points and the directions of their curves fix a pose, and few pairs of points of
a network are like a given one (point pair features: Drost, Ulrich, Navab and Ilic 2010).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.field import Field
from ..geometry.motions import motion
from .extent import spread
from .hypothesis import Hypothesis

APART, NEAREST, FARTHEST = 2.5, 10.0, 40.0
"""Edge lengths between the points of the network that are paired, and from the one to the other of a pair."""

DISTANCE, ANGLE = 2.0, 0.25
"""Edge lengths and radians by which pairs that are alike may differ (tolerances: a little over the noise)."""

BENT = 0.5
"""Radians by which one of the directions must turn from the line through both points: a pair along one straight line
fixes no turn about it (tolerance)."""

ASKED, PAIRS, EACH, CROWDED = 1500, (40, 200), 8, 300_000
"""Pairs of a thing of which the rarest are taken, how many at least and at most, at how many each point may be, and
pairs of the network in the cells about them at which it is enough; counts that bound the work."""

GLANCES, LOOKED, KEPT = (10, 40), 3000, 4
"""Points with which every candidate is looked at, and those of these that are likely; the candidates that are left, and
how many times as many the first look leaves; counts that bound the work."""


class PointPairs:
    """The pairs of points of a network, to be asked for those that are like a pair of a thing."""

    def __init__(self, field: Field):
        self.field = field

    @cached_property
    def nodes(self):
        """(k,) int64, samples about APART apart."""
        return spread(self.field.points, self.field.weights, APART)

    @cached_property
    def pairs(self):
        """(p, 2) int64 nodes, first and second, each pair once; the tree of their features, and how many there are like
        a feature."""
        points, lines = self.field.points[self.nodes], self.field.tangents[self.nodes]
        pair = _pairs_of(points)
        feature, bent = features(points, lines, pair)
        return pair[bent], cKDTree(feature[bent]), Crowd(feature[bent])

    def poses(self, thing: Hypothesis):
        """(k, 4, 4) float64, candidates that lead from the frame of a thing to the network."""
        pair, tree, crowd = self.pairs
        mine = _pairs_of(thing.points)
        if not len(mine) or not len(pair):
            return np.zeros((0, 4, 4))
        mine = mine[np.unique((np.arange(ASKED) + 0.5) * len(mine) // ASKED).astype(int)]
        feature, bent = features(thing.points, thing.tangents, mine)
        mine, feature = mine[bent], feature[bent]
        mine, feature = np.concatenate([mine, mine[:, ::-1]]), np.concatenate([feature, feature[:, [0, 2, 1, 3]]])
        use = _rarest(mine, crowd.about(feature))
        found = tree.query_ball_point(feature[use], 1.0, p=np.inf)
        first = np.repeat(mine[use], [len(f) for f in found], axis=0)
        second = self.nodes[pair[np.concatenate([np.asarray(f, np.int64) for f in found])]] if len(first) else pair[:0]
        return _led(thing, self.field, first, second)


class Crowd:
    """How many features (p, d) lie about a place: counted in cells of one tolerance, the cell and those around it."""

    def __init__(self, features):
        cell = features.astype(int)
        size = cell.max(axis=0, initial=0) + 2
        count = np.zeros(size, np.int64)
        np.add.at(count, tuple(cell.T), 1)
        for axis in range(len(size)):
            wide = count.copy()
            wide[_along(axis, 1, None)] += count[_along(axis, None, -1)]
            wide[_along(axis, None, -1)] += count[_along(axis, 1, None)]
            count = wide
        self.count = count

    def about(self, features):
        """(q,) int64, of features (q, d), how many lie in the cell of each and in those around it."""
        return self.count[tuple(np.minimum(features.astype(int), np.array(self.count.shape) - 1).T)]


def _along(axis, start, stop):
    return (slice(None),) * axis + (slice(start, stop),)


def features(points, lines, pair):
    """(p, 4) float64, of pairs of points (p, 2) with undirected lines: distance, angles of both lines with the line
    between the points, and with each other, in multiples of the tolerances; and whether (p,) bool they fix a pose."""
    way = points[pair[:, 1]] - points[pair[:, 0]]
    size = np.linalg.norm(way, axis=1)
    way /= np.maximum(size, 1e-9)[:, None]
    a, b = lines[pair[:, 0]], lines[pair[:, 1]]
    angle = lambda x, y: np.arccos(np.clip(np.abs((x * y).sum(axis=1)), 0, 1))  # noqa: E731
    first, second = angle(a, way), angle(b, way)
    feature = np.stack([size / DISTANCE, first / ANGLE, second / ANGLE, angle(a, b) / ANGLE], axis=1)
    return feature, np.maximum(first, second) > BENT


def _pairs_of(points):
    pair = cKDTree(points).query_pairs(FARTHEST, output_type="ndarray").reshape(-1, 2)
    pair = pair[((points[pair[:, 0]] - points[pair[:, 1]]) ** 2).sum(axis=1) > NEAREST**2]
    return pair[np.lexsort((pair[:, 1], pair[:, 0]))]


def _rarest(pair, count):
    """Indices of the pairs that few are like, but some, each point at few of them."""
    often, out, crowd = np.zeros(pair.max(initial=-1) + 1, int), [], 0
    order = np.argsort(count, kind="stable")
    for k in order[count[order] > 0]:
        if (often[pair[k]] < EACH).all():
            often[pair[k]] += 1
            out.append(k)
            crowd += count[k]
            if len(out) == PAIRS[1] or (len(out) >= PAIRS[0] and crowd > CROWDED):
                break
    return np.array(out, np.int64)


def _led(thing, field, first, second):
    """Poses (k, 4, 4) that take pairs of points of a thing (p, 2) onto pairs of samples (p, 2), the likely ones."""
    if not len(first):
        return np.zeros((0, 4, 4))
    a, b = thing.points[first], field.points[second]
    u, v = thing.tangents[first], field.tangents[second]
    frame, more = _frames(a, u)
    image, _ = _frames(b, v, more)
    out = []
    # Lines have no direction: the image may be turned by half a turn about the line through both points.
    for flip in (1.0, -1.0):
        turn = image * np.array([1.0, flip, flip]) @ np.swapaxes(frame, 1, 2)
        fits = np.abs(np.einsum("pij,pkj,pki->pk", turn, u, v)).min(axis=1) > np.cos(1.5 * ANGLE)
        turn = turn[fits]
        shift = b[fits].mean(axis=1) - np.einsum("pij,pj->pi", turn, a[fits].mean(axis=1))
        out.append(motion(turn, shift))
    return _glanced(thing, field, np.concatenate(out))


def _glanced(thing, field, poses, size=5000):
    """Those of the poses (k, 4, 4) at which the most points of the thing are near a sample."""
    for points, most, least in zip(GLANCES, (KEPT * LOOKED, LOOKED), (0.2, 0.4)):
        probe = thing.probe.take(slice(None, None, max(1, len(thing.points) // points)))
        parts = [poses[i : i + size] for i in range(0, len(poses), size)]
        share = np.concatenate([(field.targets(p, probe, 2 * field.radius) >= 0).mean(axis=1) for p in parts] or [[]])
        order = np.argsort(-share, kind="stable")[:most]
        poses = poses[order[share[order] > least * thing.shown]]
    return poses


def _frames(points, lines, more=None):
    """Axes (p, 3, 3) as columns, along a pair of points (p, 2, 3), across it along one of its lines (p, 2, 3), and
    across both; and which line (p,) it is, the one across the most where it is not given."""
    way = points[:, 1] - points[:, 0]
    way = way / np.maximum(np.linalg.norm(way, axis=1), 1e-9)[:, None]
    off = lines - np.einsum("pki,pi->pk", lines, way)[..., None] * way[:, None]
    if more is None:
        more = np.linalg.norm(off, axis=2).argmax(axis=1)
    off = off[np.arange(len(off)), more]
    off = off / np.maximum(np.linalg.norm(off, axis=1), 1e-9)[:, None]
    return np.stack([way, off, np.cross(way, off)], axis=2), more
