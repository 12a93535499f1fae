# SPDX-License-Identifier: GPL-3.0-or-later
"""Which windows of the strong curves agree (Algorithm 1, lines 1 to 4), asked of all pairs at once.

Algorithm 1 asks of every pair of points on two curves whether stretches of length l0 that start there agree
under the best rotation about the start. All those cross-covariances are nine matrix products of windows with
windows, and whether the residual is below s is the sign of a quartic and its derivatives (see `agree`), so no
loop runs over pairs.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

TILE_ROWS, TILE_COLUMNS = 128, 512
"""Shape of every matrix product: fixed, so that the result does not depend on how much is done at a time."""


class Tracks:
    """Windows of `size` samples of the strong curves, in both directions.

    Window w starts at sample `start[w]` of curve `curves[curve[w]]`. In direction -1 the windows are stored in
    reverse order, so that in either direction the next row goes with the next column.
    """

    def __init__(self, network, strong, size):
        counts = np.diff(network.offsets)
        strong = np.asarray(strong, np.int64)
        self.size, self.points = size, network.points
        self.curves = strong = strong[counts[strong] >= size]
        self.counts, self.closed, self.first = counts[strong], network.closed[strong], network.offsets[:-1][strong]
        self.windows = np.where(self.closed, self.counts, self.counts - size + 1)
        self.curve = np.repeat(np.arange(len(strong)), self.windows)
        self.offsets = np.concatenate([[0], np.cumsum(self.windows)])
        self.start = np.arange(self.offsets[-1]) - np.repeat(self.offsets[:-1], self.windows)

        self._unroll()

    def _unroll(self):
        """Curves one after the other, closed ones three times round, with running sums of p and |p|^2."""
        copies = np.where(self.closed, 3, 1) * self.counts
        begin = np.concatenate([[0], np.cumsum(copies)])
        curve = np.repeat(np.arange(len(copies)), copies)
        at = np.arange(begin[-1]) - begin[curve]
        self.unrolled = self.points[self.samples(curve, at)]
        self.base = begin[:-1] + np.where(self.closed, self.counts, 0)
        terms = np.concatenate([self.unrolled, (self.unrolled**2).sum(axis=1)[:, None]], axis=1)
        self.running = np.concatenate([np.zeros((1, 4)), np.cumsum(terms, axis=0)])

    def samples(self, curve, at):
        """Indices into the network's samples of sample `at` of strong curve `curve`; closed curves wrap around."""
        return self.first[curve] + self.wrap(curve, at)

    def wrap(self, curve, at):
        """Sample numbers brought back onto closed curves."""
        return np.where(self.closed[curve], at % self.counts[curve], at)

    def window_points(self, direction):
        """(w, 3, size) float32, samples relative to the one where the stretch starts; w in stored order."""
        k = np.arange(self.size) if direction > 0 else np.arange(self.size)[::-1]
        order = slice(None, None, direction)
        p = self.points[self.samples(self.curve[order][:, None], self.start[order][:, None] + k)]
        return (p - p[:, :1]).transpose(0, 2, 1).astype(np.float32)

    def point_pairs(self):
        """Pairs of windows of two different curves, counted once a direction."""
        n = self.windows.astype(float)
        return int(n.sum() ** 2 - (n**2).sum())


class Workspace:
    """Arrays that `agree` works in, one set a thread: 9 products and a few tiles."""

    def __init__(self):
        self.products = np.empty((9, TILE_ROWS, TILE_COLUMNS), np.float32)
        self.tiles = [np.empty((TILE_ROWS, TILE_COLUMNS), np.float32) for _ in range(6)]


