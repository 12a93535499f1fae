# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons of a mesh as triangles: concave ones too, those with holes on a bridge, and every corner is used."""

from __future__ import annotations

import numpy as np

from ..errors import InputError

FLAT = 1e-9
"""Twice the area of a triangle that is none, as a share of the square of its polygon's extent."""

LONGEST_FAN = 8
"""Corners of a polygon that a fan may have: about one corner of many the triangles are slivers."""

MOST_CORNERS = 20_000
"""Corners of a polygon; the time grows with their square, to a minute for these."""


def triangles_of_polygons(points, index, offsets) -> np.ndarray:
    """(m, 3) int64, the triangles of polygons in 3D, in their order.

    A small polygon is cut into a fan about its first corner where that is right, any other ear by ear and then made
    Delaunay. Those with fewer than three corners have none. Corners on a straight side are kept, as the polygon beside
    has them.

    Parameters
    ----------
    points : (n, 3) float64
    index : (k,) int64, corners of all polygons; polygon i is ``index[offsets[i]:offsets[i + 1]]``
    offsets : (p + 1,) int64

    Raises InputError for a polygon of more than `MOST_CORNERS` corners.

    Notes
    -----
    O(k) for fans; O(c^2) for a polygon of c corners that needs ears.
    """
    if (np.diff(offsets) == 3).all():
        return index.reshape(-1, 3)
    fan, of = _fans(index, offsets)
    large = np.diff(offsets) > 3
    bad = np.zeros(len(large), bool)
    if large.any():
        corners = index[np.repeat(large, np.diff(offsets))]
        begin = np.r_[0, np.cumsum(np.diff(offsets)[large])]
        normal = np.zeros((len(large), 3))
        normal[large] = _normals(points, corners, begin)
        bad[large] = _bad_fans(points, fan[large[of]], np.cumsum(large)[of[large[of]]] - 1, normal[large])
        bad |= np.diff(offsets) > LONGEST_FAN
    if not bad.any():
        return fan
    if np.diff(offsets).max() > MOST_CORNERS:
        raise InputError(f"a polygon of {np.diff(offsets).max()} corners; triangulate the mesh and export it again")
    parts, whose = [fan[~bad[of]]], [of[~bad[of]]]
    for i in np.flatnonzero(bad):
        corners = index[offsets[i] : offsets[i + 1]]
        flat = _flat(points[corners], normal[i])
        ears = corners[_delaunay(flat, _ears(flat))]
        parts.append(ears)
        whose.append(np.full(len(ears), i))
    return np.concatenate(parts)[np.argsort(np.concatenate(whose), kind="stable")]


def _fans(index, offsets):
    """Triangles about the first corner of each polygon, and the polygon of each."""
    count = np.maximum(np.diff(offsets) - 2, 0)
    first = np.repeat(offsets[:-1], count)
    step = np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count) + 1
    fan = np.stack([index[first], index[first + step], index[first + step + 1]], axis=1)
    return fan, np.repeat(np.arange(len(count)), count)


def _bad_fans(points, fan, of, normal) -> np.ndarray:
    """(p,) bool, the polygons in whose fan a triangle has no area or faces away from the normal."""
    a, b, c = (points[fan[:, i]] for i in range(3))
    area = (np.cross(b - a, c - a) * normal[of]).sum(axis=1)
    extent = np.zeros(len(normal))
    np.maximum.at(extent, of, np.maximum(((b - a) ** 2).sum(axis=1), ((c - a) ** 2).sum(axis=1)))
    bad = np.zeros(len(normal), bool)
    bad[of[area <= FLAT * extent[of]]] = True
    return bad


def _normals(points, index, offsets) -> np.ndarray:
    """(p, 3) float64, unit, by the area of the whole polygon (Newell); zero where it has none."""
    count = np.diff(offsets)
    of = np.repeat(np.arange(len(count)), count)
    after = np.arange(len(index)) + 1
    after[offsets[1:][count > 0] - 1] = offsets[:-1][count > 0]
    origin = points[index[offsets[:-1][count > 0]]]
    begin = np.zeros((len(count), 3))
    begin[count > 0] = origin
    a, b = points[index] - begin[of], points[index[after]] - begin[of]
    cross = np.cross(a, b)
    normal = np.stack([np.bincount(of, cross[:, k], len(count)) for k in range(3)], axis=1).astype(np.float64)
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)


