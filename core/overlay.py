# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences laid over each other (section 5.2): samples taken back into one common cell, and what agrees there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .geometry.motions import inverse
from .geometry.rows import distinct_rows
from .network.network import CurveNetwork
from .orbits import Orbit
from .support import long_stretches


@dataclass(frozen=True)
class Overlay:
    """Samples of all occurrences in the frame of the first.

    points, tangents : (n, 3) float64; cell : (n,) int64, the occurrence each sample comes from
    sample : (n,) int64, index into the network's samples
    inner : (n,) bool, False for copies in a margin beyond the cell, there to give the samples inside neighbours
    run : (n,) int64, changes where a stretch of consecutive samples ends; samples are in order of cell and curve
    poses : (a, 4, 4) float64, common cell to network
    keys : (a, g) int64, the powers of the generators of each occurrence, or its number
    """

    points: np.ndarray
    tangents: np.ndarray
    cell: np.ndarray
    sample: np.ndarray
    inner: np.ndarray
    run: np.ndarray
    poses: np.ndarray
    keys: np.ndarray


def fold_orbit(network: CurveNetwork, orbit: Orbit, samples, weight, *, margin=10.0, share=None) -> Overlay:
    """Overlay of the cells of an orbit.

    Parameters
    ----------
    samples : (k,) int64, samples that take part, ascending
    weight : (k,) float64, how much each says about where the cells begin: the cut goes where least is cut
    margin : edge lengths around each cell that are copied with it, at most 0.3 of a cell
    share : share of a cell, at most 1, that is copied instead
    """
    points = network.points[samples]
    u, reach = cell_coordinates(orbit, points, margin)
    if share is not None:
        reach = np.full(u.shape, share)
    follows = (np.diff(samples) == 1) & (np.diff(network.curve_of[samples]) == 0)
    u = u - best_cut(u, weight, follows)
    low = np.floor(u).astype(np.int64)
    index, key, inner = [np.arange(len(u))], [low], [np.ones(len(u), bool)]
    fraction = u - low
    for axis in range(u.shape[1]):
        for side in (-1, 1):
            near = fraction[:, axis] < reach[:, axis] if side < 0 else fraction[:, axis] > 1 - reach[:, axis]
            for i, k in zip(list(index), list(key)):
                pick = near[i]
                shifted = k[pick].copy()
                shifted[:, axis] += side
                index.append(i[pick])
                key.append(shifted)
                inner.append(np.zeros(pick.sum(), bool))
    index, key, inner = np.concatenate(index), np.concatenate(key), np.concatenate(inner)
    if orbit.closed:
        key %= orbit.count[0] + 1
    whole = np.concatenate([index[:, None], key], axis=1)
    _, first, _ = distinct_rows(whole)
    index, key, inner = index[first], key[first], inner[first]
    keys, _, cell = distinct_rows(key)
    return _overlay(network, samples[index], cell, inner, orbit.power(keys), keys)


def fold_poses(network: CurveNetwork, poses, region, free, *, reach=6.0) -> Overlay:
    """Overlay of the free samples (n,) bool near a region (k, 3), placed by each of the poses.

    A sample near several places is taken to the nearest.
    """
    best = np.full(len(network.points), np.inf)
    cells = np.full(len(network.points), -1)
    for a, pose in enumerate(poses):
        placed = region @ pose[:3, :3].T + pose[:3, 3]
        distance = cKDTree(placed).query(network.points, distance_upper_bound=reach, workers=-1)[0]
        nearer = (distance < best) & free
        best[nearer], cells[nearer] = distance[nearer], a
    samples = np.flatnonzero(cells >= 0)
    inner = np.ones(len(samples), bool)
    return _overlay(network, samples, cells[samples], inner, poses, np.arange(len(poses))[:, None])