def agree(a, b, ga, gb, na, nb, size, s, work):
    """Which windows of a agree with which of b: best-rotation RMS residual about the start below s.

    The residual is (ga + gb - 2 x) / size with x the largest root of a quartic with real roots only (see
    `motions.largest_overlap`). It is below s^2 exactly when x exceeds x0 = (ga + gb - size s^2) / 2, i.e. unless
    the quartic and all its derivatives are positive at x0. In units of x0 the quartic is
    1 - 2 e1 - 8 det + e1^2 - 4 e2. Before that, |R a - b| >= ||a| - |b|| bounds the residual from below.
    """
    x0, scale, tmp, other, e2, det = work.tiles
    np.add(ga[:, None], gb[None, :] - np.float32(size * s * s), out=x0)
    x0 *= np.float32(0.5)
    np.matmul(na, nb.T, out=tmp)
    agree = tmp >= x0
    if not agree.any():
        return agree
    np.maximum(x0, np.float32(1e-6), out=scale)
    np.divide(np.float32(1), scale, out=scale)
    m = work.products
    for i in range(3):
        for j in range(3):
            np.matmul(a[i], b[j].T, out=m[3 * i + j])
    m *= scale
    e2.fill(0)
    for row, (p, q, u, v) in enumerate(_COFACTORS):
        np.multiply(m[p], m[q], out=tmp)
        np.multiply(m[u], m[v], out=other)
        tmp -= other
        if row < 3:
            np.multiply(tmp, m[row], out=other)
            if row:
                det += other
            else:
                det[:] = other
        tmp *= tmp
        e2 += tmp
    m *= m
    e1 = np.sum(m, axis=0, out=tmp)
    det *= 8
    np.multiply(e1, e1, out=other)
    other -= e1
    other -= e1
    other -= det
    e2 *= 4
    other -= e2
    below = other < -1
    e1 *= 4
    det += e1
    below |= det > 4
    below |= e1 > 12
    below |= x0 <= 0
    agree &= below
    return agree


_COFACTORS = (
    (4, 8, 5, 7), (5, 6, 3, 8), (3, 7, 4, 6), (7, 2, 8, 1), (8, 0, 6, 2),
    (6, 1, 7, 0), (1, 5, 2, 4), (2, 3, 0, 5), (0, 4, 1, 3),
)  # fmt: skip
"""Each cofactor of a 3 x 3 matrix as m[p] m[q] - m[u] m[v], row by row."""


class Side:
    """What `agree` needs of the windows in one direction, padded to whole tiles."""

    def __init__(self, tracks, direction, multiple):
        n = len(tracks.start)
        pad = -n % multiple
        order = slice(None, None, direction)
        offset = np.concatenate([tracks.window_points(direction), np.zeros((pad, 3, tracks.size), np.float32)])
        self.offset = np.ascontiguousarray(offset.transpose(1, 0, 2))
        self.norm = np.sqrt((self.offset**2).sum(axis=0))
        self.energy = (self.norm**2).sum(axis=1)
        self.curve = np.concatenate([tracks.curve[order], np.full(pad, -1)])
        self.fresh = np.concatenate([self.curve[:1] == self.curve[:1], np.diff(self.curve) != 0])

    def tile(self, start, count):
        part = slice(start, start + count)
        return self.offset[:, part], self.energy[part], self.norm[part]


