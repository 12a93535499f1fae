# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that do not recur and are kept (section 5.1): pieces that carry each other on over gaps are one curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from ..network import CurveNetwork, resample_polyline, steady_polyline
from .chains import best_stretches, chains_of
from .clutter import departures, fit_mixture
from .continuation import bridge, continuation, matched
from .ends import ends_of
from .pieces import pieces_of

STEP = (3, 8)
"""Least and largest number of samples of the steps by which pieces are judged."""


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


def single_curves(network: CurveNetwork, free, parameters, *, tick=None) -> list[SingleCurve]:
    """Curves that templates and courses leave and that are no clutter.

    Parameters
    ----------
    free : (n,) bool, samples that no template or course explains
    parameters : Parameters, of which smoothing, link_gap and keep_odds are taken
    tick : called between steps; may raise Cancelled

    Notes
    -----
    Each piece has log odds against clutter, each pair of ends log odds that a curve goes on between them; a chain is
    worth their sum. O(n log n) in the number of samples.
    """
    tick = tick or (lambda: None)
    step = int(np.clip(round(4 * parameters.smoothing / 3), *STEP))
    pieces, known = pieces_of(network, free)
    if not pieces:
        return []
    strength = network.strength[[p.curve for p in [*pieces, *known]]]
    tick()
    mixture = fit_mixture(pieces, known, step=step, strength=strength)
    tick()
    least = float(np.log(parameters.keep_odds))
    whole = [i for i, p in enumerate(pieces) if p.closed]
    result = [_drawn(network, [pieces[i]], [], True, mixture.log_odds[i]) for i in whole if mixture.log_odds[i] > least]
    parts = [i for i, p in enumerate(pieces) if not p.closed]
    odds, parts = mixture.log_odds[parts], [pieces[i] for i in parts]
    if not parts:
        return result
    noise, turning = _ways_of_curves([*pieces, *known], np.r_[mixture.log_odds, np.full(len(known), 9.0)], step, mixture)
    how = {"noise": noise, "turning": turning, "gap": max(parameters.link_gap, 1.0)}
    ends = ends_of(parts, **how)
    tick()
    pair, gain = continuation(network, parts, ends, expit(odds), **how)
    partner, worth = matched(pair, gain, np.minimum(np.repeat(odds, 2), 0), 2 * len(parts))
    tick()
    for chain, ring in chains_of(partner):
        for run, closed, total in best_stretches(chain, ring, odds, worth, least):
            result.append(_joined(network, parts, ends, run, closed, total))
    return result


def _ways_of_curves(pieces, odds, step, mixture):
    """Noise of each coordinate (edge lengths), and the usual curvature (1 / edge length), where curves are.

    A departure is a third difference of places one step apart, with 20 times the variance of one place; a turning a
    second difference, with 6 times.
    """
    noise = max(mixture.noise * step / np.sqrt(20), 0.02)
    turns = [np.linalg.norm(departures(p.points, p.closed, step)[0], axis=1) for p, o in zip(pieces, odds) if o > 0]
    turns = np.concatenate([*turns, []])
    usual = float(np.median(turns)) if len(turns) else 0.0
    by_noise = 1.18 * np.sqrt(6) * noise / step
    return noise, np.sqrt(max(usual**2 - by_noise**2, 0.25 * usual**2, 1e-4)) / step


def _joined(network, pieces, ends, run, closed, odds):
    """The curve of pieces that are entered through the ends `run`, one after the other."""
    own = [pieces[e // 2] for e in run]
    lines = [p.points if e % 2 == 0 else p.points[::-1] for p, e in zip(own, run)]
    follow = run[1:] + (run[:1] if closed else [])
    gaps = []
    for a, b in zip([e ^ 1 for e in run], follow):
        size = np.linalg.norm(ends.tip[b] - ends.tip[a])
        t = np.arange(1, int(np.rint(size))) / max(np.rint(size), 1)
        gaps.append(bridge(ends, np.full(len(t), a), np.full(len(t), b), t)[0])
    return _drawn(network, own, [x for pair in zip(lines, [*gaps, []]) for x in pair if len(x)], closed, odds)


def _drawn(network, pieces, lines, closed, odds):
    line = np.concatenate(lines or [p.points for p in pieces])
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum() + closed * np.linalg.norm(line[-1] - line[0])
    shown = min(1.0, sum(p.length for p in pieces) / max(length, 1e-9))
    if lines:
        line = resample_polyline(line, 1.0, closed)
    members = np.array([p.curve for p in pieces], np.int64)
    return SingleCurve(steady_polyline(line, closed), bool(closed), members, float(shown), float(odds))
