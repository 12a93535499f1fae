# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow and plain versions of what `core.detection` does at once; they share no code with it."""

from __future__ import annotations

import numpy as np


def rotation(start, end):
    """(3, 3) smallest rotation that takes one unit vector to another (Rodrigues)."""
    axis, cos = np.cross(start, end), float(np.dot(start, end))
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + k + k @ k / (1 + cos)


def corner_area(a, b, c):
    """Part of the triangle that belongs to corner a: its Voronoi area, or the mixed one where a corner is obtuse."""
    area = np.linalg.norm(np.cross(b - a, c - a)) / 2
    if np.dot(b - a, c - a) < 0:
        return area / 2
    if np.dot(a - b, c - b) < 0 or np.dot(a - c, b - c) < 0:
        return area / 4
    # the kite between a, the middles of its two sides and the centre of the circle through the corners
    u, v = b - a, c - a
    w = np.cross(u, v)
    centre = (np.dot(u, u) * np.cross(v, w) + np.dot(v, v) * np.cross(w, u)) / (2 * np.dot(w, w))
    return (np.linalg.norm(np.cross(u / 2, centre)) + np.linalg.norm(np.cross(v / 2, centre))) / 2


def face_frame(a, b, c):
    normal = np.cross(b - a, c - a)
    normal = normal / np.linalg.norm(normal)
    u = (b - a) / np.linalg.norm(b - a)
    return u, np.cross(normal, u), normal


def second_form(points, normals):
    """World tensor (3, 3) of one face by least squares over its sides."""
    u, v, _ = face_frame(*points)
    rows, right = [], []
    for i in range(3):
        side, change = points[(i + 1) % 3] - points[i], normals[(i + 1) % 3] - normals[i]
        s, t = np.dot(side, u), np.dot(side, v)
        rows += [[s, t, 0], [0, s, t]]
        right += [np.dot(change, u), np.dot(change, v)]
    a, b, c = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    return a * np.outer(u, u) + b * (np.outer(u, v) + np.outer(v, u)) + c * np.outer(v, v)


def vertex_forms(points, normals, faces):
    """(n, 3, 3): tensors of the faces turned into each vertex's tangent plane, mean by area."""
    total, weight = np.zeros((len(points), 3, 3)), np.zeros(len(points))
    for face in faces:
        p = points[face]
        form, normal = second_form(p, normals[face]), face_frame(*p)[2]
        for i in range(3):
            r = rotation(normal, normals[face[i]])
            area = corner_area(p[i], p[(i + 1) % 3], p[(i + 2) % 3])
            total[face[i]] += area * (r @ form @ r.T)
            weight[face[i]] += area
    return total / weight[:, None, None]


def third_form(points, forms):
    """(3, 3, 3) derivative of the tensor in one face, symmetric: least squares over the sides."""
    u, v, _ = face_frame(*points)
    plane = np.stack([u, v])
    local = [plane @ f @ plane.T for f in forms]
    rows, right = [], []
    for i in range(3):
        side, change = points[(i + 1) % 3] - points[i], local[(i + 1) % 3] - local[i]
        s, t = np.dot(side, u), np.dot(side, v)
        two = np.sqrt(2)  # the entry off the diagonal stands twice in the tensor
        rows += [[s, t, 0, 0], [0, two * s, two * t, 0], [0, 0, s, t]]
        right += [change[0, 0], two * change[0, 1], change[1, 1]]
    c = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    out = np.zeros((3, 3, 3))
    for i in range(2):
        for j in range(2):
            for k in range(2):
                out += c[i + j + k] * np.einsum("a,b,c->abc", plane[i], plane[j], plane[k])
    return out


def slopes(points, normals, faces, forms, directions):
    """(n,): the derivative, averaged at each vertex, applied three times to its direction."""
    total, weight = np.zeros((len(points), 3, 3, 3)), np.zeros(len(points))
    for face in faces:
        p = points[face]
        form = third_form(p, forms[face])
        for i in range(3):
            area = corner_area(p[i], p[(i + 1) % 3], p[(i + 2) % 3])
            total[face[i]] += area * form
            weight[face[i]] += area
    return np.einsum("nabc,na,nb,nc->n", total / weight[:, None, None, None], directions, directions, directions)


