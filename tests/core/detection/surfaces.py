# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of surfaces whose curvature and crest lines are known exactly."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay


def sphere(level: int, radius: float = 1.0):
    """Subdivided icosahedron: vertices (n, 3), faces (m, 3)."""
    t = (1 + 5**0.5) / 2
    v = np.array([[s * a, r * b, 0.0] for s in (-1, 1) for r in (-1, 1) for a, b in ((1, t),)])
    v = np.concatenate([v, np.roll(v, 1, 1), np.roll(v, 2, 1)])
    hull = np.array(
        [
            (i, j, k)
            for i in range(12)
            for j in range(i + 1, 12)
            for k in range(j + 1, 12)
            if max(np.linalg.norm(v[i] - v[j]), np.linalg.norm(v[j] - v[k]), np.linalg.norm(v[i] - v[k])) < 2.1
        ]
    )
    inward = np.einsum("ij,ij->i", np.cross(v[hull[:, 1]], v[hull[:, 2]]), v[hull[:, 0]]) < 0
    f = np.where(inward[:, None], hull[:, ::-1], hull)
    for _ in range(level):
        v, f = subdivided(v, f)
        v = v / np.linalg.norm(v, axis=1, keepdims=True)
    return radius * v / np.linalg.norm(v, axis=1, keepdims=True), f


