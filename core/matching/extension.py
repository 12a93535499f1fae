# SPDX-License-Identifier: GPL-3.0-or-later
"""Stretches of two curves under their best common motion, extended sample by sample (Algorithm 1, lines 5 to 7)."""

from __future__ import annotations

import numpy as np

from ..geometry.motions import largest_overlap, motion, proper, rotation_between


class Stretches:
    """Running sums over pairs of stretches, from which motion and residual follow at once.

    Sample k of pair p is sample ``start_a[p] + k`` of strong curve ``a[p]`` and sample
    ``start_b[p] + direction[p] k`` of ``b[p]``; both are counted on the curve and may pass the seam of a closed one.
    """

    def __init__(self, tracks, a, b, start_a, start_b, direction, count):
        self.tracks, self.a, self.b, self.direction = tracks, a, b, direction
        self.start_a, self.start_b, self.count = start_a.copy(), start_b.copy(), count.copy()
        k = len(a)
        self.sum_a, self.sum_b, self.sum_ba = np.zeros((k, 3)), np.zeros((k, 3)), np.zeros((k, 3, 3))
        self.square_a, self.square_b = np.zeros(k), np.zeros(k)
        self.restart(np.arange(k), self.start_a, self.start_b, self.count)

    def restart(self, which, start_a, start_b, count):
        """Put the stretches `which` at other places."""
        self.start_a[which], self.start_b[which], self.count[which] = start_a, start_b, count
        order = which[np.argsort(self.count[which], kind="stable")]
        # Parts that fit the processor's cache, stretches of like length together.
        for part in np.array_split(order, max(1, int(self.count[which].sum() // 50_000))):
            if len(part):
                sums = self._sums(part, np.zeros(len(part), np.int64), self.count[part])
                for total, new in zip((self.sum_a, self.sum_b, self.sum_ba, self.square_a, self.square_b), sums):
                    total[part] = new

    def _sums(self, which, first, many):
        """Sums over samples first .. first + many - 1 of the pairs `which`; first may be negative."""
        t, d = self.tracks, self.direction[which]
        from_a = t.base[self.a[which]] + self.start_a[which] + first
        from_b = t.base[self.b[which]] + self.start_b[which] + d * first
        low_b = np.where(d > 0, from_b, from_b - many + 1)
        sums_a = t.running[from_a + many] - t.running[from_a]
        sums_b = t.running[low_b + many] - t.running[low_b]
        k = np.arange(max(1, int(many.max(initial=0))))
        inside = k < many[:, None]
        pa = np.take(t.unrolled, from_a[:, None] + k, axis=0, mode="clip")
        pa *= inside[:, :, None]
        pb = np.take(t.unrolled, from_b[:, None] + d[:, None] * k, axis=0, mode="clip")
        # Not a matrix product: that adds up in an order that depends on how long the longest of these is.
        return sums_a[:, :3], sums_b[:, :3], np.einsum("kni,knj->kij", pb, pa), sums_a[:, 3], sums_b[:, 3]

    def _residual(self, n, sum_a, sum_b, sum_ba, square_a, square_b):
        """RMS distance under the best motion of sums over n samples."""
        cross = sum_ba - sum_b[:, :, None] * sum_a[:, None, :] / n[:, None, None]
        energy = square_a - (sum_a**2).sum(1) / n + square_b - (sum_b**2).sum(1) / n
        return np.sqrt(np.maximum(energy - 2 * largest_overlap(cross, energy / 2), 0) / n)

    def distance(self, which=slice(None)):
        """(k,) float64, RMS distance of the stretches under their best motions."""
        n = self.count[which].astype(float)
        sums = (self.sum_a, self.sum_b, self.sum_ba, self.square_a, self.square_b)
        return self._residual(n, *(s[which] for s in sums))

    def room(self, which, ahead):
        """Samples left before (ahead < 0) or behind the stretches on both curves."""
        t, a, b = self.tracks, self.a[which], self.b[which]
        count, sa, sb, d = self.count[which], self.start_a[which], self.start_b[which], self.direction[which]
        if ahead > 0:
            left_a = t.counts[a] - sa - count
            left_b = np.where(d > 0, t.counts[b] - sb - count, sb - count + 1)
        else:
            left_a = sa
            left_b = np.where(d > 0, sb, t.counts[b] - 1 - sb)
        left_a = np.where(t.closed[a], t.counts[a] - count, left_a)
        left_b = np.where(t.closed[b], t.counts[b] - count, left_b)
        return np.maximum(np.minimum(left_a, left_b), 0)

    def grow(self, active, step, t):
        """Try `step` more samples behind and before each active stretch; returns those that grew."""
        grew = np.zeros(len(active), bool)
        for ahead in (1, -1):
            many = np.minimum(self.room(active, ahead), step)
            some = many > 0
            which, many = active[some], many[some]
            if not len(which):
                continue
            first = self.count[which] if ahead > 0 else -many
            sums = (self.sum_a, self.sum_b, self.sum_ba, self.square_a, self.square_b)
            longer = [total[which] + part for total, part in zip(sums, self._sums(which, first, many))]
            fits = self._residual((self.count[which] + many).astype(float), *longer) < t
            which, many = which[fits], many[fits]
            for total, part in zip(sums, longer):
                total[which] = part[fits]
            self.count[which] += many
            if ahead < 0:
                self.start_a[which] -= many
                self.start_b[which] -= self.direction[which] * many
            grew[np.flatnonzero(some)[fits]] = True
        return active[grew]

    def motions(self, which):
        """Best motions (k, 4, 4) that take a onto b, and how well each stretch fixes the rotation (k,), 0 to 1.

        A straight stretch fixes neither the roll about itself; there the smallest rotation is taken.
        """
        n = self.count[which].astype(float)
        mean_a, mean_b = self.sum_a[which] / n[:, None], self.sum_b[which] / n[:, None]
        cross = self.sum_ba[which] / n[:, None, None] - mean_b[:, :, None] * mean_a[:, None, :]
        u, sigma, vt = np.linalg.svd(cross)
        rotation = proper(u, vt)
        width = np.maximum(sigma[:, 1], 0)
        straight = width < 1.0
        rotation[straight] = rotation_between(vt[straight, 0, :], u[straight, :, 0])
        translation = mean_b - np.einsum("kij,kj->ki", rotation, mean_a)
        return motion(rotation, translation), width / (width + 4.0)
