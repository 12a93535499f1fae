# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature BLAST (section 4.1.1, Algorithm 1): partial matches between the strong curves.

Neighbouring matches of windows on one diagonal (both points one sample further) are one match seen again: such a run
is aligned as a whole and then extended by delta_l at both ends while its distance is below t.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from ..network.network import CurveNetwork
from .extension import Stretches
from .windows import Tracks, agreeing_windows


@dataclass(frozen=True)
class Matches:
    """Stretches of two curves that agree under a rigid motion; lengths in edge lengths.

    curve : (k, 2) int64, the curve that is moved and the curve it is moved onto
    start : (k, 2) int64, first sample of the stretch on each, counted on the curve
    direction : (k,) int64, 1 or -1, the sense in which the second curve is run through
    count : (k,) int64, samples of the stretch
    distance : (k,) float64, RMS distance after the best motion
    affinity : (k,) float64, l exp(-d / (0.5 t))
    stiffness : (k,) float64 in 0..1, how well the stretch fixes the rotation: 0 for a straight one
    motions : (k, 4, 4) float64, in the network's frame
    point_pairs : int, pairs of points of two different curves that were compared, both directions
    """

    curve: np.ndarray
    start: np.ndarray
    direction: np.ndarray
    count: np.ndarray
    distance: np.ndarray
    affinity: np.ndarray
    stiffness: np.ndarray
    motions: np.ndarray
    point_pairs: int

    def __len__(self):
        return len(self.count)


def feature_blast(network: CurveNetwork, strong, *, l0, s, t, delta_l, block=1 << 20, threads=1, progress=None):
    """Matches between all pairs of strong curves, a curve with itself included.

    Parameters
    ----------
    strong : (k,) int64, indices of the curves that take part
    l0, s, t, delta_l : edge lengths, as in Algorithm 1
    block : pairs of points handled at a time by each thread

    Notes
    -----
    O(n^2 l0) operations in the strong samples n as matrix products, O(n * block / n + matches) memory.
    """
    size = max(3, int(round(l0)))
    step = max(1, int(round(delta_l)))
    tracks = Tracks(network, strong, size)
    if not len(tracks.start):
        return _no_matches()
    runs = agreeing_windows(tracks, s, block, threads, progress)
    size = max(1, block // RUN)
    parts = [runs[i : i + size] for i in range(0, len(runs), size)]
    if not parts:
        return replace(_no_matches(), point_pairs=tracks.point_pairs())
    found = []
    for k, part in enumerate(parts):
        report = progress and (lambda stage, f, k=k: progress(stage, 0.8 + 0.2 * (k + f) / len(parts)))
        found.append(_extend(tracks, part, t, step, report))
    return _joined(found)


RUN = 8
"""Pairs of points that a run counts for in the block size: it takes more memory while it is extended."""


def _joined(parts):
    """Matches one after the other; all have seen the same pairs of points."""
    if len(parts) == 1:
        return parts[0]
    names = [f.name for f in fields(Matches) if f.name != "point_pairs"]
    return Matches(*(np.concatenate([getattr(p, n) for p in parts]) for n in names), point_pairs=parts[0].point_pairs)


def _no_matches():
    i, f = np.zeros(0, np.int64), np.zeros(0)
    two = np.zeros((0, 2), np.int64)
    return Matches(two, two, i, i, f, f, f, np.zeros((0, 4, 4)), 0)


def _extend(tracks, runs, t, step, progress):
    """Align each run as a whole, extend it by `step` at both ends while its distance is below t, and rate it."""
    direction, i, j, length = runs.T
    window = np.where(direction > 0, j, len(tracks.start) - 1 - j)
    a, b = tracks.curve[i], tracks.curve[window]
    count = np.minimum(length + tracks.size - 1, np.minimum(tracks.counts[a], tracks.counts[b]))
    start_a, start_b = tracks.start[i], tracks.start[window] + np.where(direction > 0, 0, tracks.size - 1)
    stretches = Stretches(tracks, a, b, start_a, start_b, direction, count)
    # A run that bends differently as a whole goes back to its middle window.
    loose = np.flatnonzero((stretches.distance() >= t) & (count > tracks.size))
    back = (count[loose] - tracks.size) // 2
    stretches.restart(loose, start_a[loose] + back, start_b[loose] + direction[loose] * back, tracks.size)
    active, rounds = np.arange(len(count)), 0
    while len(active):
        active, rounds = stretches.grow(active, step, t), rounds + 1
        if progress:
            progress("blast", 1 - 1 / (1 + 0.2 * rounds))
    good = np.flatnonzero(stretches.distance() < t)
    distance, motions, stiffness = stretches.distance()[good], *stretches.motions(good)
    affinity = stretches.count[good] * np.exp(-distance / (0.5 * t))
    start_a, start_b = tracks.wrap(a, stretches.start_a), tracks.wrap(b, stretches.start_b)
    return Matches(
        np.stack([tracks.curves[a], tracks.curves[b]], axis=1)[good],
        np.stack([start_a, start_b], axis=1)[good],
        direction[good], stretches.count[good], distance, affinity, stiffness, motions, tracks.point_pairs(),
    )  # fmt: skip