def subdivided(v, f):
    """Every face cut into four at the middles of its sides."""
    ends = np.sort(f[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    pairs, middle = np.unique(ends, axis=0, return_inverse=True)
    middle = middle.reshape(-1, 3) + len(v)
    v = np.concatenate([v, v[pairs].mean(axis=1)])
    a, b, c = f.T
    x, y, z = middle.T
    return v, np.concatenate([np.stack(t, 1) for t in ((a, x, z), (x, b, y), (z, y, c), (x, y, z))])


def ellipsoid(level: int, axes=(3.0, 2.0, 1.0)):
    """For axes a > b > c the only crest line is the ridge in the plane z = 0."""
    v, f = sphere(level)
    return v * np.array(axes), f


def torus(n: int, R: float = 2.0, r: float = 0.7):
    """A torus of quads cut at alternating diagonals: vertices, faces, principal curvatures (n, 2), high first."""
    m = max(6, round(n * r / R))
    u, w = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    u, w = u.ravel(), w.ravel()
    v = np.stack([(R + r * np.cos(w)) * np.cos(u), (R + r * np.cos(w)) * np.sin(u), r * np.sin(w)], axis=1)
    i, j = np.divmod(np.arange(n * m), m)
    a, b, c, d = (((i + di) % n) * m + (j + dj) % m for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
    flip = (i + j) % 2 == 0
    f1 = np.where(flip[:, None], np.stack([a, b, c], 1), np.stack([a, b, d], 1))
    f2 = np.where(flip[:, None], np.stack([a, c, d], 1), np.stack([b, c, d], 1))
    k = np.stack([np.full(len(w), 1 / r), np.cos(w) / (R + r * np.cos(w))], axis=1)
    return v, np.concatenate([f1, f2]), k


def graph(n: int, height, size: float = 1.0, seed: int = 0, jitter: float = 0.25):
    """z = height(x, y) over the square of half width `size`, on a jittered grid of n x n, normals upwards."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-size, size, n), np.linspace(-size, size, n), indexing="ij")
    step = 2 * size / (n - 1)
    inner = (np.abs(x) < size - step / 2) & (np.abs(y) < size - step / 2)
    x = x + inner * rng.uniform(-jitter, jitter, x.shape) * step
    y = y + inner * rng.uniform(-jitter, jitter, y.shape) * step
    p = np.stack([x.ravel(), y.ravel()], axis=1)
    f = Delaunay(p).simplices.astype(np.int64)
    d = p[f]
    p1, p2 = d[:, 1] - d[:, 0], d[:, 2] - d[:, 0]
    area = p1[:, 0] * p2[:, 1] - p1[:, 1] * p2[:, 0]
    f = np.where(area[:, None] < 0, f[:, ::-1], f)
    f = f[np.abs(area) > 1e-3 * step**2]
    return np.column_stack([p, height(p[:, 0], p[:, 1])]), f


def graph_curvature(p, fx, fy, fxx, fxy, fyy):
    """Principal curvatures (n, 2) of a graph, high first, positive where it is convex seen from above."""
    g = 1 + fx**2 + fy**2
    H = -((1 + fy**2) * fxx - 2 * fx * fy * fxy + (1 + fx**2) * fyy) / (2 * g**1.5)
    K = (fxx * fyy - fxy**2) / g**2
    root = np.sqrt(np.maximum(H**2 - K, 0))
    return np.stack([H + root, H - root], axis=1)


def saddle(n: int, **options):
    v, f = graph(n, lambda x, y: (x**2 - y**2) / 2, **options)
    x, y = v[:, 0], v[:, 1]
    one = np.ones_like(x)
    return v, f, graph_curvature(v, x, -y, one, 0 * one, -one)


def monkey_saddle(n: int, **options):
    v, f = graph(n, lambda x, y: (x**3 - 3 * x * y**2) / 3, **options)
    x, y = v[:, 0], v[:, 1]
    return v, f, graph_curvature(v, x**2 - y**2, -2 * x * y, 2 * x, -2 * y, -2 * x)


def rounded_box(n: int, half=(1.0, 0.8, 0.6), radius: float = 0.2):
    """Box of half sizes `half` whose edges have a radius; n quads on the longest side, cut in two."""
    half = np.array(half)
    step = 2 * half.max() / n
    points, faces, count = [], [], 0
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        nb, nc = (int(np.ceil(2 * half[k] / step)) + 1 for k in (b, c))
        s, t = np.meshgrid(np.linspace(-half[b], half[b], nb), np.linspace(-half[c], half[c], nc), indexing="ij")
        i, j = np.meshgrid(np.arange(nb - 1), np.arange(nc - 1), indexing="ij")
        i, j = i.ravel(), j.ravel()
        q = np.stack([i * nc + j, (i + 1) * nc + j, (i + 1) * nc + j + 1, i * nc + j + 1], axis=1)
        for sign in (-1, 1):
            p = np.empty((nb * nc, 3))
            p[:, axis], p[:, b], p[:, c] = sign * half[axis], s.ravel(), t.ravel()
            turned = q if sign > 0 else q[:, ::-1]
            points.append(p)
            faces.append(turned + count)
            count += len(p)
    cube = np.concatenate(points)
    inner = np.clip(cube, -(half - radius), half - radius)
    out = cube - inner
    # equal steps of angle on the rounding, not of tangent
    out = np.tan(out / radius * np.pi / 4)
    q = np.concatenate(faces)
    faces = np.concatenate([q[:, :3], q[:, [0, 2, 3]]])
    return inner + radius * out / np.linalg.norm(out, axis=1, keepdims=True), faces


def box_crests(half=(1.0, 0.8, 0.6), radius: float = 0.2, count: int = 400):
    """(12 * count, 3) points along the middles of the rounded edges, without the corners."""
    inner = np.array(half) - radius
    lines = []
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        for sb in (-1, 1):
            for sc in (-1, 1):
                p = np.empty((count, 3))
                p[:, axis] = np.linspace(-inner[axis], inner[axis], count)
                p[:, b], p[:, c] = sb * (inner[b] + radius / 2**0.5), sc * (inner[c] + radius / 2**0.5)
                lines.append(p)
    return np.concatenate(lines)


def noisy(v, share: float, seed: int = 0):
    """Vertices moved by Gaussian noise of `share` of the bounding box diagonal per coordinate."""
    return v + np.random.default_rng(seed).normal(0, share * np.linalg.norm(np.ptp(v, axis=0)), v.shape)


def folded_sheet(n: int, folds: int = 5, angle: float = 50.0, size: float = 1.0, seed: int = 0, jitter: float = 0.25):
    """A corrugated sheet: straight creases along y, by turns ridge and valley, bent by `angle` degrees.

    Returns vertices, faces and the x of each crease, the first of which is a ridge.
    """
    at = np.linspace(-size, size, folds + 2)
    rise = np.tan(np.radians(angle / 2)) * (at[1] - at[0])

    def height(x, y):
        return np.interp(x, at, rise * (np.arange(folds + 2) % 2))

    v, f = graph(n, height, size, seed, jitter)
    return v, f, at[1:-1]