def _overlay(network, sample, cell, inner, poses, keys):
    order = np.lexsort((sample, cell))
    sample, cell, inner = sample[order], cell[order], inner[order]
    back = inverse(poses)[cell]
    points = np.einsum("nij,nj->ni", back[:, :3, :3], network.points[sample]) + back[:, :3, 3]
    tangents = np.einsum("nij,nj->ni", back[:, :3, :3], network.tangents[sample])
    new = np.ones(len(sample), bool)
    curve = network.curve_of[sample]
    new[1:] = (np.diff(cell) != 0) | (np.diff(sample) > 2) | (np.diff(curve) != 0)
    return Overlay(points, tangents, cell, sample, inner, np.cumsum(new), poses, keys)


def cell_coordinates(orbit: Orbit, points, margin):
    """Real powers (n, g) of the generators at which points lie, and the margin in the same unit.

    Translations: coefficients in the generators' basis, shear included. Rotations: angle about the axis over the
    step. Screws: the angle, with the turn that the way along the axis asks for.
    """
    if orbit.kind in ("translation", "grid") or not np.linalg.norm(orbit.twists[0, :3]) > 1e-9:
        g = orbit.twists[:, 3:]
        u = points @ np.linalg.pinv(g)
        return u, np.broadcast_to(np.minimum(margin / np.linalg.norm(g, axis=1), 0.3), u.shape)
    w, v = orbit.twists[0, :3], orbit.twists[0, 3:]
    step = np.linalg.norm(w)
    axis = w / step
    centre = np.cross(w, v) / step**2
    x = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    x /= np.linalg.norm(x)
    local = points - centre
    across, up = local @ x, local @ np.cross(axis, x)
    radius = np.hypot(across, up)
    angle = np.arctan2(up, across)
    pitch = (axis @ v) / step
    if orbit.kind == "screw" and abs(pitch) > 1e-9:
        # All that lies on one turn of the helix lags behind its height by about the same angle.
        lag = (local @ axis) / pitch - angle
        angle = angle + 2 * np.pi * np.floor((lag - _widest_gap(lag % (2 * np.pi))) / (2 * np.pi))
    elif not orbit.closed:
        angle = (angle - _widest_gap(angle)) % (2 * np.pi)
    u = (angle / step)[:, None]
    if orbit.closed:
        u %= orbit.count[0] + 1
    return u, np.minimum(margin / np.maximum(radius * step, 1e-9), 0.3)[:, None]


def _widest_gap(angle):
    """Middle of the widest gap between angles: where an arc's angles are cut open."""
    ordered = np.sort(angle)
    gap = np.diff(np.concatenate([ordered, ordered[:1] + 2 * np.pi]))
    k = int(np.argmax(gap))
    return ordered[k] + gap[k] / 2


def best_cut(u, weight, follows, bins=120):
    """Offsets (g,) of the cells that cut the fewest curves (grid origin, section 5.2).

    The paper bins the projected curves and takes the emptiest place. What counts is how often a cut at that place
    would cross a curve; a curve beside the cut and parallel to it is whole, though it fills the bin.

    u : (n, g) float64, powers of the generators; follows : (n - 1,) bool, whether sample i + 1 continues sample i
    """
    cut = np.zeros(u.shape[1])
    first = np.flatnonzero(follows)
    for axis in range(u.shape[1]):
        a, b = u[first, axis], u[first + 1, axis]
        low = np.ceil(np.minimum(a, b) * bins).astype(np.int64)
        high = np.floor(np.maximum(a, b) * bins).astype(np.int64)
        use = (high >= low) & (high - low < bins)
        amount = np.bincount(low[use] % bins, weight[first][use], minlength=bins)
        amount -= np.bincount((high[use] + 1) % bins, weight[first][use], minlength=bins)
        wrapped = (high[use] + 1) // bins > low[use] // bins
        crossings = np.cumsum(amount) + weight[first][use][wrapped].sum()
        near = np.bincount(np.round(u[:, axis] * bins).astype(np.int64) % bins, weight, minlength=bins)
        k = np.arange(-3, 4)
        # Crossings first; of equal places the one with the most room around.
        cost = sum(np.roll(crossings, j) for j in k) / len(k) + 0.1 * sum(np.roll(near, j) for j in k) / len(k)
        low = cost <= cost.min() + 0.02 * (np.median(cost) - cost.min()) + 1e-9
        places = [(begin + end - 1) / 2 % bins / bins for begin, end in _longest_runs(low)]
        # Of places that are about equally empty the one that leaves fewest cells half empty: ab ab ab, not a ba ba b.
        cut[axis] = max(places, key=lambda at: _fullness(u[:, axis] - at, weight))
    return cut


