# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that the motions from pose to pose take along themselves: a cornice, a rail, a ring about the axis.

Such a curve recurs with itself only. In one pose it is a piece of no meaning, so it is no curve of a template.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import apply, exponential, inverse, screw_velocity
from ..geometry.polylines import directions, resample_polyline
from .evidence import seen_by, sightings
from .overlay import Overlay

NEIGHBOURS, SAME, MOVED, MOSTLY, STRAIGHT = 6, 5.0, 4.0, 0.7, 0.97
"""Tolerances: poses around each to which motions are looked at, edge lengths (RMS) within which two motions are one,
those that a motion must move a point, share of a curve that slides, and cosine of its tangent and its way."""

RUNS_ON = 0.33
"""Share of what is shown of a curve that must be shown of the way to its image for both to be one: about where the odds
of seen against chance are even."""


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


def slides(curves, motions, overlay: Overlay, *, radius):
    """(c,) bool, curves that run on through the poses.

    One that lies on its own image does, as a ring about the axis. One that runs along the way of a motion does where
    the poses show the way between the curve and its image about as well as the curve: a cornice, not a row of sills.

    motions : (m, 4, 4) float64, from poses to their neighbours; overlay : all that lies around the poses
    """
    out = np.zeros(len(curves), bool)
    if not len(motions) or not curves:
        return out
    w, u = screw_velocity(motions)
    ways, owner = [], []
    for c, curve in enumerate(curves):
        way, tree = directions(curve), cKDTree(curve)
        image = apply(motions, curve)
        far = np.linalg.norm(image - curve, axis=2)
        distance, near = tree.query(image, distance_upper_bound=radius)
        found = np.isfinite(distance)
        turned = way @ np.swapaxes(motions[:, :3, :3], 1, 2)
        on = found & (far > MOVED) & (np.abs((way[np.where(found, near, 0)] * turned).sum(-1)) > 0.9)
        velocity = np.cross(w[:, None], curve) + u[:, None]
        speed = np.maximum(np.linalg.norm(velocity, axis=2), 1e-12)
        along = (far > MOVED) & (np.abs((velocity * way).sum(-1)) > STRAIGHT * speed)
        out[c] = (on.mean(axis=1) > MOSTLY).any()
        goes = np.flatnonzero(along.mean(axis=1) > MOSTLY)
        if out[c] or not len(goes):
            continue
        k = goes[np.argmin(far[goes].mean(axis=1))]
        gap = _between(curve, tree, image[k], np.concatenate([w[k], u[k]]), radius)
        if len(gap) < 3:
            out[c] = True
        else:
            ways.append(gap)
            owner.append(c)
    if ways:
        shown = [
            seen_by(sightings(lines, overlay, radius=radius), overlay) for lines in ([curves[c] for c in owner], ways)
        ]
        ends = [np.cumsum([0, *map(len, lines)]) for lines in ([curves[c] for c in owner], ways)]
        for k, c in enumerate(owner):
            here, gap = (s[:, e[k] : e[k + 1]].mean(axis=1) for s, e in zip(shown, ends))
            mine = here >= 0.5 * here.max()
            out[c] = gap[mine].mean() >= RUNS_ON * here[mine].mean()
    return out


def _between(curve, tree, image, twist, radius):
    """Points (k, 3) about one edge length apart on the way of the curve's middle to its image, without what lies
    beside either."""
    middle = curve[len(curve) // 2]
    steps = exponential(np.linspace(0, 1, 200)[:, None] * twist)
    way = resample_polyline(apply(steps, middle[None])[:, 0], 1.0, False)
    free = ~np.isfinite(tree.query(way, distance_upper_bound=radius)[0])
    free &= ~np.isfinite(cKDTree(image).query(way, distance_upper_bound=radius)[0])
    return way[free]
