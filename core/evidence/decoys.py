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


def slipped(poses, points, tangents):
    """(k, 2, 4, 4), poses (k, 4, 4) moved either way along the screw motion that keeps the curves on themselves best.

    points, tangents : (m, 3), of the curves in the frame that the poses move

    Notes
    -----
    A line, a circle and a helix slip along themselves: where one of them is seen, it is seen at every other place of
    the same curve (slippable motions: Gelfand and Guibas 2004). The least speed across the curves for the speed at all
    is an eigenvalue of 6 x 6 matrices.
    """
    centre = points.mean(axis=0)
    off = points - centre
    size = max(np.sqrt((off**2).sum(axis=1).mean()), 1e-9)
    speed = np.concatenate([-skew(off / size), np.broadcast_to(np.eye(3), (len(off), 3, 3))], axis=2)
    across = speed - tangents[:, :, None] * np.einsum("mi,mij->mj", tangents, speed)[:, None]
    total = np.einsum("mij,mik->jk", speed, speed) + 1e-3 * len(off) * np.eye(6)
    root = np.linalg.inv(np.linalg.cholesky(total))
    values, ways = np.linalg.eigh(root @ np.einsum("mij,mik->jk", across, across) @ root.T)
    way = root.T @ ways[:, 0]
    way *= SHIFT / np.sqrt(way @ total @ way / len(off))
    # About the centre of the points.
    w = way[:3] / size
    u = way[3:] - np.cross(w, centre)
    slips = moment(np.stack([w, -w]), np.stack([u, -u]))
    return poses[:, None] @ slips[None]


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
