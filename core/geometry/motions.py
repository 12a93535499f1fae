# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid motions in bulk: best rotations, their residuals in closed form, and conversions."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation


def invariants(m):
    """Of 3 x 3 matrices given as nine arrays m[i][j]: sum of squares, sum of squared cofactors, determinant."""
    (a, b, c), (d, e, f), (g, h, i) = m
    ca, cb, cc = e * i - f * h, f * g - d * i, d * h - e * g
    cofactors = (ca, cb, cc, h * c - i * b, i * a - g * c, g * b - h * a, b * f - c * e, c * d - a * f, a * e - b * d)
    e1 = a * a
    for x in (b, c, d, e, f, g, h, i):
        e1 += x * x
    e2 = ca * ca
    for x in cofactors[1:]:
        e2 += x * x
    return e1, e2, a * ca + b * cb + c * cc


def largest_overlap(covariance, bound, rounds=12):
    """max over rotations R of trace(R covariance), by Newton's method from an upper bound.

    covariance : (n, 3, 3) float64; bound : (n,) float64, not below the result

    Notes
    -----
    With singular values s1 >= s2 >= s3 the maximum is s1 + s2 + sign(det) s3, the largest root of
    x^4 - 2 e1 x^2 - 8 det x + e1^2 - 4 e2 (Horn 1987). All four roots are real, so Newton's steps from
    above descend to the largest root and never pass it.
    """
    e1, e2, det = invariants(np.moveaxis(covariance, 0, -1))
    x = np.minimum(bound, np.sqrt(3 * e1))
    constant = e1 * e1 - 4 * e2
    for _ in range(rounds):
        square = x * x
        value = (square - 2 * e1) * square - 8 * det * x + constant
        slope = 4 * x * (square - e1) - 8 * det
        # At a double root (straight stretches) both vanish; what rounding leaves of them must not make a step.
        steep = (slope > 0) & (value > 1e-14 * square * square)
        x = x - np.where(steep, value / np.where(steep, slope, 1), 0)
    return x


def best_rotation(covariance):
    """Rotations R that maximise trace(R covariance^T), i.e. take a onto b for covariance sum of b a^T.

    covariance : (n, 3, 3) float64. Returns (n, 3, 3) rotations and (n, 3) singular values (Kabsch 1976).
    """
    u, s, vt = np.linalg.svd(covariance)
    return proper(u, vt), s


def proper(u, vt):
    """Rotations u d vt (n, 3, 3) of a singular value decomposition, d flipping the last axis where needed."""
    sign = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    sign[sign == 0] = 1
    flipped = u.copy()
    flipped[:, :, 2] *= sign[:, None]
    return flipped @ vt


def rotation_between(a, b):
    """Smallest rotations (n, 3, 3) that take the unit vectors a onto b, both (n, 3)."""
    v, c = np.cross(a, b), np.einsum("ij,ij->i", a, b)
    k = skew(v)
    factor = 1 / np.maximum(1 + c, 1e-9)
    r = np.eye(3) + k + k @ k * factor[:, None, None]
    flip = c < -1 + 1e-9
    if flip.any():
        x = np.where(np.abs(a[flip, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]])
        n = np.cross(a[flip], x)
        n /= np.linalg.norm(n, axis=1)[:, None]
        r[flip] = 2 * n[:, :, None] * n[:, None, :] - np.eye(3)
    return r


def skew(v):
    """Matrices (n, 3, 3) of the cross product with v (n, 3)."""
    z = np.zeros(len(v))
    x, y, w = v.T
    return np.stack([z, -w, y, w, z, -x, -y, x, z], axis=-1).reshape(-1, 3, 3)


def motion(rotation, translation):
    """(n, 4, 4) motions of (n, 3, 3) rotations and (n, 3) translations."""
    out = np.zeros((*np.shape(translation)[:-1], 4, 4))
    out[..., :3, :3], out[..., :3, 3], out[..., 3, 3] = rotation, translation, 1
    return out


def inverse(motions):
    """Inverses of rigid motions (..., 4, 4)."""
    r = np.swapaxes(motions[..., :3, :3], -1, -2)
    return motion(r, -(r @ motions[..., :3, 3:])[..., 0])


def apply(motions, points):
    """Points (..., k, 3) moved by motions (..., 4, 4)."""
    return points @ np.swapaxes(motions[..., :3, :3], -1, -2) + motions[..., None, :3, 3]


def rotation_vector(rotation):
    """Axis times angle (n, 3), angle in radians from 0 to pi, of rotations (n, 3, 3)."""
    return Rotation.from_matrix(rotation).as_rotvec()


def embed(motions, spread):
    """Motions as vectors whose distance is the RMS distance by which two motions differ on the curves.

    motions : (n, 4, 4) in a frame whose origin is the centroid of the curves and whose axes are their
    principal axes; spread : (3,) standard deviation of the curves along the axes. Returns (n, 12).

    Notes
    -----
    mean |A p - B p|^2 = tr(dR diag(spread^2) dR^T) + |dt|^2, the square of a Euclidean distance.
    """
    r = motions[:, :3, :3] * spread
    return np.concatenate([r.reshape(-1, 9), motions[:, :3, 3]], axis=1)


def screw_velocity(motions):
    """Axis vectors w (n, 3) and velocities u (n, 3) at the origin of the screw motions that lead to the motions.

    exp of (w, u) is the motion: w is the rotation vector and u = V(w)^-1 t (Murray, Li and Sastry 1994, 2.3).
    """
    w = rotation_vector(motions[:, :3, :3])
    angle = np.linalg.norm(w, axis=1)
    k = skew(w)
    small = angle < 1e-6
    a = np.where(small, 1.0, angle)
    factor = np.where(small, 1 / 12, (1 - a / 2 / np.tan(np.where(small, 1.0, a / 2))) / a**2)
    v_inverse = np.eye(3) - k / 2 + factor[:, None, None] * (k @ k)
    return w, np.einsum("nij,nj->ni", v_inverse, motions[:, :3, 3])


def exponential(twists):
    """Motions (n, 4, 4) of twists (n, 6), the rotation vector w and the velocity u: inverse of `screw_velocity`."""
    w, u = twists[:, :3], twists[:, 3:]
    angle = np.linalg.norm(w, axis=1)
    small = angle < 1e-6
    a = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, (1 - np.cos(a)) / a**2)
    second = np.where(small, 1 / 6, (a - np.sin(a)) / a**3)
    k = skew(w)
    v = np.eye(3) + first[:, None, None] * k + second[:, None, None] * (k @ k)
    return motion(Rotation.from_rotvec(w).as_matrix(), np.einsum("nij,nj->ni", v, u))
