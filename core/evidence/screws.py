# SPDX-License-Identifier: GPL-3.0-or-later
"""Screw motions of many small sets of motions at a time, in numpy alone."""

from __future__ import annotations

import numpy as np

from ..geometry.motions import motion, rotation_vector, skew

HALF_TURN = 3.0
"""Angle in radians from which the axis is asked of a slower, steadier method: the skew part vanishes there."""


def turned(vectors):
    """Rotations (k, 3, 3) of rotation vectors (k, 3), by the formula of Rodrigues."""
    a = np.maximum(np.linalg.norm(vectors, axis=1), 1e-8)[:, None, None]
    k = skew(vectors)
    return np.eye(3) + np.sin(a) / a * k + (1 - np.cos(a)) / a**2 * (k @ k)


def rotation_vectors(rotation):
    """Axis times angle (k, 3), angle in radians from 0 to pi, of rotations (k, 3, 3)."""
    r = rotation
    off = np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], axis=1) / 2
    sine = np.linalg.norm(off, axis=1)
    angle = np.arctan2(sine, (r[:, 0, 0] + r[:, 1, 1] + r[:, 2, 2] - 1) / 2)
    out = off * (np.maximum(angle, 1e-12) / np.maximum(sine, 1e-12))[:, None]
    half = angle > HALF_TURN
    if half.any():
        out[half] = rotation_vector(rotation[half])
    return out


def screws(motions):
    """Axis vectors w (k, 3) and velocities u (k, 3) at the origin of the screw motions that lead to the motions."""
    w = rotation_vectors(motions[:, :3, :3])
    angle = np.linalg.norm(w, axis=1)
    small = angle < 1e-6
    a = np.where(small, 1.0, angle)
    factor = np.where(small, 1 / 12, (1 - a / 2 / np.tan(a / 2)) / a**2)
    k = skew(w)
    back = np.eye(3) - k / 2 + factor[:, None, None] * (k @ k)
    return w, np.einsum("nij,nj->ni", back, motions[:, :3, 3])


def moment(w, u):
    """Motions (k, 4, 4) that axis vectors w (k, 3) and velocities u (k, 3) lead to in unit time."""
    angle = np.linalg.norm(w, axis=1)
    small = angle < 1e-6
    a = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, (1 - np.cos(a)) / a**2)[:, None, None]
    second = np.where(small, 1 / 6, (a - np.sin(a)) / a**3)[:, None, None]
    k = skew(w)
    square = k @ k
    turn = np.eye(3) + np.where(small, 1.0, np.sin(a) / a)[:, None, None] * k + first * square
    way = np.eye(3) + first * k + second * square
    return motion(turn, np.einsum("nij,nj->ni", way, u))
