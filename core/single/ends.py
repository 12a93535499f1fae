# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends of pieces: where each one is, how it runs on, how well that is known, and what lies around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

ARM, ALIKE, AROUND, FLAT = 24, 4.0, 24, 0.05
"""Samples of an end that say how it runs on; samples over which noise is alike; neighbours that say how ends lie; and
the least thickness of what lies in a plane, as the sine of an angle."""


@dataclass(frozen=True)
class Ends:
    """Ends of p pieces, 2 i and 2 i + 1 those of piece i, q = 2 p.

    tip : (q, 3) float64, sample at the end; foot : (q, 3), where the arm as a whole ends
    way : (q, 3), unit, outwards; bend : (q, 3), second derivative outwards, 1 / edge length
    v_foot, v_way, v_bend : (q,) variances of each coordinate of these
    normal, thickness : (q, 3), (q,) direction in which the ends around lie least spread, and the root mean square
        sine of their directions to it (.58 where there is no order)
    density : (q,) other ends within `gap`, expected
    """

    tip: np.ndarray
    foot: np.ndarray
    way: np.ndarray
    bend: np.ndarray
    v_foot: np.ndarray
    v_way: np.ndarray
    v_bend: np.ndarray
    normal: np.ndarray
    thickness: np.ndarray
    density: np.ndarray


def ends_of(pieces, *, noise, turning, gap) -> Ends:
    """Ends of open pieces.

    noise : edge lengths, standard deviation of each coordinate about a smooth curve
    turning : 1 / edge length, usual curvature of curves; gap : edge lengths

    Notes
    -----
    A cubic with a usual second and third derivative is fitted to each arm (Bayesian linear regression): what a
    short arm does not show stays uncertain.
    """
    arms = [arm for p in pieces for arm in (p.points[:ARM], p.points[::-1][:ARM])]
    q = len(arms)
    coefficient, variance = np.zeros((q, 4, 3)), np.zeros((q, 4))
    size = np.array([len(a) for a in arms], np.int64)
    for k in np.unique(size):
        own = np.flatnonzero(size == k)
        fit, spread = _fitted(np.stack([arms[i] for i in own]), noise, turning)
        coefficient[own], variance[own] = fit, spread
    slope = np.linalg.norm(coefficient[:, 1], axis=1)
    way = -coefficient[:, 1] / np.maximum(slope, 1e-9)[:, None]
    bend = coefficient[:, 2] - way * (coefficient[:, 2] * way).sum(1)[:, None]
    tip = np.array([a[0] for a in arms]).reshape(-1, 3)
    normal, thickness, density = _around(tip, way, gap)
    return Ends(
        tip, coefficient[:, 0], way, bend, variance[:, 0], variance[:, 1], variance[:, 2], normal, thickness, density
    )


def _fitted(arms, noise, turning):
    """Derivatives 0 to 3 (m, 4, 3) at the start of arms (m, k, 3), and the variances (4,) of their coordinates."""
    s = np.arange(arms.shape[1], dtype=float)
    basis = np.stack([np.ones_like(s), s, s**2 / 2, s**3 / 6], axis=1)
    prior = np.array([0.0, 1.0, turning**-2, (turning / ARM) ** -2])  # of a slope, any direction: a unit vector
    precision = basis.T @ basis / (noise**2 * ALIKE) + np.diag(prior)
    covariance = np.linalg.inv(precision)
    first = arms[:, :1]
    fit = (covariance @ basis.T / (noise**2 * ALIKE)) @ (arms - first)
    fit[:, 0] += first[:, 0]
    return fit, np.diag(covariance)


def _around(tip, way, gap):
    """Normals (q, 3), thickness (q,) and density (q,) of the ends around each end."""
    q = len(tip)
    if q < 3:
        return np.tile([0.0, 0.0, 1.0], (q, 1)), np.full(q, 3**-0.5), np.ones(q)
    k = min(AROUND, q)
    tree = cKDTree(tip)
    distance, near = tree.query(tip, k=k)
    offset = tip[near] - tip[:, None]
    offset = offset / np.maximum(np.linalg.norm(offset, axis=2), 1e-9)[:, :, None]
    lines = np.concatenate([offset, way[near]], axis=1)
    moments = np.swapaxes(lines, 1, 2) @ lines
    # As if a few more ends lay about in no order.
    moments = (moments + 2 * np.eye(3) / 3) / (2 * k - 1 + 2)
    value, vector = np.linalg.eigh(moments)
    count = tree.query_ball_point(tip, gap, return_length=True).astype(float)
    return vector[:, :, 0], np.sqrt(np.maximum(value[:, 0], FLAT**2)), np.maximum(count - 1, 1.0)
