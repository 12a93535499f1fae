# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses moved onto the samples that show them (iterative closest points, across the curves only)."""

from __future__ import annotations

import numpy as np

from ..geometry.motions import motion
from .field import Field, Probe
from .screws import turned

ALONG, TURN = 0.02, 0.2
"""Weight of the distance along a curve beside that across it (holds what nothing else holds), and the largest turn of
one step, radians; numerical."""

HOLD = 0.3, 1.0, 0.003
"""Damping of the step: edge lengths squared on the shift, on the turn, and relative to the spread; numerical."""

BLOCK = 400_000
"""Points that are moved at a time; bounds the memory."""


def align(field: Field, poses, probe: Probe, *, radii, samples=None):
    """Poses (k, 4, 4) after one step of Gauss and Newton for each of the radii.

    Parameters
    ----------
    probe : of (m, 3), the same for all poses, or (k, m, 3), one for each
    radii : edge lengths within which samples draw the points, a step each
    samples : (n,) bool, samples that count; None takes all
    """
    shared = probe.points.ndim == 2
    size = max(1, BLOCK // max(1, len(probe)))
    parts = [slice(i, i + size) for i in range(0, len(poses), size)]
    out = [_aligned(field, poses[part], probe if shared else probe.take(part), radii, samples) for part in parts]
    return np.concatenate(out) if out else poses


def _aligned(field, poses, probe, radii, samples):
    for radius in radii:
        at = probe.moved(poses)
        near = field.shown_by(at, radius)
        hit = near >= 0
        if samples is not None:
            hit &= samples[near]
        poses = _step(at.points, field.points[near], field.tangents[near], hit) @ poses
        u, _, vt = np.linalg.svd(poses[:, :3, :3])
        poses[:, :3, :3] = u @ vt
    return poses


def _step(points, targets, lines, hit):
    """Motions (k, 4, 4) that take points (k, m, 3) nearer to the lines through the targets where `hit` (k, m)."""
    w = hit.astype(float)
    count = np.maximum(w.sum(axis=1), 1)
    centre = np.einsum("km,kmi->ki", w, points) / count[:, None]
    q = points - centre[:, None]
    # Rows of S J with J = [-[q]x, I] and S = I - (1 - sqrt(ALONG)) t t^T, the square root of the metric.
    share = (1 - np.sqrt(ALONG)) * lines
    moment = np.cross(q, lines)  # t . (w x q) = w . (q x t)
    jacobian = np.zeros((*points.shape[:2], 3, 6))
    x, y, z = np.moveaxis(q, -1, 0)
    jacobian[..., 0, 1], jacobian[..., 0, 2], jacobian[..., 1, 0] = z, -y, -z
    jacobian[..., 1, 2], jacobian[..., 2, 0], jacobian[..., 2, 1] = x, y, -x
    jacobian[..., :3] -= share[..., :, None] * moment[..., None, :]
    jacobian[..., 3:] = np.eye(3) - share[..., :, None] * lines[..., None, :]
    gap = targets - points
    gap = gap - share * np.einsum("kmi,kmi->km", gap, lines)[..., None]
    jacobian *= w[..., None, None]
    rows = jacobian.reshape(len(points), -1, 6)
    normal = np.swapaxes(rows, 1, 2) @ rows
    right = np.swapaxes(rows, 1, 2) @ gap.reshape(len(points), -1, 1)
    spread = np.einsum("kii->k", normal[:, :3, :3]) / 3
    k = np.arange(3)
    normal[:, k, k] += (HOLD[2] * spread + HOLD[1])[:, None]
    normal[:, k + 3, k + 3] += HOLD[0]
    step = np.linalg.solve(normal, right)[..., 0]
    angle = np.linalg.norm(step[:, :3], axis=1, keepdims=True)
    step[:, :3] *= np.minimum(1, TURN / np.maximum(angle, 1e-12))
    turn = turned(step[:, :3])
    return motion(turn, step[:, 3:] + centre - np.einsum("kij,kj->ki", turn, centre))
