# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow and plain versions of what `core` does at once; they share no code with it and loop over everything."""

from __future__ import annotations

from collections import namedtuple

import numpy as np

# ---- motions


def turn(axis, angle):
    """(3, 3) rotation about an axis through the origin by `angle` radians (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


def rigid(rotation=None, shift=(0, 0, 0)):
    """(4, 4) motion."""
    m = np.eye(4)
    m[:3, :3], m[:3, 3] = np.eye(3) if rotation is None else rotation, shift
    return m


def about(axis, angle, centre, along=0.0):
    """(4, 4) turn about the axis through `centre`, and a step along it."""
    r, centre = turn(axis, angle), np.asarray(centre, float)
    return rigid(r, centre - r @ centre + along * np.asarray(axis, float) / np.linalg.norm(axis))


def moved(m, points):
    """(n, 3) points moved by one motion, point by point."""
    return np.array([m[:3, :3] @ p + m[:3, 3] for p in points])


def angle_of(rotation):
    """Angle of a rotation in degrees, exact also near zero."""
    sine = np.linalg.norm([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                           rotation[1, 0] - rotation[0, 1]]) / 2  # fmt: skip
    return np.degrees(np.arctan2(sine, (np.trace(rotation) - 1) / 2))


def fit_rotation(a, b):
    """(3, 3) rotation that takes the rows of a nearest to those of b about the origin (Kabsch)."""
    u, _, vt = np.linalg.svd(a.T @ b)
    mirror = np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt)) or 1.0])
    return (u @ mirror @ vt).T


def fit_motion(a, b):
    """(4, 4) motion that takes the rows of a nearest to those of b."""
    middle_a, middle_b = a.mean(axis=0), b.mean(axis=0)
    r = fit_rotation(a - middle_a, b - middle_b)
    return rigid(r, middle_b - r @ middle_a)


def log_motion(m):
    """Rotation vector w and velocity u whose screw motion leads to one motion in unit time."""
    w = np.zeros(3)
    angle = np.radians(angle_of(m[:3, :3]))
    if angle < 1e-12:
        return w, m[:3, 3]
    values, vectors = np.linalg.eig(m[:3, :3])
    axis = np.real(vectors[:, np.argmin(np.abs(values - 1))])
    if np.linalg.norm(turn(axis, angle) - m[:3, :3]) > np.linalg.norm(turn(-axis, angle) - m[:3, :3]):
        axis = -axis
    w = axis * angle
    # t is the integral of exp(s w) u over s in 0..1, here by a fine midpoint sum.
    steps = 2000
    v = sum(turn(axis, angle * (k + 0.5) / steps) for k in range(steps)) / steps
    return w, np.linalg.solve(v, m[:3, 3])


# ---- curves


def length(points, closed=False):
    """Length of a polyline."""
    total = 0.0
    for p, q in zip(points[:-1], points[1:]):
        total += float(np.linalg.norm(q - p))
    return total + (float(np.linalg.norm(points[0] - points[-1])) if closed else 0.0)


def resample(points, step, closed=False):
    """Points evenly along a polyline, about `step` apart; a closed one does not repeat its first point."""
    corners = [*points, points[0]] if closed else list(points)
    total = length(corners)
    pieces = max(int(np.rint(total / step)), 4 if closed else 1)
    out = []
    for k in range(pieces + (0 if closed else 1)):
        left = total * k / pieces
        for p, q in zip(corners[:-1], corners[1:]):
            size = float(np.linalg.norm(q - p))
            if size > 0 and left <= size * (1 + 1e-12):
                out.append(p + (q - p) * min(1.0, left / size))
                break
            left -= size
        else:
            out.append(corners[-1])
    return np.array(out)


def directions(curve):
    """(k, 3) unit tangents of a polyline, from the point before to the one behind; at the ends from the end itself."""
    out = []
    for k in range(len(curve)):
        way = curve[min(k + 1, len(curve) - 1)] - curve[max(k - 1, 0)]
        out.append(way / max(float(np.linalg.norm(way)), 1e-12))
    return np.array(out)


# ---- Algorithm 1

Match = namedtuple("Match", "affinity motion a b direction count")


def trace(points, closed, start, direction, count):
    """`count` samples from `start` on, or None where an open curve ends before."""
    n = len(points)
    if count > n:
        return None
    at = [start + direction * k for k in range(count)]
    if closed:
        return np.array([points[i % n] for i in at])
    return np.array([points[i] for i in at]) if 0 <= at[-1] < n else None


def distance(a, b, mean):
    """Distances of one stretch (n, 3) from each of many (k, n, 3) under the best rotations about their starts.

    Root mean square, or the plain mean; returns (k,) distances and (k, 3, 3) rotations.
    """
    a, b = a - a[0], b - b[:, :1]
    u, _, vt = np.linalg.svd(np.einsum("ni,knj->kij", a, b))
    vt[:, 2] *= np.sign(np.linalg.det(u) * np.linalg.det(vt))[:, None]
    r = np.swapaxes(u @ vt, 1, 2)
    away = np.linalg.norm(a @ np.swapaxes(r, 1, 2) - b, axis=2)
    return (away.mean(axis=1) if mean else np.sqrt((away**2).mean(axis=1))), r


def matches(curve_a, closed_a, curve_b, closed_b, *, l0, s, t, step, mean=False, apart=0):
    """All matches of Algorithm 1, for every start on a, every start on b and both directions on b.

    apart : for a curve with itself, starts at least this far apart
    """
    found = []
    for i in range(len(curve_a)):
        a = trace(curve_a, closed_a, i, 1, l0)
        starts = [(j, d) for j in range(len(curve_b)) for d in (1, -1)
                  if not apart or apart <= abs(i - j) <= len(curve_a) - apart]  # fmt: skip
        starts = [x for x in starts if trace(curve_b, closed_b, *x, l0) is not None]
        if a is None or not starts:
            continue
        first, rotations = distance(a, np.array([trace(curve_b, closed_b, *x, l0) for x in starts]), mean)
        for (j, direction), d, r in zip(starts, first, rotations):
            if not d < s:
                continue
            count = l0
            while True:
                longer_a = trace(curve_a, closed_a, i, 1, count + step)
                longer_b = trace(curve_b, closed_b, j, direction, count + step)
                if longer_a is None or longer_b is None:
                    break
                (further,), (turned,) = distance(longer_a, longer_b[None], mean)
                if not further < t:
                    break
                count, d, r = count + step, further, turned
            affinity = count * np.exp(-d / (0.5 * t))
            found.append(Match(float(affinity), rigid(r, curve_b[j] - r @ curve_a[i]), i, j, direction, count))
    return found


def best_match(*curves, **options):
    """The match of highest affinity of a pair of curves, or None."""
    return max(matches(*curves, **options), key=lambda m: m.affinity, default=None)


# ---- clusters, components


def partition(labels):
    """Sets of the indices that carry the same label."""
    sets = {}
    for i, label in enumerate(labels):
        sets.setdefault(int(label), set()).add(i)
    return {frozenset(s) for s in sets.values()}


def complete_linkage(distance, limit):
    """Partition by complete linkage: merge the two nearest sets while all of their members are within `limit`."""
    sets = [frozenset([i]) for i in range(len(distance))]
    while len(sets) > 1:
        nearest = None
        for x in range(len(sets)):
            for y in range(x):
                gap = max(distance[i][j] for i in sets[x] for j in sets[y])
                if nearest is None or gap < nearest[0]:
                    nearest = gap, x, y
        gap, x, y = nearest
        if gap > limit:
            break
        sets = [s for k, s in enumerate(sets) if k not in (x, y)] + [sets[x] | sets[y]]
    return set(sets)


def components(count, edges):
    """Connected components of nodes 0..count - 1, by relabelling until nothing changes."""
    label = list(range(count))
    changed = True
    while changed:
        changed = False
        for i, j in edges:
            low = min(label[i], label[j])
            if label[i] != low or label[j] != low:
                label[i] = label[j] = low
                changed = True
    return partition(label)


# ---- model selection


def log_likelihood(affinity, alive, null):
    """Sum over the curves of the log of the best affinity among the transformations alive and T_null."""
    return sum(np.log(max([null, *(affinity[k][c] for k in alive)])) for c in range(len(affinity[0])))


def eliminate(affinity, null, ratio):
    """Greedy elimination that computes every likelihood afresh; the transformations kept and log K of each."""
    alive = list(range(len(affinity)))
    while alive:
        whole = log_likelihood(affinity, alive, null)
        loss = [whole - log_likelihood(affinity, [k for k in alive if k != out], null) for out in alive]
        if min(loss) > np.log(ratio):
            return alive, loss
        alive.pop(int(np.argmin(loss)))
    return [], []


# ---- stretches, neighbours, paths


def long_stretches(hit, run_of, least):
    """Which True samples lie in an unbroken stretch of at least `least[i]` samples of one run."""
    out = [False] * len(hit)
    for i in range(len(hit)):
        if not hit[i]:
            continue
        low = high = i
        while low > 0 and hit[low - 1] and run_of[low - 1] == run_of[i]:
            low -= 1
        while high + 1 < len(hit) and hit[high + 1] and run_of[high + 1] == run_of[i]:
            high += 1
        out[i] = high - low + 1 >= least[i]
    return out


def nearest(points, place):
    """Index of the nearest point and its distance."""
    gaps = [float(np.linalg.norm(p - place)) for p in points]
    return int(np.argmin(gaps)), min(gaps)


def distance_to_polyline(place, line, closed=False):
    """Distance of a place from the segments of a polyline."""
    corners = np.array([*line, line[0]] if closed else line)
    start, side = corners[:-1], np.diff(corners, axis=0)
    u = np.clip(((place - start) * side).sum(axis=1) / np.maximum((side**2).sum(axis=1), 1e-300), 0, 1)
    return float(np.linalg.norm(start + u[:, None] * side - place, axis=1).min())


def lies_along(place, way, points, ways, *, radius, cosine, most):
    """Of the `most` nearest points within a radius the first with the same tangent, and its distance; or -1 and inf."""
    gaps = np.linalg.norm(points - place, axis=1)
    for j in np.argsort(gaps, kind="stable")[:most]:
        if gaps[j] < radius and abs(np.dot(ways[j], way)) > cosine:
            return int(j), float(gaps[j])
    return -1, np.inf


def placed(curves, poses):
    """Points and tangents of all curves at all poses, one pose after the other."""
    points = [m[:3, :3] @ p + m[:3, 3] for m in poses for c in curves for p in c]
    ways = [m[:3, :3] @ w for m in poses for c in curves for w in directions(c)]
    return np.array(points), np.array(ways)


def seen_share(points, tangents, curves, poses, *, radius, cosine=0.75):
    """(a, c) share of each curve at each pose along which samples lie, one point of a curve at a time."""
    share = np.zeros((len(poses), len(curves)))
    for a, m in enumerate(poses):
        for c, curve in enumerate(curves):
            seen = 0
            for p, w in zip(*placed([curve], [m])):
                seen += lies_along(p, w, points, tangents, radius=radius, cosine=cosine, most=3)[0] >= 0
            share[a, c] = seen / len(curve)
    return share


def recurs(points, tangents, motion, targets, lines, *, radius, cosine=0.8):
    """Which samples a motion takes to within the radius of a target with the same tangent, and the targets."""
    hit, to = [], []
    for p, w in zip(points, tangents):
        gaps = np.linalg.norm(targets - (motion[:3, :3] @ p + motion[:3, 3]), axis=1)
        k = int(np.argmin(gaps))
        hit.append(bool(gaps[k] <= radius and abs(np.dot(motion[:3, :3] @ w, lines[k])) > cosine))
        to.append(k)
    return np.array(hit), np.array(to)


def shortest_ways(weight):
    """Lengths of the shortest ways between all nodes (Floyd and Warshall); weight is inf where no edge is."""
    d = np.array(weight, float)
    for i in range(len(d)):
        d[i, i] = 0
    for k in range(len(d)):
        for i in range(len(d)):
            for j in range(len(d)):
                d[i, j] = min(d[i, j], d[i, k] + d[k, j])
    return d


def slips(motion, points, tangents, cosine):
    """Which points the screw motion through `motion` takes along their own tangents."""
    w, u = log_motion(motion)
    flags = []
    for p, line in zip(points, tangents):
        v = np.cross(w, p) + u
        flags.append(bool(abs(np.dot(v, line)) > cosine * np.linalg.norm(v)))
    return flags