def _fullness(u, weight):
    """How much the weight is in few cells: the sum of squares of what each cell has."""
    cell = np.floor(u).astype(np.int64)
    return round(float((np.bincount(cell - cell.min(), weight) ** 2).sum() / max(weight.sum(), 1e-9) ** 2), 3)


def _longest_runs(low, share=0.6):
    """Runs (begin, end) of True in a ring of flags, those of at least a share of the longest, longest first."""
    turn = int(np.argmin(low)) if not low.all() else 0
    ring = np.concatenate([[False], np.roll(low, -turn), [False]])
    begin, end = np.flatnonzero(~ring[:-1] & ring[1:]), np.flatnonzero(ring[:-1] & ~ring[1:])
    order = [k for k in np.argsort(begin - end, kind="stable") if end[k] - begin[k] >= share * (end - begin).max()]
    return [(int(begin[k]) + turn, int(end[k]) + turn) for k in order]


def agreement(overlay: Overlay, *, radius, cosine=0.8, stretch=8, shifts=None, progress=None):
    """How many other occurrences show what a sample shows, and where on average.

    Parameters
    ----------
    radius : edge lengths; cosine : least cosine of the tangents; stretch : shortest run of agreeing samples
    shifts : (a, 3) displacements of the occurrences against each other, to learn what chance gives

    Returns
    -------
    count : (n,) int64, other occurrences that agree along a stretch
    mean : (n, 3) float64, the sample's place averaged with theirs, across the curve
    """
    n, cells = len(overlay.points), len(overlay.poses)
    points = overlay.points if shifts is None else overlay.points + shifts[overlay.cell]
    count, mean, total = np.zeros(n, np.int64), points.copy(), np.ones(n)
    for b in range(cells):
        other = np.flatnonzero(overlay.cell == b)
        rest = np.flatnonzero(overlay.cell != b)
        if not len(other) or not len(rest):
            continue
        tree = cKDTree(points[other])
        distance, near = tree.query(
            points[rest], k=2, distance_upper_bound=radius, workers=-1 if len(rest) > 20_000 else 1
        )
        hit, foot = np.zeros(n, bool), np.zeros((n, 3))
        for k in (1, 0):
            found = np.isfinite(distance[:, k])
            i, j = rest[found], other[near[found, k]]
            line = overlay.tangents[j]
            good = np.abs((overlay.tangents[i] * line).sum(1)) > cosine
            i, j, line = i[good], j[good], line[good]
            hit[i] = True
            foot[i] = points[j] + line * ((points[i] - points[j]) * line).sum(1)[:, None]
        hit = long_stretches(hit[None], overlay.run, stretch)[0]
        count += hit
        # The nearer, the more it counts: a curve beside this one must not draw it over.
        w = np.exp(-0.5 * ((foot[hit] - points[hit]) ** 2).sum(1) / (radius / 2) ** 2)
        mean[hit] += w[:, None] * foot[hit]
        total[hit] += w
        if progress:
            progress((b + 1) / cells)
    return count, mean / total[:, None]


def chance_shifts(overlay: Overlay, seed=0):
    """Displacements (a, 3) of 7 to 13 edge lengths, in the directions in which the cell extends."""
    rng = np.random.default_rng(seed)
    centre = overlay.points - overlay.points.mean(axis=0)
    values, axes = np.linalg.eigh(centre.T @ centre / len(centre))
    way = (rng.normal(size=(len(overlay.poses), 3)) * np.sqrt(np.maximum(values, 0))) @ axes.T
    way /= np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]
    return way * rng.uniform(7, 13, size=(len(way), 1))