def agreeing_windows(tracks, s, block, threads, progress):
    """Runs of agreeing windows on diagonals, the best few of every pair of curves and direction.

    Returns an int64 array (k, 4): direction, first row window, first column window (in stored order), run
    length. A run is cut at the edge of a tile; the extension joins it again.
    """
    rows = Side(tracks, 1, TILE_ROWS)
    columns = {d: Side(tracks, d, TILE_COLUMNS) for d in (1, -1)}
    n = len(tracks.start)
    group = max(1, block // (TILE_ROWS * TILE_COLUMNS))
    found, done, jobs = [], 0, []
    for r in range(0, n, TILE_ROWS):
        low = tracks.offsets[tracks.curve[r]]
        for d in (1, -1):
            first, last = (low, n) if d > 0 else (0, n - low)
            jobs += [(r, d, c) for c in range(first // TILE_COLUMNS * TILE_COLUMNS, last, TILE_COLUMNS)]

    def work(batch):
        space = Workspace()
        return [_tile_runs(tracks, rows, columns[d], s, r, d, c, space) for r, d, c in batch]

    total = len(jobs)
    batches = [jobs[i : i + group] for i in range(0, total, group)]
    with ThreadPoolExecutor(max(1, threads)) as pool:
        held = 0
        for wave in range(0, len(batches), 4 * max(1, threads)):
            for parts in pool.map(work, batches[wave : wave + 4 * max(1, threads)]):
                found += parts
                held += sum(map(len, parts))
                done += len(parts)
                if progress:
                    progress("blast", 0.8 * done / total)
            if held > 4_000_000:
                found = [_thin(tracks, np.concatenate(found))]
                held = len(found[0])
    return _thin(tracks, np.concatenate(found)) if found else np.zeros((0, 4), np.int64)


def _tile_runs(tracks, rows, columns, s, r, d, c, work):
    """Runs in one tile as rows (direction, first row window, first column window, length)."""
    a, ga, na = rows.tile(r, TILE_ROWS)
    b, gb, nb = columns.tile(c, TILE_COLUMNS)
    match = agree(a, b, ga, gb, na, nb, tracks.size, s, work)
    i, j = rows.curve[r : r + TILE_ROWS], columns.curve[c : c + TILE_COLUMNS]
    match &= j[None, :] >= i[:, None]
    match &= i[:, None] >= 0
    # A curve matches itself where it lies, which is no recurrence; T and its inverse are one fact.
    own = j[None, :] == i[:, None]
    if own.any():
        row = r + np.arange(TILE_ROWS)[:, None]
        column = c + np.arange(TILE_COLUMNS)[None, :]
        ahead = column > row if d > 0 else len(tracks.start) - 1 - column >= row
        match &= ~own | ahead
    if not match.any():
        return np.zeros((0, 4), np.int64)
    # Shear the tile so that diagonals stand upright: row k of `diagonal` is row k of the tile from column k on.
    wide = np.zeros((TILE_ROWS + 1, TILE_COLUMNS + 2 * TILE_ROWS), bool)
    wide[:TILE_ROWS, TILE_ROWS : TILE_ROWS + TILE_COLUMNS] = match
    width = TILE_COLUMNS + TILE_ROWS
    shear = (wide.strides[0] + 1, 1)
    diagonal = np.lib.stride_tricks.as_strided(wide, (TILE_ROWS, width), shear, writeable=False)
    fresh = np.zeros((TILE_ROWS + 1, TILE_COLUMNS + 2 * TILE_ROWS), bool)
    fresh[:TILE_ROWS, TILE_ROWS : TILE_ROWS + TILE_COLUMNS] = (
        rows.fresh[r : r + TILE_ROWS, None] | columns.fresh[None, c : c + TILE_COLUMNS]
    )
    cut = np.lib.stride_tricks.as_strided(fresh, (TILE_ROWS, width), shear, writeable=False)
    begins = diagonal.copy()
    begins[1:] &= cut[1:] | ~diagonal[:-1]
    ends = diagonal.copy()
    ends[:-1] &= cut[1:] | ~diagonal[1:]
    # Read down each diagonal: the k-th beginning and the k-th end belong to one run.
    column, first = np.nonzero(begins.T)
    _, last = np.nonzero(ends.T)
    return np.stack(
        [np.full(len(first), d), r + first, c + column + first - TILE_ROWS, last - first + 1], axis=1
    ).astype(np.int64)


def _thin(tracks, runs):
    """The best runs of every pair of curves and direction: longest first, three diagonals apart."""
    if not len(runs):
        return runs
    d, i, j, length = runs.T
    window = np.where(d > 0, j, len(tracks.start) - 1 - j)
    a, b = tracks.curve[i], tracks.curve[window]
    pair = (a * len(tracks.curves) + b) * 2 + (d > 0)
    strip = (j - i) // 3
    order = np.lexsort((i, j - i, -length, strip, pair))
    lead = np.ones(len(order), bool)
    p, q = pair[order], strip[order]
    lead[1:] = (p[1:] != p[:-1]) | (q[1:] != q[:-1])
    best = order[lead]
    order = best[np.lexsort((i[best], (j - i)[best], -length[best], pair[best]))]
    p = pair[order]
    begin = np.concatenate([[True], p[1:] != p[:-1]])
    rank = np.arange(len(p)) - np.maximum.accumulate(np.where(begin, np.arange(len(p)), 0))
    # In a small network every pair counts; in a large one other pairs tell the same.
    every = min(max(len(tracks.curves) // 2, 8), 32)
    most = 1 + (tracks.counts[a[order]] + tracks.counts[b[order]]) // every
    return runs[order[rank < most]]
