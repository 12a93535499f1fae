# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that do not recur and are kept (section 5.1): pieces that carry each other on over gaps are one curve."""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from ..network.network import CurveNetwork
from .chains import best_stretches, chains_of
from .clutter import departures, fit_mixture
from .continuation import continuation, matched
from .drawing import SingleCurve, drawn, joined
from .ends import ends_of
from .pieces import pieces_of

STEP = (3, 8)
"""Least and largest number of samples of the steps by which pieces are judged."""
LEAST_NOISE, LEAST_TURN = 0.02, 1e-4
"""Tolerances: edge lengths, and squared radians a step, below which nothing is told apart."""


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
    sure = np.r_[mixture.log_odds, np.full(len(known), np.inf)]
    noise, turning = ways_of_curves([*pieces, *known], sure, step, mixture.noise)
    least = float(np.log(parameters.keep_odds))
    result = [
        drawn([p], p.points, True, odds, noise=noise)
        for p, odds in zip(pieces, mixture.log_odds)
        if p.closed and odds > least
    ]
    parts = [i for i, p in enumerate(pieces) if not p.closed]
    odds, parts = mixture.log_odds[parts], [pieces[i] for i in parts]
    if not parts:
        return result
    how = {"noise": noise, "turning": turning, "gap": max(parameters.link_gap, 1.0)}
    ends = ends_of(parts, **how)
    tick()
    pair, gain = continuation(network, parts, ends, expit(odds), **how)
    partner, worth = matched(pair, gain, np.minimum(np.repeat(odds, 2), 0), 2 * len(parts))
    tick()
    for chain, ring in chains_of(partner):
        for run, closed, total in best_stretches(chain, ring, odds, worth, least):
            result.append(joined(parts, ends, run, closed, total, noise=noise))
    return result


def ways_of_curves(pieces, odds, step, departing):
    """Noise of each coordinate (edge lengths), and the usual curvature (1 / edge length), where curves are.

    odds : (p,) float64, of each piece to be a curve; departing : radians, spread of departures along curves

    Notes
    -----
    A departure is a third difference of places one step apart, with 20 times the variance of one place; a turning a
    second difference, with 6 times.
    """
    noise = max(departing * step / np.sqrt(20), LEAST_NOISE)
    turns = [np.linalg.norm(departures(p.points, p.closed, step)[0], axis=1) for p, o in zip(pieces, odds) if o > 0]
    turns = np.concatenate([*turns, []])
    usual = float(np.median(turns)) if len(turns) else 0.0
    # The median length of a vector across a line is 1.18 times the spread of its coordinates.
    by_noise = 1.18 * np.sqrt(6) * noise / step
    return noise, np.sqrt(max(usual**2 - by_noise**2, 0.25 * usual**2, LEAST_TURN)) / step
