# SPDX-License-Identifier: GPL-3.0-or-later
"""Consolidation (section 5.2): from overlaid occurrences to one clean curve where the object has one.

The paper selects one of the occurrences by shortest paths. Here the occurrences are first averaged, being
repeated measurements of one curve; the longest shortest paths then run through the averages.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.polylines import resample_polyline, smooth_polyline
from .averaging import settle
from .joining import bend_of_ends, continuations, join_paths, split_at_corners
from .passages import find_passages, part_shared, split_where_none_pass

SHORTEST = 5.0
"""Shortest curve that is kept, edge lengths."""


def fit_curves(paths, points, tangents, weight, run, *, trails=None, radius=1.5, smoothing=1.0, tick=None):
    """Smooth curves along paths through the points, one edge length between their samples.

    run : (n,) int64, the same for points that follow each other on one input curve, which are in its order
    trails : points, tangents and runs of all input curves of the cell, which tell what continues what; None takes
        the points that the curves are fitted to

    Pieces that continue each other are joined first; a path whose ends meet is closed.
    Returns a list of (k, 3) points and a list of bool.
    """
    pieces = [piece for path in paths for piece in split_at_corners(_even(path))]
    trails = trails or (points, tangents, run)
    tick = tick or (lambda: None)
    tick()
    joined = _join_across(split_where_none_pass(pieces, *trails), trails)
    joined = [(p, ring) for p, ring in joined if np.linalg.norm(np.diff(p, axis=0), axis=1).sum() >= SHORTEST]
    closed = [ring for _, ring in joined]
    tick()
    lines = [smooth_polyline(resample_polyline(path, 1.0, ring), smoothing, ring) for path, ring in joined]
    return settle(lines, closed, points, tangents, weight, run, radius=radius, smoothing=smoothing, tick=tick), closed


def _join_across(pieces, trails, *, short=10.0, gap=14.0, cover=2.5):
    """Pieces joined; where curves cross or touch, arms are joined over the short piece that they share."""
    passages = find_passages(pieces, *trails)
    smooth = continuations(pieces)
    smooth = smooth[~passages.parted[smooth[:, 0], smooth[:, 1]]]
    pieces, forced = part_shared(pieces, passages, smooth, partial(bend_of_ends, pieces))
    size = np.array([np.linalg.norm(np.diff(p, axis=0), axis=1).sum() for p in pieces])
    tips = np.array([[p[0], p[-1]] for p in pieces]).reshape(-1, 3)
    pair = cKDTree(tips).query_pairs(5.0, output_type="ndarray").reshape(-1, 2)
    pair = pair[pair[:, 0] // 2 != pair[:, 1] // 2]
    meets = np.bincount(pair.ravel(), minlength=len(tips)).reshape(-1, 2)
    shared = (size < short) & (meets >= 2).all(axis=1)
    shared[forced.ravel() // 2] = False
    if not shared.any():
        return join_paths(pieces, passed=passages.pairs, parted=passages.parted, forced=forced)
    kept = np.flatnonzero(~shared)
    place = np.full(2 * len(pieces), -1)
    place[2 * kept], place[2 * kept + 1] = 2 * np.arange(len(kept)), 2 * np.arange(len(kept)) + 1
    long = [pieces[k] for k in kept]
    passages = find_passages(long, *trails)
    long = join_paths(long, gap=gap, passed=passages.pairs, parted=passages.parted, forced=place[forced])
    # A shared piece that no arm was joined over is a piece like any other.
    shown = cKDTree(np.concatenate([_dense(p, ring) for p, ring in long])) if long else None
    left = [p for p, s in zip(pieces, shared) if s and (shown is None or shown.query(p)[0].max() > cover)]
    open_ = [p for p, ring in long if not ring] + left
    passages = find_passages(open_, *trails)
    return join_paths(open_, passed=passages.pairs, parted=passages.parted) + [(p, ring) for p, ring in long if ring]


def _dense(path, ring):
    return resample_polyline(path, 1.0, ring)


def _even(path):
    """A path through nodes as a smooth line of samples one edge length apart."""
    return resample_polyline(smooth_polyline(resample_polyline(path, 1.0, False), 1.0, False), 1.0, False)