def walked_chains(segments):
    """Set of polylines of a graph as tuples: walk from every end and junction, then around every loop."""
    segments = {tuple(sorted(s)) for s in segments.tolist() if s[0] != s[1]}
    around = {}
    for a, b in segments:
        around.setdefault(a, set()).add(b)
        around.setdefault(b, set()).add(a)
    left, found = set(segments), []

    def walk(start, first):
        path = [start, first]
        left.discard(tuple(sorted(path)))
        while len(around[path[-1]]) == 2 and path[-1] != start:
            onward = next(n for n in around[path[-1]] if n != path[-2])
            left.discard(tuple(sorted((path[-1], onward))))
            path.append(onward)
        return path

    for node, neighbours in around.items():
        if len(neighbours) != 2:
            for n in neighbours:
                if tuple(sorted((node, n))) in left:
                    found.append((walk(node, n), False))
    while left:
        a, b = min(left)
        found.append((walk(a, b)[:-1], True))
    return {named(path, closed) for path, closed in found}


def named(path, closed):
    """The same name for a path in both directions, and for a loop from any start."""
    if not closed:
        return min(tuple(path), tuple(path[::-1]))
    turns = [tuple(p[i:] + p[:i]) for p in (list(path), list(path)[::-1]) for i in range(len(path))]
    return ("loop", *min(turns))


def crest_segments(mesh, high, low, direction, slope, prominent, dominant, width, points):
    """Face by face: pairs of edges (as vertex pairs) that a ridge passes through, and which crossings are sound."""
    found, sound = set(), {}

    def crossing(i, j):
        s = 1 if np.dot(direction[i], direction[j]) >= 0 else -1
        return slope[i] * s * slope[j] < 0

    def value(i, j):
        t = abs(slope[i]) / (abs(slope[i]) + abs(slope[j]))
        return (1 - t) * high[i] + t * high[j], (1 - t) * low[i] + t * low[j]

    for face in mesh.faces:
        edges = [tuple(sorted((face[a], face[b]))) for a, b in ((1, 2), (2, 0), (0, 1))]
        hit = [e for e in edges if crossing(*e)]
        if len(hit) < 2:
            continue
        hit = sorted(hit, key=lambda e: -value(*e)[0])[:2]
        sign = [1 if np.dot(direction[v], direction[face[0]]) >= 0 else -1 for v in face]
        along = sum(s * direction[v] for s, v in zip(sign, face))
        along = along / np.linalg.norm(along)
        p = points[face]
        # the linear function's gradient from two equations and none along the normal
        normal = np.cross(p[1] - p[0], p[2] - p[0])
        values = [s * slope[v] for s, v in zip(sign, face)]
        gradient = np.linalg.solve(
            np.stack([p[1] - p[0], p[2] - p[0], normal]), [values[1] - values[0], values[2] - values[0], 0]
        )
        fall = -np.dot(gradient, along) * (np.mean(width[face]) ** 2 + (0.5 * mesh.edge_length) ** 2)
        maximal = fall / abs(np.mean(high[face])) > prominent
        found.add(frozenset(hit))
        for e in hit:
            k, other = value(*e)
            sound[e] = sound.get(e, False) or (maximal and k > dominant * abs(other))
    return found, sound


def noise(points, normals, faces):
    """Deviation of the noise along the normals: lower quartile over the inner vertices, one at a time."""
    around, sides = [set() for _ in points], {}
    for face in faces:
        for a, b in ((0, 1), (1, 2), (2, 0)):
            around[face[a]].add(face[b])
            around[face[b]].add(face[a])
            key = frozenset((face[a], face[b]))
            sides[key] = sides.get(key, 0) + 1
    rim = {v for key, count in sides.items() if count == 1 for v in key}
    mean = [np.mean([points[j] for j in a], axis=0) for a in around]
    height = [np.dot(normals[i], points[i] - mean[i]) for i in range(len(points))]
    left = []
    for i in range(len(points)):
        if i not in rim:
            d = len(around[i])
            deviation = np.sqrt((1 + 1 / d) ** 2 + d * (2 / d - 2 / d**2) ** 2 + 0.02)
            left.append(abs(height[i] - np.mean([height[j] for j in around[i]])) / deviation)
    return np.quantile(left, 0.25) / 0.31863936396437514
