# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of a thing joined where they continue each other, and carried on along what single poses show.

Of two or three poses each shows what the others miss. A stretch that only one of them shows is no candidate by itself;
as the continuation of a curve of the thing it is one, and evidence decides whether the others would have shown it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..consolidation.joining import linked_paths
from ..consolidation.passages import find_passages
from ..geometry.motions import apply
from ..geometry.polylines import resample_polyline, smooth_polyline
from .choosing import SHORTEST, Chosen
from .evidence import Sightings
from .overlay import Overlay

MEETING, AROUND = 3.0, 20
"""Tolerances: edge lengths between the ends of a curve that is a ring, and points that a ring has at least."""

TWICE, MOSTLY = 1.5, 0.8
"""Tolerances: edge lengths from another curve within which the same curve is drawn twice, and the share of it that must
lie there."""

GAP, FEW = 14.0, 5
"""Tolerance: longest gap that is joined before evidence is asked; bound on the work: poses of a thing up to which
single ones carry a curve on."""


def continued(chosen: Chosen, found: Sightings, overlay: Overlay) -> Chosen:
    """The curves, those at the same poses joined with each other and with runs of samples that continue them; round a
    corner where curves of the input lead round it.

    found : sightings of the curves in the overlay
    """
    explained = explained_items(chosen, found, overlay)
    out = []
    sets, which = np.unique(chosen.sets, axis=0, return_inverse=True)
    for k, mine in enumerate(sets):
        own = np.flatnonzero(which.ravel() == k)
        rings = [i for i in own if chosen.closed[i]]
        open_ = [i for i in own if not chosen.closed[i]]
        out += [(chosen.curves[i], True, mine, chosen.scores[i]) for i in rings]
        paths = [chosen.curves[i] for i in open_]
        runs = free_runs(overlay, ~explained) if len(mine) <= FEW and mine.all() else []
        around = overlay.part(mine[overlay.cell])
        passed = find_passages(paths, around.points, around.tangents, around.run).pairs
        for line, ring, members in linked_paths([*paths, *runs], gap=GAP, passed=passed):
            old = [m for m in members if m < len(paths)]
            if old:
                if len(members) > 1 or ring:
                    line = smooth_polyline(resample_polyline(line, 1.0, ring), 1.0, ring)
                out.append((line, bool(ring), mine, sum(chosen.scores[open_[m]] for m in old)))
    curves, closed, sets, scores = zip(*out)
    return Chosen(list(curves), list(closed), np.array(sets), np.array(scores))


def closed_up(chosen: Chosen) -> Chosen:
    """The curves, those whose two ends meet as rings."""
    rings = [
        bool(ring) or (len(c) > AROUND and np.linalg.norm(c[0] - c[-1]) < MEETING)
        for c, ring in zip(chosen.curves, chosen.closed)
    ]
    return replace(chosen, closed=rings)


def drawn_once(chosen: Chosen, poses, shown) -> Chosen:
    """The curves without those that lie on longer ones, at the same poses or at others: the sill of the next storey.

    poses : (k, 4, 4); shown : (k, c) float64, share of each curve that each pose shows
    """
    order = sorted(range(len(chosen.curves)), key=lambda i: (-len(chosen.curves[i]), i))
    kept, placed = [], np.zeros((0, 3))
    for i in order:
        curve, mine = chosen.curves[i], np.flatnonzero(chosen.sets[i])
        if len(placed):
            seen = mine[shown[mine, i] >= 0.5 * shown[mine, i].max(initial=0)]
            gap = cKDTree(placed).query(apply(poses[seen], curve), distance_upper_bound=TWICE)[0]
            if 2 * (np.isfinite(gap).mean(axis=1) > MOSTLY).sum() >= len(seen):
                continue
        kept.append(i)
        placed = np.concatenate([placed, apply(poses[mine], curve).reshape(-1, 3)])
    return chosen.part(sorted(kept))


def explained_items(chosen, found, overlay):
    """(n,) bool, samples of the overlay that lie along a curve at one of its poses, under whichever pose."""
    curve = np.repeat(np.arange(len(chosen.curves)), np.diff(found.offsets))
    at = chosen.sets[curve[found.point], overlay.cell[found.item]]
    seen = np.zeros(int(overlay.sample.max(initial=-1)) + 1, bool)
    seen[overlay.sample[found.item[at]]] = True
    return seen[overlay.sample]


def free_runs(overlay, free):
    """Stretches (k, 3) of consecutive free samples, long enough to be a curve."""
    at = np.flatnonzero(free)
    cut = np.flatnonzero((np.diff(at) != 1) | (np.diff(overlay.run[at]) != 0)) + 1
    return [overlay.points[part] for part in np.split(at, cut) if len(part) >= SHORTEST]
