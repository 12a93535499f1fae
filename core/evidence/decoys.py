# SPDX-License-Identifier: GPL-3.0-or-later
"""Decoys: the same poses, shifted and turned a little, to learn what chance shows (Elias and Gygi 2007).

The network is as dense beside a true pose as at it, but nothing corresponds there. Half of the decoys are shifts along
the main directions of the curves: parallel lines show a shift along themselves as well as the true pose. The others
are shifted and turned any way.
"""

from __future__ import annotations

import numpy as np

from ..geometry.motions import motion, skew
from .screws import moment, turned

SHIFT, AWAY, TURN = 7.0, (7.0, 13.0), (4.0, 8.0)
"""Edge lengths of the shifts along the main directions; edge lengths and degrees of the others (numerical: well beyond
what an alignment corrects, well within the size of a thing)."""

SHIFTS, OTHERS = 6, 6
"""Decoys of a pose of either kind; counts."""


def slipped(poses, points, tangents, weight=None):
    """(k, 2, 4, 4), poses (k, 4, 4) moved either way along the screw motion that keeps the curves on themselves best.

    points, tangents : (m, 3) or (k, m, 3), of the curves in the frame that the poses move; weight : (k, m), how much
        each counts; None takes all alike

    Notes
    -----
    A line, a circle and a helix slip along themselves: where one of them is seen, it is seen at every other place of
    the same curve (slippable motions: Gelfand and Guibas 2004). The least speed across the curves for the speed at all
    is an eigenvalue of 6 x 6 matrices.
    """
    points, tangents = np.atleast_3d(points.T).T, np.atleast_3d(tangents.T).T  # (1, m, 3) of one for all
    weight = np.ones(points.shape[:2]) if weight is None else weight.astype(float)
    count = np.maximum(weight.sum(axis=1), 1e-3)[:, None]
    centre = np.einsum("km,kmi->ki", weight, points) / count
    off = points - centre[:, None]
    size = np.maximum(np.sqrt(np.einsum("km,kmi,kmi->k", weight, off, off) / count[:, 0]), 1e-9)[:, None]
    # Rows of the velocity and of its part across the curve, for a turn about each axis and a shift along it.
    unit = off / size[:, None]
    speed = np.concatenate([-skew(unit.reshape(-1, 3)).reshape(*unit.shape, 3), np.zeros((*unit.shape, 3))], axis=-1)
    speed[..., 3:] = np.eye(3)
    along = np.einsum("kmi,kmij->kmj", tangents, speed)
    rows = (speed * weight[..., None, None]).reshape(len(unit), -1, 6)
    total = np.swapaxes(rows, 1, 2) @ speed.reshape(len(unit), -1, 6)
    across = total - np.swapaxes(along * weight[..., None], 1, 2) @ along
    total = total + 1e-3 * count[..., None] * np.eye(6)
    root = np.linalg.inv(np.linalg.cholesky(total))
    way = (np.swapaxes(root, 1, 2) @ np.linalg.eigh(root @ across @ np.swapaxes(root, 1, 2))[1][..., :1])[..., 0]
    way *= SHIFT / np.sqrt(np.einsum("ki,kij,kj->k", way, total, way)[:, None] / count)
    w, u = way[:, :3] / size, way[:, 3:]
    u = u - np.cross(w, centre)
    slips = np.stack([moment(w, u), moment(-w, -u)], axis=1)
    return poses[:, None] @ slips


def decoys(poses, centre, tangents, *, seed=0):
    """(k, 12, 4, 4), decoys of poses (k, 4, 4): shifts first.

    centre : (3,) or (k, 3), the middle of what is posed; tangents : (m, 3) or (k, m, 3), its directions; both in the
        frame that the poses move
    """
    rng = np.random.default_rng(seed)
    k = len(poses)
    axes = np.linalg.eigh(np.swapaxes(tangents, -1, -2) @ tangents)[1]
    axes = np.broadcast_to(poses[:, :3, :3] @ axes, (k, 3, 3))
    out = np.repeat(poses[:, None], SHIFTS + OTHERS, axis=1)
    for a in range(3):
        out[:, 2 * a, :3, 3] -= SHIFT * axes[:, :, a]
        out[:, 2 * a + 1, :3, 3] += SHIFT * axes[:, :, a]
    # The same turns and shifts for every pose: scores of poses are compared with each other.
    turn = rng.normal(size=(OTHERS, 3))
    turn *= np.radians(rng.uniform(*TURN, size=(OTHERS, 1))) / np.linalg.norm(turn, axis=1, keepdims=True)
    way = rng.normal(size=(OTHERS, 3))
    way *= rng.uniform(*AWAY, size=(OTHERS, 1)) / np.linalg.norm(way, axis=1, keepdims=True)
    middle = np.einsum("kij,kj->ki", poses[:, :3, :3], np.broadcast_to(centre, (k, 3))) + poses[:, :3, 3]
    r = turned(turn)
    off = motion(np.broadcast_to(r, (k, OTHERS, 3, 3)), middle[:, None] - np.einsum("oij,kj->koi", r, middle) + way)
    out[:, SHIFTS:] = off @ poses[:, None]
    return out
