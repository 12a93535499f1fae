# SPDX-License-Identifier: GPL-3.0-or-later
"""How noisy a scan is, from its finest detail, and how far that noise bends a plane after smoothing."""

from __future__ import annotations

import numpy as np

from ..mesh.mesh import TriangleMesh

_QUARTILE = 0.3186393639643752
"""Lower quartile of the absolute value of a normal variable of deviation 1. Features only raise the upper part."""

_STRENGTH, _MESH = 0.64, 0.37
"""Of `noise_fold`, fitted to noise on planes at scales from 0 to 3 edge lengths, even meshes and uneven ones.
The second is the squared width, in edges, of the smoothing that the fit of the tensors brings along by itself."""


def noise_level(points: np.ndarray, normals: np.ndarray, mesh: TriangleMesh, tick=lambda: None) -> float:
    """Standard deviation of the vertices along the normals as far as neighbours do not share it, scene units.

    Each vertex's height above the mean of its neighbours, compared with the mean of their heights: what is left is
    blind to planes, spheres and cylinders, and small on all that bends evenly over a few edges.
    Noise that the scanner or the reconstruction has smoothed itself is not seen.

    Notes
    -----
    The variance that unit noise gives is that of a regular mesh whose vertices all have the same degree.
    """
    inner = ~mesh.boundary_vertices
    if not inner.any():
        return 0.0
    i, j = mesh.edges.T
    n = len(points)
    degree = np.bincount(i, minlength=n) + np.bincount(j, minlength=n)

    def mean_around(x):
        tick()
        return (np.bincount(i, x[j], n) + np.bincount(j, x[i], n)) / degree

    height = sum(normals[:, k] * (points[:, k] - mean_around(points[:, k])) for k in range(3))
    rest = height - mean_around(height)
    # own weight 1 + 1/d, each neighbour's 2/d - 2/d^2, and a little from the second ring
    variance = (1 + 1 / degree) ** 2 + (2 - 2 / degree) ** 2 / degree + 0.02
    return float(np.quantile(np.abs(rest / np.sqrt(variance))[inner], 0.25) / _QUARTILE)


def noise_fold(noise: float, scale: float, edge_length: float) -> float:
    """Radians: the fold angle that half of a noisy plane exceeds, smoothed by `scale`; all in scene units.

    The curvature of white noise smoothed by s falls like 1 / s^3, the fold that it stands for like 1 / s^2.
    """
    return _STRENGTH * noise * edge_length / (_MESH * edge_length**2 + scale**2)
