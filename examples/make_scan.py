# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a scan-like mesh, `examples/scan.ply`: `python -m examples.make_scan [OUT.ply]` in the folder above.

A wall with pointed windows in two rows, a rosette and two cornices, all in relief, sampled as a scanner would: points
without order, denser below than above, noisy, with holes. It stands upright (z is up, the wall looks along -y),
one unit is a metre. The same seed gives the same file.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

OUT = Path(__file__).with_name("scan.ply")
SEED = 2018
SPACING = 0.027
WIDTH, HEIGHT = 5.6, 8.0

WINDOWS = [(0.7 + 1.4 * i, 0.95 + 2.05 * j) for j in range(2) for i in range(4)]
ROSETTE = (2.8, 6.55)
PETALS = 8
RAMP = 0.06
"""Width over which one level passes into the next: a scanner sees no upright step."""

# levels of a profile: (offset from the outline, outwards positive; height) from inside to outside
WINDOW_PROFILE = [(-RAMP, -0.12), (0.0, 0.06), (0.18, 0.06), (0.18 + RAMP, 0.0)]
RING_PROFILE = [(-RAMP, -0.05), (0.0, 0.07), (0.18, 0.07), (0.18 + RAMP, 0.0)]
PETAL_PROFILE = [(-RAMP, -0.14), (0.0, 0.0)]
CORNICE_PROFILE = [(-RAMP, 0.1), (0.0, 0.0)]


@dataclass(frozen=True)
class Scan:
    """vertices (n, 3), faces (m, 3); the creases as built: curves (k, 3) each, closed or not, kind ridge or valley."""

    vertices: np.ndarray
    faces: np.ndarray
    curves: list
    closed: list
    kinds: list


def window_distance(x, z, width=0.62, spring=0.9):
    """Distance from the outline of a pointed window whose sill's middle is the origin; inside is negative."""
    half = width / 2
    arch = np.maximum(np.hypot(x - half, z - spring), np.hypot(x + half, z - spring)) - width
    return np.maximum(np.where(z > spring, arch, np.abs(x) - half), -z)


def window_outline(offset, width=0.62, spring=0.9):
    """(k, 2), the closed line at a distance from the outline."""
    half, radius = width / 2, width + offset
    apex = np.arccos(half / radius)
    turn = np.linspace(0, apex, 40)
    right = np.stack([-half + radius * np.cos(turn), spring + radius * np.sin(turn)], axis=1)
    left = right[::-1][1:] * [-1, 1]
    jamb = np.linspace(-offset, spring, 30)[:-1]
    sill = np.linspace(-half - offset, half + offset, 25)[1:-1]
    rising = np.column_stack([np.full(len(jamb), half + offset), jamb])
    falling = (rising * [-1, 1])[::-1]
    return np.concatenate([rising, right, left, falling, np.column_stack([sill, np.full(len(sill), -offset)])])


def petal_centres():
    turn = np.arange(PETALS) * 2 * np.pi / PETALS
    return np.array(ROSETTE) + 0.68 * np.stack([np.sin(turn), np.cos(turn)], axis=1)


def height(x, z):
    """Relief of the wall, outwards positive, at points (n,)."""
    total = np.zeros_like(x)
    for cx, cz in WINDOWS:
        total += _profile(window_distance(x - cx, z - cz), WINDOW_PROFILE)
    total += _profile(np.hypot(x - ROSETTE[0], z - ROSETTE[1]) - 1.0, RING_PROFILE)
    for cx, cz in petal_centres():
        total += _profile(np.hypot(x - cx, z - cz) - 0.2, PETAL_PROFILE)
    for low, high in ((0.15, 0.4), (4.9, 5.15)):
        total += _profile(np.maximum(low - z, z - high), CORNICE_PROFILE)
    return total


def _profile(distance, levels):
    at, value = np.array(levels).T
    return np.interp(distance, at, value)


