# SPDX-License-Identifier: GPL-3.0-or-later
"""Straight lines tell little: all of one together as much as a short stretch of it, wherever its pieces lie."""

from __future__ import annotations

import numpy as np

STRAIGHT = 25.0
"""Edge lengths of a straight line that tell all there is to tell of it, wherever its pieces lie: lines are many, and
those that meet at right angles, too."""

FITTED, OFF, BENT, ALONG = 20.0, 2.0, 0.04, 0.85
"""Edge lengths over which the direction of a line is fitted, edge lengths off it and share of the way along it by which
a point of it may be off, and least cosine of their directions; tolerances."""


def lines_once(points, tangents, counted, spacing=2.0):
    """(m,) float64, how much each point tells: along one straight line all together as much as `STRAIGHT` of it.

    points, tangents : (m, 3); counted : (m,) bool, points that are counted along a line
    spacing : edge lengths of curve that each point stands for
    """
    points = points - points.mean(axis=0)
    at, line = points[counted], tangents
    square = (points**2).sum(axis=1)[:, None] + (at**2).sum(axis=1)[None] - 2 * points @ at.T
    moments = (at[:, :, None] * at[:, None, :]).reshape(-1, 9)
    for reach in (FITTED, np.inf):
        along = line @ at.T - (line * points).sum(axis=1)[:, None]
        off = np.sqrt(np.maximum(square - along**2, 0))
        same = (off < OFF + BENT * np.abs(along)) & (np.abs(line @ tangents[counted].T) > ALONG)
        same &= np.abs(along) < reach
        if reach == FITTED:
            # Tangents are noisy: the line is that of the points around, whose moments about each point are those about
            # the middle of all, moved.
            weight = same.astype(float)
            first = (weight @ at)[:, :, None] * points[:, None, :]
            scatter = (weight @ moments).reshape(-1, 3, 3) - first - np.swapaxes(first, 1, 2)
            scatter += weight.sum(axis=1)[:, None, None] * (points[:, :, None] * points[:, None, :])
            line = np.linalg.eigh(scatter + line[:, :, None] * line[:, None, :])[1][:, :, 2]
    return np.minimum(1.0, STRAIGHT / (spacing * np.maximum(same.sum(axis=1), 1)))
