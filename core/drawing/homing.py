# SPDX-License-Identifier: GPL-3.0-or-later
"""The place of a curve among its images under the motions from pose to pose.

Where poses stand in a row, a curve of a thing and the same curve of its neighbour are each other's image, and either
may be traced. The one that belongs to the thing is seen at all its poses; the neighbour's is missing at the border.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import apply, inverse
from .evidence import log_odds, seen_by, sightings
from .overlay import Overlay

BETTER = 1.0
"""Tolerance: poses more that must show an image which takes the place of a curve."""


def at_home(curves, motions, overlay: Overlay, core, q, *, p, least, reach, near, radius):
    """The curves, each at the best of its places.

    Parameters
    ----------
    motions : (m, 4, 4) float64, from poses to their neighbours, in the thing's frame
    core : (n, 3) float64, points of the thing; reach : edge lengths from it within which an image may lie
    q : (c,) float64, chance to be seen; p : share of a curve that a pose shows
    least : nats by which an image must be better; near : poses that it must be better for each size of the thing that
        it lies further away
    """
    if not curves or not len(motions):
        return curves
    low, high = core.min(axis=0) - reach, core.max(axis=0) + reach
    ends = np.cumsum([0, *map(len, curves)])
    points = np.concatenate(curves)
    images, owner = list(curves), list(range(len(curves)))
    for g in np.concatenate([motions, inverse(motions)]):
        moved = apply(g, points)
        outside = np.add.reduceat(((moved < low) | (moved > high)).any(axis=1), ends[:-1], dtype=int)
        for c in np.flatnonzero(outside == 0):
            images.append(moved[ends[c] : ends[c + 1]])
            owner.append(int(c))
    owner = np.array(owner)
    found = sightings(images, overlay, radius=radius)
    seen = seen_by(found, overlay)
    tree, size = cKDTree(core), max(np.linalg.norm(core.std(axis=0)), 10.0)
    nats, poses = np.zeros(len(images)), np.zeros(len(images))
    for i, image in enumerate(images):
        here = seen[:, found.offsets[i] : found.offsets[i + 1]]
        nats[i] = log_odds(here, p, q[owner[i]]).sum()
        poses[i] = np.clip(here.mean(axis=1) / p, 0, 1).sum() - near * np.median(tree.query(image)[0]) / size
    out = []
    for c in range(len(curves)):
        mine = np.flatnonzero(owner == c)
        best = mine[np.argmax(poses[mine])]
        better = poses[best] > poses[c] + BETTER and nats[best] > nats[c] + least
        out.append(images[best] if better else curves[c])
    return out