def creases():
    """The lines at which the relief bends: points (k, 2), closed, kind; by the turn of each profile."""
    found = []
    for centre in WINDOWS:
        found += [(window_outline(o) + centre, True, k) for o, k in _bends(WINDOW_PROFILE)]
    turn = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    found += [((1.0 + o) * circle + ROSETTE, True, k) for o, k in _bends(RING_PROFILE)]
    for centre in petal_centres():
        found += [((0.2 + o) * circle[::3] + centre, True, k) for o, k in _bends(PETAL_PROFILE)]
    along = np.linspace(0, WIDTH, 150)
    for low, high in ((0.15, 0.4), (4.9, 5.15)):
        for o, k in _bends(CORNICE_PROFILE):
            found += [(np.column_stack([along, np.full(150, z)]), False, k) for z in (low - o, high + o)]
    return found


def _bends(levels):
    at, value = np.array(levels).T
    slope = np.r_[0, np.diff(value) / np.diff(at), 0]
    return [(o, "ridge" if change < 0 else "valley") for o, change in zip(at, np.diff(slope))]


def scan(seed: int = SEED, *, spacing: float = SPACING, noise: float = 0.15, holes: int = 9) -> Scan:
    """The scan: mean point distance `spacing` (metres) low on the wall, noise in multiples of it."""
    rng = np.random.default_rng(seed)
    points = _samples(rng, spacing)
    faces = Delaunay(points).simplices.astype(np.int64)
    a, b, c = points[faces].transpose(1, 0, 2)
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    faces = np.where(turn[:, None] < 0, faces[:, ::-1], faces)
    sides = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2)
    faces = faces[(sides.max(axis=1) < 4 * spacing) & (np.abs(turn) > 0.02 * spacing**2)]
    middle = points[faces].mean(axis=1)
    gone = np.zeros(len(faces), bool)
    for _ in range(holes):
        centre, size = rng.uniform((0.3, 0.3), (WIDTH - 0.3, HEIGHT - 0.3)), rng.uniform(0.08, 0.26, 2)
        ragged = 1 + 0.25 * np.sin(5 * np.arctan2(*(middle - centre).T) + rng.uniform(0, 6))
        gone |= np.hypot(*((middle - centre) / size).T) < ragged
    faces = faces[~gone]
    used, index = np.unique(faces, return_inverse=True)
    points = points[used]
    wall = np.column_stack([points[:, 0], -height(*points.T), points[:, 1]])
    wall = wall + rng.normal(0, noise * spacing, wall.shape)
    lines = creases()
    curves = [np.column_stack([p[:, 0], -height(*p.T), p[:, 1]]) for p, _, _ in lines]
    return Scan(wall, index.reshape(-1, 3), curves, [x[1] for x in lines], [x[2] for x in lines])


def _samples(rng, spacing):
    """Points on the wall without order, 1.5 times as far apart at the top as at the bottom."""
    rows, z = [], 0.0
    while z < HEIGHT:
        step = spacing * (1 + 0.5 * z / HEIGHT)
        x = np.arange(rng.uniform(0, step), WIDTH, step)
        rows.append(np.column_stack([x, np.full(len(x), z)]) + rng.uniform(-0.3, 0.3, (len(x), 2)) * step)
        z += step * 0.87
    return np.concatenate(rows)


def ply_bytes(vertices, faces) -> bytes:
    """Binary little-endian PLY of triangles."""
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    return head.encode("ascii") + np.asarray(vertices, "<f4").tobytes() + rows.tobytes()


def main(arguments) -> None:
    made = scan()
    out = Path(arguments[0]) if arguments else OUT
    out.write_bytes(ply_bytes(made.vertices, made.faces))
    print(f"{out}: {len(made.vertices)} vertices, {len(made.faces)} faces, {out.stat().st_size} bytes")


if __name__ == "__main__":
    main(sys.argv[1:])
