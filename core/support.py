# SPDX-License-Identifier: GPL-3.0-or-later
"""What a motion explains: samples that it takes onto the network along stretches, not here and there.

A sample is supported when the motion takes it to within a radius of a sample with the same tangent line, and
so do its neighbours along the curve for at least `stretch` edge lengths. Single hits are what chance gives in
a dense network; whole stretches are not.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from scipy.spatial import cKDTree

from .geometry.motions import best_rotation, exponential, inverse, motion, screw_velocity
from .network.network import CurveNetwork

FACING = 0.7
"""Least cosine between the normals of the surface at a sample and at its image. Noise turns them by 20 degrees; the
inner and the outer side of a moulding, which runs beside itself, lie farther apart."""


class NeighbourField:
    """Nearest sample of the network by table look-up: one entry a voxel, exact to half a voxel.

    points : (n, 3) in the network's frame, where the box around them is tight
    radius : look-ups farther than this from every sample give -1
    """

    def __init__(self, points, radius, *, voxel=None, most=1 << 26):
        self.low = points.min(axis=0) - radius
        extent = points.max(axis=0) + radius - self.low
        voxel = radius / 2 if voxel is None else voxel
        while np.prod(np.ceil(extent / voxel) + 1) > most:
            voxel *= 1.2
        self.voxel = voxel
        self.shape = (np.ceil(extent / voxel) + 1).astype(np.int64)
        self.strides = np.array([self.shape[1] * self.shape[2], self.shape[2], 1])
        reach = int(np.ceil(radius / voxel))
        k = np.arange(-reach, reach + 1)
        ball = np.stack(np.meshgrid(k, k, k, indexing="ij"), -1).reshape(-1, 3)
        ball = ball[np.linalg.norm(np.maximum(np.abs(ball) - 1, 0), axis=1) * voxel <= radius]
        cell = np.unique(((points - self.low) / voxel).astype(np.int64) @ self.strides)
        cell = np.stack(np.unravel_index(cell, self.shape), axis=1)
        near = np.zeros(np.prod(self.shape), bool)
        for offset in ball:
            at = cell + offset
            at = at[((at >= 0) & (at < self.shape)).all(axis=1)]
            near[at @ self.strides] = True
        near = np.flatnonzero(near)
        centre = (np.stack(np.unravel_index(near, self.shape), axis=1) + 0.5) * voxel + self.low
        distance, sample = cKDTree(points).query(centre, distance_upper_bound=radius + voxel, workers=-1)
        self.table = np.full(np.prod(self.shape), -1, np.int32)
        found = np.isfinite(distance)
        self.table[near[found]] = sample[found]

    def look_up(self, x, y, z):
        """Nearest samples (...,) int32, or -1, at voxel coordinates (...,) int32."""
        inside = (x >= 0) & (y >= 0) & (z >= 0)
        inside &= (x < self.shape[0]) & (y < self.shape[1]) & (z < self.shape[2])
        key = x * np.int32(self.strides[0])
        key += y * np.int32(self.strides[1])
        key += z
        key *= inside
        near = np.take(self.table, key, mode="clip")
        near[~inside] = -1
        return near


def long_stretches(hit, run_of, least):
    """Of boolean samples (h, n), those in unbroken stretches of at least `least` samples of one run.

    run_of : (n,) int64, changes where a new curve begins
    least : int or (n,) int64
    """
    h, n = hit.shape
    new = np.ones(n, bool)
    new[1:] = run_of[1:] != run_of[:-1]
    at = np.arange(n)
    begin = hit & (new | ~np.concatenate([np.zeros((h, 1), bool), hit[:, :-1]], axis=1))
    start = np.maximum.accumulate(np.where(begin | ~hit, at, 0), axis=1)
    ends = np.concatenate([new[1:], [True]])
    end = hit & (ends | ~np.concatenate([hit[:, 1:], np.zeros((h, 1), bool)], axis=1))
    stop = np.minimum.accumulate(np.where(end | ~hit, at, n)[:, ::-1], axis=1)[:, ::-1]
    return hit & (stop - start + 1 >= least)


def in_long_stretches(row, sample, run_of, least):
    """(k,) bool, which hits lie in unbroken stretches; the hits being sorted by row and sample.

    row, sample : (k,) int64; run_of, least : as in `long_stretches`, of which this is the sparse form
    """
    if not len(row):
        return np.zeros(0, bool)
    new = np.ones(len(row), bool)
    new[1:] = (np.diff(sample) != 1) | (np.diff(row) != 0) | (run_of[sample[1:]] != run_of[sample[:-1]])
    run = np.cumsum(new) - 1
    return np.bincount(run)[run] >= (least if np.isscalar(least) else least[sample])


def slips(motions, row, points, tangents, cosine=0.95):
    """Where a curve runs along the motion itself, (k,) bool: shifted a little further it would fit as well.

    row : (k,) int64, the motion of each sample; points, tangents : (k, 3) float64

    A motion is one moment of the screw motion v(p) = w x p + u that leads to it. A straight line along a
    translation and a circle about a rotation axis fit at every moment; that they fit at this one tells nothing.
    """
    w, u = (x[row] for x in screw_velocity(motions))
    x, y, z = points.T
    v = np.stack([w[:, 1] * z - w[:, 2] * y, w[:, 2] * x - w[:, 0] * z, w[:, 0] * y - w[:, 1] * x], axis=1) + u
    along = (v * tangents).sum(-1)
    return along**2 > cosine**2 * (v**2).sum(-1)


def _sums_of_rows(terms, row, count):
    """(count, c) float64, sums of the terms (k, c) of each row; `row` (k,) is sorted."""
    if not len(row):
        return np.zeros((count, terms.shape[1]))
    ends = np.searchsorted(row, np.arange(count + 1))
    sums = np.add.reduceat(terms, np.minimum(ends[:-1], len(row) - 1), axis=0)
    sums[ends[1:] == ends[:-1]] = 0
    return sums


class Screen:
    """Support of many motions at once on every `stride`-th sample, by table look-up.

    Parameters
    ----------
    source : the network whose samples are moved onto `network`; None takes `network` itself
    radius : largest distance of a sample from the network after the motion
    cosine : least cosine between the tangents
    stretch : shortest supported stretch
    still : a sample that moves less is no recurrence; None where samples may stay where they are
    field : look-up table of `network` for this radius, if there is one already
    tick : called between blocks of work; may raise Cancelled
    """

    def __init__(
        self, network: CurveNetwork, source=None, *, radius, stride=1, cosine=0.8, stretch=8.0, still=4.0, threads=1,
        tick=None, field=None,
    ):  # fmt: skip
        self.tick = tick or (lambda: None)
        self.field = NeighbourField(network.points, radius) if field is None else field
        source = network if source is None else source
        pick = np.arange(0, len(source.points), stride)
        self.points, self.tangents = source.points[pick], source.tangents[pick]
        # One row a coordinate: look-ups by `take` are fast on them, and let other threads run.
        self.homogeneous = np.concatenate([self.points, np.ones((len(pick), 1))], axis=1).T.astype(np.float32)
        self.all_points, self.all_tangents = network.points, network.tangents
        self.all_lines = np.ascontiguousarray(network.tangents.T, np.float32)
        self.all_normals = None if network.normals is None else np.ascontiguousarray(network.normals.T, np.float32)
        self.all_kinds = network.kind
        self.kind = None if source.kind is None or network.kind is None else source.kind[pick]
        self.normals = None
        if source.normals is not None and network.normals is not None:
            self.normals = np.ascontiguousarray(source.normals[pick].T, np.float32)
        self.lines = np.ascontiguousarray(self.tangents.T, np.float32)
        self.curve = source.curve_of[pick]
        self.weight = source.weights[pick] * stride
        self.least = max(1, int(np.ceil(stretch / stride)))
        self.radius, self.cosine, self.still, self.threads = radius, cosine, still, threads

    def hits(self, motions):
        """Agreeing samples as (row, sample, target), each (k,) int64, sorted by row and sample.

        Row r, sample k: motion r takes sample k to within the radius of sample `target` of the whole network, with
        the same tangent line, and moves it at all. Where the surface is known, its outside stays outside and
        a ridge a ridge: a thing that is nearly flat and mirror-symmetric fits itself turned front to back, and the
        lines of a moulding fit each other, but neither is there twice.
        """
        n = len(self.points)
        to_voxel = np.eye(4)
        to_voxel[:3] /= self.field.voxel
        to_voxel[:3, 3] = -self.field.low / self.field.voxel
        rows = (to_voxel @ motions)[:, :3, :].astype(np.float32)
        at = [(rows[:, c] @ self.homogeneous).astype(np.int32) for c in range(3)]
        near = self.field.look_up(*at).ravel()
        flat = np.flatnonzero(near >= 0)
        j = np.take(near, flat)
        turns = motions[:, :3, :3].astype(np.float32)
        keep = np.abs(self._cosines(turns, self.lines, self.all_lines, flat, j)) > self.cosine
        flat, j = np.compress(keep, flat), np.compress(keep, j)
        if self.normals is not None:
            keep = self._cosines(turns, self.normals, self.all_normals, flat, j) > FACING
            flat, j = np.compress(keep, flat), np.compress(keep, j)
        i = flat // n
        k = flat - i * n
        if self.kind is not None:
            keep = np.take(self.kind, k) == np.take(self.all_kinds, j)
            i, k, j = np.compress(keep, i), np.compress(keep, k), np.compress(keep, j)
        if self.still is not None:
            keep = self._travel(motions, i, k) > self.still**2
            i, k, j = np.compress(keep, i), np.compress(keep, k), np.compress(keep, j)
        return i, k, j.astype(np.int64)

    @staticmethod
    def _cosines(turns, own, other, flat, j):
        """(f,) float32, between turned directions (3, n) and others (3, m); `flat` counts turns times n, `j` m."""
        total = np.zeros(len(flat), np.float32)
        for c in range(3):
            total += np.take((turns[:, c] @ own).ravel(), flat) * np.take(other[c], j)
        return total

    def nearest(self, motions):
        """Nearest samples (h, n) int64 of the moved samples where they agree, and which agree (h, n) bool."""
        i, k, j = self.hits(motions)
        near = np.zeros((len(motions), len(self.points)), np.int64)
        hit = np.zeros(near.shape, bool)
        near[i, k], hit[i, k] = j, True
        return near, hit

    def _travel(self, motions, row, sample):
        """(k,) float32, squared length of the way of a sample under a motion."""
        move = (motions - np.eye(4))[:, :3, :].astype(np.float32)
        total = np.zeros(len(row), np.float32)
        for c in range(3):
            way = np.take(move[:, c, 3], row)
            for d in range(3):
                way += np.take(move[:, c, d], row) * np.take(self.homogeneous[d], sample)
            total += way * way
        return total

    def _specific(self, motions, row, sample):
        """Which hits do not slip along their motions."""
        return ~slips(motions, row, self.points[sample], self.tangents[sample])

    def _chunks(self, motions, function, chunk):
        chunk = chunk or max(1, 100_000 // len(self.points))
        parts = [motions[i : i + chunk] for i in range(0, len(motions), chunk)]
        if len(parts) == 1 or self.threads == 1:
            done = []
            for one in parts:
                done.append(function(one))
                self.tick()
            return done
        with ThreadPoolExecutor(max(1, self.threads)) as pool:
            waiting = [pool.submit(function, part) for part in parts]
            try:
                done = []
                for one in waiting:
                    done.append(one.result())
                    self.tick()
            except BaseException:
                for one in waiting:
                    one.cancel()
                raise
        return done

    def score(self, motions, *, beside=None, weight=None, chunk=None):
        """(h,) float64, supported length of each motion, without the curves that slip along it.

        weight : (n,) float64, length that each sample stands for here; None takes that of the network
        beside : (h, 4, 4), motions that are known to recur, one for each; what slips from the one motion to
        the other, or goes to the same place, supports both alike and is left out, too.
        """
        if not len(motions):
            return np.zeros(0)
        weight = self.weight if weight is None else weight
        both = np.stack([motions, motions if beside is None else inverse(beside) @ motions], axis=1)

        def part(pair):
            i, k, _ = self.hits(pair[:, 0])
            good = in_long_stretches(i, k, self.curve, self.least)
            i, k = i[good], k[good]
            good = self._specific(pair[:, 0], i, k)
            if beside is not None:
                good &= self._specific(pair[:, 1], i, k) & (self._travel(pair[:, 1], i, k) > self.still**2)
            return np.bincount(i[good], weight[k[good]], minlength=len(pair))

        return np.concatenate(self._chunks(both, part, chunk))

    def held(self, motions):
        """(h,) float64, how much of what supports each motion resists a shift in the direction that is held least.

        A sample resists what goes across its curve. Two long parallel lines support any motion along them; a thing
        with curves in all directions supports one. The least eigenvalue of the sum of I - t t^T, edge lengths.
        """

        def part(m):
            i, k, j = self.hits(m)
            good = in_long_stretches(i, k, self.curve, self.least)
            i, k, j = i[good], k[good], j[good]
            line, w = self.all_tangents[j], self.weight[k]
            sums = np.zeros((len(m), 3, 3))
            for a in range(3):
                for b in range(a, 3):
                    term = np.bincount(i, w * ((a == b) - line[:, a] * line[:, b]), minlength=len(m))
                    sums[:, a, b] = sums[:, b, a] = term
            return np.linalg.eigvalsh(sums)[:, 0]

        return np.concatenate(self._chunks(motions, part, None)) if len(motions) else np.zeros(0)

    def supported(self, motions, *, specific=False):
        """(n,) bool, samples that any of the motions takes onto the network along a stretch.

        specific : leave out those that slip along their motion
        """

        def part(m):
            i, k, _ = self.hits(m)
            good = in_long_stretches(i, k, self.curve, self.least)
            if specific:
                i, k = i[good], k[good]
                good = self._specific(m, i, k)
            return np.unique(k[good])

        seen = np.zeros(len(self.points), bool)
        if len(motions):
            seen[np.concatenate(self._chunks(motions, part, None))] = True
        return seen

    def prominence(self, motions, *, off=(7.0, 4.0)):
        """(h,) float64, by how much a motion's support stands out from that of motions a little beside it.

        Straight parts support every motion that takes them along themselves. Only what is lost some edge lengths
        away, along the main directions of the curves and along the motion itself, tells for this one. Fine
        repetition may have its next step just there; therefore, where little is lost at the first distance, the
        second one is tried, and a direction counts by the better of the two.
        A turn may slide along its axis, as grooves do: there the turn without a slide is the simplest.
        """
        support = self.score(motions)
        worth = np.flatnonzero(support > 0)
        out = np.zeros(len(motions))
        if not len(worth):
            return out
        way = self._way_of_supported(motions[worth])
        left = self.score(self._beside(motions[worth], off[0], way).reshape(-1, 4, 4)).reshape(-1, 8)
        again = np.flatnonzero(left.max(axis=1) > 0.5 * support[worth])
        if len(again):
            nearer = self._beside(motions[worth[again]], off[1], way[again])
            left[again] = np.minimum(left[again], self.score(nearer.reshape(-1, 4, 4)).reshape(-1, 8))
        out[worth] = support[worth] - left.max(axis=1)
        return out

    def _way_of_supported(self, motions):
        """(h,) float64, RMS way of the samples that each motion is supported by."""

        def part(m):
            i, k, _ = self.hits(m)
            good = in_long_stretches(i, k, self.curve, self.least)
            i, k = i[good], k[good]
            good = self._specific(m, i, k)
            i, k = i[good], k[good]
            amount = np.bincount(i, minlength=len(m))
            return np.sqrt(np.bincount(i, self._travel(m, i, k), minlength=len(m)) / np.maximum(amount, 1))

        return np.concatenate(self._chunks(motions, part, None))

    def _beside(self, motions, off, size):
        """(h, 8, 4, 4), motions `off` edge lengths beside the given ones, which move their samples by `size` (h,)."""
        _, axes = np.linalg.eigh((self.tangents * self.weight[:, None]).T @ self.tangents)
        twists = np.concatenate(screw_velocity(motions), axis=1)
        angle = np.linalg.norm(twists[:, :3], axis=1)
        axis = twists[:, :3] / np.maximum(angle, 1e-12)[:, None] * (angle > np.radians(5))[:, None]
        way = axes.T[None] - (axes.T[None] @ axis[:, :, None]) * axis[:, None, :]
        length = np.linalg.norm(way, axis=2, keepdims=True)
        # A direction nearly along the axis has no way left of its own; the other two then stand for it.
        way = np.where(length > 0.5, way / np.maximum(length, 1e-12), np.roll(way, 1, axis=1))
        beside = np.repeat(motions[:, None], 8, axis=1)
        beside[:, 0:3, :3, 3] += off * way
        beside[:, 3:6, :3, 3] -= off * way
        for k, sign in ((6, 1), (7, -1)):
            beside[:, k] = exponential(twists * (1 + sign * off / np.maximum(size, off))[:, None])
        return beside

    def refine(self, motions, rounds=3, chunk=None):
        """Motions improved by ICP on the supported samples, to the nearest tangent line."""
        if not len(motions):
            return motions

        def part(m):
            m = m.copy()
            for _ in range(rounds):
                i, k, j = self.hits(m)
                good = in_long_stretches(i, k, self.curve, self.least)
                m = self.align(m, i[good], k[good], j[good])
            return m

        return np.concatenate(self._chunks(motions, part, chunk))

    def align(self, motions, i, k, j):
        """Best motions (h, 4, 4) for hits (row, sample, target); only the distance across the target curve counts."""
        a = np.take(self.points, k, axis=0)
        moved = np.einsum("nij,nj->ni", np.take(motions[:, :3, :3], i, axis=0), a)
        moved += np.take(motions[:, :3, 3], i, axis=0)
        target, line = np.take(self.all_points, j, axis=0), np.take(self.all_tangents, j, axis=0)
        b = target + line * np.einsum("ni,ni->n", moved - target, line)[:, None]
        w = np.take(self.weight, k)[:, None]
        wb = w * b
        cross = np.einsum("ni,nj->nij", wb, a).reshape(-1, 9)
        sums = _sums_of_rows(np.concatenate([w, w * a, wb, cross], axis=1), i, len(motions))
        total = np.maximum(sums[:, 0], 1e-9)[:, None]
        mean_a, mean_b = sums[:, 1:4] / total, sums[:, 4:7] / total
        cross = sums[:, 7:16].reshape(-1, 3, 3) / total[:, :, None] - mean_b[:, :, None] * mean_a[:, None, :]
        rotation, _ = best_rotation(cross + 1e-3 * motions[:, :3, :3])
        better = motion(rotation, mean_b - np.einsum("kij,kj->ki", rotation, mean_a))
        enough = sums[:, 0] >= 2 * self.least
        return np.where(enough[:, None, None], better, motions)
