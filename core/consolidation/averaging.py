# SPDX-License-Identifier: GPL-3.0-or-later
"""Middle lines of overlaid samples: points moved onto them, and lines moved onto the middle of the points."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import cKDTree

from ..geometry.polylines import resample_polyline, smooth_polyline


def condense(points, tangents, weight, *, radius, rounds=3, cosine=0.75, tick=None):
    """Points moved onto the middle line of those around them that run the same way.

    Returns (n, 3) points and (n, 3) tangents. Each round takes the weighted mean across the tangent within
    `radius`, which shrinks by a third a round, and the main direction of the neighbours' tangents.
    """
    points, tangents = points.copy(), tangents.copy()
    for _ in range(rounds):
        if tick:
            tick()
        i, j, w = _pairs(points, tangents, weight, radius, cosine)
        total = np.bincount(i, w, minlength=len(points))
        offset = points[j] - points[i]
        offset -= tangents[i] * (offset * tangents[i]).sum(1)[:, None]
        move = np.stack([np.bincount(i, w * offset[:, c], minlength=len(points)) for c in range(3)], 1)
        points = points + move / total[:, None]
        sign = np.sign((tangents[i] * tangents[j]).sum(1))
        line = np.stack([np.bincount(i, w * sign * tangents[j, c], minlength=len(points)) for c in range(3)], 1)
        tangents = line / np.maximum(np.linalg.norm(line, axis=1), 1e-12)[:, None]
        radius *= 2 / 3
    return points, tangents


def _pairs(points, tangents, weight, radius, cosine):
    """Neighbours (i, j) within radius and with like tangents, each point with itself, and their weights."""
    tree = cKDTree(points)
    pair = tree.query_pairs(radius, output_type="ndarray")
    own = np.arange(len(points))
    i, j = np.concatenate([pair[:, 0], pair[:, 1], own]), np.concatenate([pair[:, 1], pair[:, 0], own])
    good = np.abs((tangents[i] * tangents[j]).sum(1)) > cosine
    i, j = i[good], j[good]
    square = ((points[i] - points[j]) ** 2).sum(1)
    return i, j, weight[j] * np.exp(-0.5 * square / (radius / 2) ** 2)


def settle(lines, closed, points, tangents, weight, run, *, radius=1.5, smoothing=1.0, tick=None):
    """Lines moved onto the middle of the points along them, smooth and one edge length between their samples.

    run : (n,) int64, the same for points that follow each other on one input curve
    """
    out = []
    owned = own_points(lines, points, tangents, run, radius=radius + 0.5, tick=tick)
    for line, ring, own in zip(lines, closed, owned):
        if tick:
            tick()
        for _ in range(2):
            line = pull(line, points[own], tangents[own], weight[own], radius, ring)
        out.append(resample_polyline(smooth_polyline(line, smoothing, ring), 1.0, ring))
    return out


def own_points(lines, points, tangents, run, *, radius, cosine=0.75, most=0.8, tick=None):
    """For each line, the points (k,) int64 along it that belong to it.

    Where lines share a stretch, a point belongs to those that its run follows for the longest way.
    """
    if not lines:
        return []
    found, followed, best = [], [], np.zeros(len(points), np.int64)
    for line in lines:
        if tick:
            tick()
        way = np.gradient(line, axis=0)
        way /= np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]
        low, high = line.min(axis=0) - radius, line.max(axis=0) + radius
        near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        distance, at = cKDTree(line).query(points[near], distance_upper_bound=radius)
        hit = np.flatnonzero(np.isfinite(distance))
        near, at = near[hit], at[hit]
        near = near[np.abs((way[at] * tangents[near]).sum(1)) > cosine]
        _, name, count = np.unique(run[near], return_inverse=True, return_counts=True)
        found.append(near)
        followed.append(count[name])
        best[near] = np.maximum(best[near], followed[-1])
    return [near[count >= most * best[near]] for near, count in zip(found, followed)]


def pull(line, points, tangents, weight, radius, ring, *, spread=3.0):
    """A line moved onto the middle of the points along it.

    Each point gives its displacement from the line where it is nearest; displacements, not places, are averaged
    along the line, so that a bend is not flattened. `spread` is the standard deviation of that mean, in samples.
    """
    step = np.roll(line, -1, 0) - np.roll(line, 1, 0) if ring else np.gradient(line, axis=0)
    way = step / np.maximum(np.linalg.norm(step, axis=1), 1e-12)[:, None]
    distance, near = cKDTree(line).query(points, distance_upper_bound=radius + 0.5)
    found = np.flatnonzero(np.isfinite(distance))
    near = near[found]
    good = np.abs((way[near] * tangents[found]).sum(1)) > 0.75
    found, near = found[good], near[good]
    offset = points[found] - line[near]
    offset -= way[near] * (offset * way[near]).sum(1)[:, None]
    n = len(line)
    amount = np.bincount(near, weight[found], minlength=n)
    total = np.stack([np.bincount(near, weight[found] * offset[:, c], minlength=n) for c in range(3)], 1)
    mode = "wrap" if ring else "constant"
    amount = gaussian_filter1d(amount, spread, mode=mode)
    total = gaussian_filter1d(total, spread, axis=0, mode=mode)
    return line + total / np.maximum(amount, 1e-9)[:, None]
