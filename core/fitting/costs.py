# SPDX-License-Identifier: GPL-3.0-or-later
"""How badly one line, one arc or one cubic explains a range of samples, for many ranges at once.

All are sums of squared distances, from moments that are summed up once along the curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

KINDS = ("line", "arc", "bezier")
LEAST = np.array([2, 4, 6])
"""Fewest samples of each kind: with fewer, more than one such piece goes through them."""


@dataclass(frozen=True)
class Moments:
    """Sums along a curve that begin with 0. points : (n, 3), centred; first : (n + 1, 3); second : (n + 1, 3, 3);
    third : (n + 1, 3), of the square times the point; fourth : (n + 1,), of the square squared."""

    points: np.ndarray
    first: np.ndarray
    second: np.ndarray
    third: np.ndarray
    fourth: np.ndarray

    @classmethod
    def of(cls, points) -> Moments:
        p = points - points.mean(axis=0)
        square = (p * p).sum(axis=1)
        sums = (p, p[:, :, None] * p[:, None, :], square[:, None] * p, square**2)
        return cls(p, *(np.concatenate([np.zeros_like(s[:1]), np.cumsum(s, axis=0)]) for s in sums))


def line_cost(m: Moments, a, b):
    """Sums of squared distances of samples a to b (exclusive) from their best lines.

    Returns (k,) float64, the (k, 3) means and the (k, 3, 3) second moments about them.
    """
    n = (b - a)[:, None]
    mean = (m.first[b] - m.first[a]) / n
    spread = m.second[b] - m.second[a] - n[:, :, None] * mean[:, :, None] * mean[:, None, :]
    trace = np.trace(spread, axis1=1, axis2=2)
    return np.maximum(trace - _largest_eigenvalue(spread, trace), 0), mean, spread


def _largest_eigenvalue(s, trace):
    """Of symmetric matrices (k, 3, 3), by the trigonometric solution of the cubic; exact to rounding."""
    q = trace / 3
    d = s - q[:, None, None] * np.eye(3)
    size = np.sqrt((d * d).sum(axis=(1, 2)) / 6)
    x, y, z, xy, xz, yz = d[:, 0, 0], d[:, 1, 1], d[:, 2, 2], d[:, 0, 1], d[:, 0, 2], d[:, 1, 2]
    det = x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz)
    half = det / 2 / np.maximum(size**3, 1e-300)
    return q + 2 * size * np.cos(np.arccos(np.clip(half, -1, 1)) / 3)


def arc_cost(m: Moments, a, b, mean, spread):
    """(k,) float64, sums of squared distances from circles, out of their planes and in them.

    Notes
    -----
    In the plane of the two main axes x and y of the samples, Kasa's circle minimises the sum of (|p|^2 - 2 c p - k)^2.
    The axes are uncorrelated, so it is solved axis by axis; near the circle the bracket is 2 r times the distance.
    """
    n = b - a
    values, axes = np.linalg.eigh(spread)
    second = m.second[b] - m.second[a]
    first, square = m.first[b] - m.first[a], np.trace(second, axis1=1, axis2=2)
    c2 = (mean * mean).sum(axis=1)
    c_second = np.einsum("ki,kij->kj", mean, second)
    third = m.third[b] - m.third[a] - 2 * c_second + c2[:, None] * first
    about = square - 2 * (mean * first).sum(axis=1) + n * c2
    third -= mean * about[:, None]
    fourth = m.fourth[b] - m.fourth[a] - 4 * (mean * (m.third[b] - m.third[a])).sum(axis=1)
    fourth += 2 * c2 * square + 4 * (c_second * mean).sum(axis=1) - 4 * c2 * (mean * first).sum(axis=1) + n * c2**2
    flat = np.maximum(values[:, 0], 0)
    main = np.maximum(values[:, 1:], 1e-300)
    pull = np.einsum("ki,kij->kj", third, axes[:, :, 1:])
    height = values.sum(axis=1) / n
    centre = pull / (2 * main)
    algebraic = np.maximum(fourth - n * height**2 - (pull**2 / main).sum(axis=1), 0)
    return algebraic / (4 * (height + (centre**2).sum(axis=1))) + flat


def cubic_cost(m: Moments, a, b):
    """(k,) float64, sums of squared distances from cubics in the sample's number: an upper bound of the best Bezier.

    Notes
    -----
    The powers are made orthogonal over the samples (Gram), so what a cubic explains is a sum of four squares. Sums of
    powers begin anew every `BLOCK` samples, so that what is subtracted stays small beside what is left.
    """
    out = np.empty(len(a))
    block = a // BLOCK
    for k in np.unique(block):
        rows = np.flatnonzero(block == k)
        out[rows] = _cubic_cost(m.points[k * BLOCK : b[rows].max()], a[rows] - k * BLOCK, b[rows] - k * BLOCK)
    return out


BLOCK = 64


def _cubic_cost(points, a, b):
    y = points - points[0]
    t = np.arange(len(y), dtype=float)
    powers = np.stack([np.ones_like(t), t, t * t, t**3])[:, :, None] * y
    sums = np.zeros((5, len(y) + 1, 3))
    np.cumsum(powers, axis=1, out=sums[:4, 1:])
    np.cumsum(y * y, axis=0, out=sums[4, 1:])
    d0, d1, d2, d3, square = sums[:, b] - sums[:, a]
    middle, n = ((a + b - 1) / 2)[:, None], (b - a)[:, None].astype(float)
    d3 = d3 - middle * (3 * d2 - middle * (3 * d1 - middle * d0))
    d2 = d2 - middle * (2 * d1 - middle * d0)
    d1 = d1 - middle * d0
    m2 = (n**2 - 1) / 12
    m4 = m2 * (3 * n**2 - 7) / 20
    m6 = m2 * (3 * n**4 - 18 * n**2 + 31) / 112
    explained = d0**2 + d1**2 / m2 + (d2 - m2 * d0) ** 2 / (m4 - m2**2) + (d3 - m4 / m2 * d1) ** 2 / (m6 - m4**2 / m2)
    return np.maximum((square - explained / n).sum(axis=1), 0)