def _flat(points, normal) -> np.ndarray:
    """(c, 2) float64, a polygon in its plane, counter-clockwise about its normal and about 1 large."""
    points = points - points[0]
    points /= np.abs(points).max() or 1.0
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    right = np.cross(axis, normal)
    size = np.linalg.norm(right)
    right = right / size if size > 0 else np.array([1.0, 0, 0])
    return np.stack([points @ right, points @ np.cross(normal, right)], axis=1)


def _ears(points) -> np.ndarray:
    """(c - 2, 3) int64, triangles of a polygon (c, 2), counter-clockwise: always the ear of the widest least angle.

    A polygon that crosses itself has not always an ear; then the best corner goes, so that this ends.
    """
    ring = np.arange(len(points))
    quality = np.array([_quality(points, ring, i) for i in range(len(ring))])
    out = []
    while len(ring) > 3:
        if quality.max() <= 0:  # what was blocked may be free now; what was free stays so
            for j in np.flatnonzero(quality > -1):
                quality[j] = _quality(points, ring, j)
        i = int(np.argmax(quality))
        out.append((ring[i - 1], ring[i], ring[(i + 1) % len(ring)]))
        ring, quality = np.delete(ring, i), np.delete(quality, i)
        for j in ((i - 1) % len(ring), i % len(ring)):
            quality[j] = _quality(points, ring, j)
    out.append(tuple(ring))
    return np.array(out, np.int64)


def _quality(points, ring, i) -> float:
    """Sine of the least angle of the ear at place i of the ring; from 0 down for one that is blocked, -1 for none."""
    a, b, c = points[ring[i - 1]], points[ring[i]], points[ring[(i + 1) % len(ring)]]
    area = _cross(b - a, c - a)
    if area <= FLAT:
        return -1.0 - abs(area)
    sides = np.linalg.norm([b - a, c - b, a - c], axis=1)
    least = area * sides.min() / sides.prod()  # area / (product of the two longer sides)
    others = points[ring]
    inside = (_cross(b - a, others - a) >= 0) & (_cross(c - b, others - b) >= 0) & (_cross(a - c, others - c) >= -FLAT)
    if inside.sum() > 3:
        for corner in (a, b, c):
            inside &= (others != corner).any(axis=1)
        if inside.any():
            return -1.0 + 0.5 * least
    return float(least)


def _delaunay(points, triangles) -> np.ndarray:
    """The triangles of a polygon (c, 2) with inner edges flipped until no circle of one holds a corner beside it."""
    triangles = [list(t) for t in triangles.tolist()]
    count = len(points)
    for _ in range(count):
        beside, flipped = {}, set()
        for t, corners in enumerate(triangles):
            for k in range(3):
                beside.setdefault(frozenset((corners[k], corners[k - 2])), []).append((t, corners[k - 1]))
        for edge, sides in beside.items():
            if len(sides) != 2 or len(edge) != 2:
                continue
            (one, c), (other, d) = sides
            first, second = edge
            if one in flipped or other in flipped or not _is_bad(points, first, second, c, d):
                continue
            a, b = triangles[one][triangles[one].index(c) - 2], triangles[one][triangles[one].index(c) - 1]
            new = [c, a, d], [d, b, c]
            if all(_cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]) > FLAT for t in new):
                triangles[one], triangles[other] = new
                flipped |= {one, other}
        if not flipped:
            break
    return np.array(triangles, np.int64)


def _is_bad(points, a, b, c, d) -> bool:
    """Whether the angles over the edge a, b at c and at d are over half a turn together."""
    angles = 0.0
    for tip in (c, d):
        u, v = points[a] - points[tip], points[b] - points[tip]
        angles += np.arctan2(abs(_cross(u, v)), u @ v)
    return angles > np.pi + 1e-6


def _cross(u, v):
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
