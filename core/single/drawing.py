# SPDX-License-Identifier: GPL-3.0-or-later
"""How a curve that is seen once is drawn: its pieces over their gaps, steadied as far as noise goes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from ..geometry.polylines import resample_polyline, smooth_polyline
from .continuation import bridge
from .ends import Ends

FIRST, WIDEST, MOVED = 3.0, 24.0, 5.0
"""First and widest standard deviation of the smoothing (samples), and how far it may move a place: in multiples of
the noise, whose slow part is that much larger than what departures from a smooth curve show."""


@dataclass(frozen=True)
class SingleCurve:
    """One curve that is kept although it does not recur.

    points : (k, 3) float64, about one edge apart, in the network's frame; closed : bool
    members : (j,) int64, curves of the network that it is made of, in its order
    support : share of its length that the network shows; log_odds : that it is a curve and no clutter
    """

    points: np.ndarray
    closed: bool
    members: np.ndarray
    support: float
    log_odds: float


def joined(pieces, ends: Ends, run, closed, odds, *, noise) -> SingleCurve:
    """The curve of the pieces that are entered through the ends `run`, one after the other.

    pieces : list of open `Piece`; noise : edge lengths, standard deviation about a smooth curve
    """
    parts = []
    for k, entry in enumerate(run):
        own = pieces[entry // 2].points
        parts.append(own if entry % 2 == 0 else own[::-1])
        if k + 1 < len(run) or closed:
            leave, follow = entry ^ 1, run[(k + 1) % len(run)]
            steps = int(np.rint(np.linalg.norm(ends.tip[follow] - ends.tip[leave])))
            t = np.arange(1, steps) / max(steps, 1)
            parts.append(bridge(ends, np.full(len(t), leave), np.full(len(t), follow), t)[0])
    return drawn([pieces[e // 2] for e in run], np.concatenate(parts), closed, odds, noise=noise)


def drawn(pieces, line, closed, odds, *, noise) -> SingleCurve:
    """The curve of a line (k, 3) that runs through pieces."""
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum() + closed * np.linalg.norm(line[-1] - line[0])
    shown = min(1.0, sum(p.length for p in pieces) / max(length, 1e-9))
    if len(pieces) > 1:
        line = resample_polyline(line, 1.0, closed)
    members = np.array([p.curve for p in pieces], np.int64)
    return SingleCurve(steadied(line, closed, MOVED * noise), bool(closed), members, float(shown), float(odds))


def steadied(points, closed, most):
    """(k, 3) float64, a line smoothed over 3, 6, 12, ... samples, each place as widely as it moves by at most `most`.

    How far a stretch moves is a root mean square over the width of the smoothing. Noise does not need more, a corner
    does: it stays as it is, and what lies between corners is smoothed all the same.
    """
    out, sigma, still = points, FIRST, np.ones(len(points), bool)
    around = "wrap" if closed else "nearest"
    while sigma <= min(WIDEST, len(points) / 3):
        line = smooth_polyline(points, sigma, closed, order=3)
        square = gaussian_filter1d(((line - points) ** 2).sum(axis=1), sigma, mode=around)
        still = minimum_filter1d(still & (square <= most**2), int(2 * sigma) | 1, mode=around)
        if not still.any():
            break
        share = np.clip(gaussian_filter1d(still.astype(float), sigma / 2, mode=around), 0, 1)[:, None]
        out, sigma = (1 - share) * out + share * line, 2 * sigma
    return out
