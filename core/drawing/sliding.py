# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that the motions from pose to pose take along themselves: a cornice, a rail, a ring about the axis.

Such a curve recurs with itself only. In one pose it is a piece of no meaning, so it is no curve of a template.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.polylines import directions
from ..geometry.motions import apply, inverse, screw_velocity

NEIGHBOURS, SAME, MOVED, TOUCH, MOSTLY, STRAIGHT = 6, 5.0, 4.0, 3.0, 0.7, 0.97
"""Tolerances: poses around each to which motions are looked at, edge lengths (RMS) within which two motions are one,
those that a motion must move a point, those within which a curve and its image touch, share of a curve that slides, and
cosine of its tangent and its way."""


def relative_motions(poses, points):
    """(m, 4, 4) float64, motions in the thing's frame from poses to their neighbours, one of each kind.

    points : (n, 3) float64, of the thing; of a motion and its inverse one is left
    """
    middle = points.mean(axis=0)
    at = apply(poses, middle[None])[:, 0]
    near = cKDTree(at).query(at, k=min(NEIGHBOURS + 1, len(at)))[1].reshape(len(at), -1)[:, 1:]
    a = np.repeat(np.arange(len(at)), near.shape[1])
    motions = inverse(poses[a]) @ poses[near.ravel()]
    motions = motions[np.linalg.det(motions[:, :3, :3]) > 0]
    size = points.std(axis=0).max()
    probe = middle + size * np.concatenate([np.eye(3), -np.eye(3)])
    out, seen = [], np.zeros((0, 6, 3))
    for g in motions:
        image = apply(g, probe)
        if len(seen) and np.sqrt(((seen - image) ** 2).sum(-1).mean(-1)).min() < SAME:
            continue
        out.append(g)
        seen = np.concatenate([seen, image[None], apply(inverse(g), probe)[None]])
    return np.array(out).reshape(-1, 4, 4)


def slides(curves, motions, *, radius):
    """(c,) bool, curves that one of the motions takes along themselves and whose image overlaps or touches them."""
    out = np.zeros(len(curves), bool)
    if not len(motions):
        return out
    w, u = screw_velocity(motions)
    for c, curve in enumerate(curves):
        way, tree = directions(curve), cKDTree(curve)
        image = apply(motions, curve)
        far = np.linalg.norm(image - curve, axis=2) > MOVED
        distance, near = tree.query(image, distance_upper_bound=radius)
        found = np.isfinite(distance)
        turned = way @ np.swapaxes(motions[:, :3, :3], 1, 2)
        on = found & far & (np.abs((way[np.where(found, near, 0)] * turned).sum(-1)) > 0.9)
        velocity = np.cross(w[:, None], curve) + u[:, None]
        speed = np.maximum(np.linalg.norm(velocity, axis=2), 1e-12)
        along = far & (np.abs((velocity * way).sum(-1)) > STRAIGHT * speed)
        touches = np.isfinite(tree.query(image, distance_upper_bound=TOUCH)[0]).any(axis=1)
        out[c] = (on.mean(axis=1) > MOSTLY).any() or ((along.mean(axis=1) > MOSTLY) & touches).any()
    return out
