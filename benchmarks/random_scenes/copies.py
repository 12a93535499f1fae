# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a stretch of a curve has a copy elsewhere, up to rotation, translation, reflection and direction."""

from __future__ import annotations

import numpy as np

STRETCH = 80
"""Edges; shorter stretches of smooth curves are alike by chance."""
ALIKE = 0.7
"""Edges, root mean square after the best motion; copies whose samples are noisy lie as near as that."""
STRAIGHT = 3.0
"""Edges, root mean square distance from a line; what is straighter is like all lines and says nothing."""
STEPS = (3, 12)
"""Edges between the starts of the stretches that are compared."""


def stretches(parts, step) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bent stretches of curves with points one edge apart.

    Returns points (m, k, 3) float64 about their mean, every other edge, with part (m,) and start (m,) int64.
    """
    at = [(i, s) for i, p in enumerate(parts) for s in range(0, len(p) - STRETCH, step)]
    of, start = np.array(at, np.int64).reshape(-1, 2).T
    points = np.array([parts[i][s : s + STRETCH + 1 : 2] for i, s in at]).reshape(len(at), STRETCH // 2 + 1, 3)
    points = points - points.mean(axis=1, keepdims=True)
    spread = np.linalg.eigvalsh(np.einsum("mki,mkj->mij", points, points))
    bent = np.sqrt(np.maximum(spread[:, :2].sum(axis=1), 0) / points.shape[1]) > STRAIGHT
    return points[bent], of[bent], start[bent]


def has_copies(parts, others=()) -> bool:
    """Whether some stretch of the parts is seen again in them or in the others.

    parts, others : lists of (n, 3) polylines with points one edge apart
    """
    first, of, start = stretches(parts, STEPS[1])
    second, second_of, second_start = stretches([*parts, *others], STEPS[0])
    if len(first) == 0:
        return False
    size, second_size = (np.linalg.norm(p, axis=(1, 2)) for p in (first, second))
    allowed = ALIKE * np.sqrt(first.shape[1])
    near = np.abs(size[:, None] - second_size) <= allowed  # the difference of the norms bounds the residual from below
    near &= (of[:, None] != second_of) | (np.abs(start[:, None] - second_start) >= STRETCH)
    i, j = np.nonzero(near)
    for turned in (second, second[:, ::-1]):
        for k in range(0, len(i), 50_000):
            a, b = i[k : k + 50_000], j[k : k + 50_000]
            across = np.einsum("mki,mkj->mij", first[a], turned[b])
            overlap = np.linalg.svd(across, compute_uv=False).sum(axis=1)
            residual = size[a] ** 2 + second_size[b] ** 2 - 2 * overlap
            if (residual <= allowed**2).any():
                return True
    return False
