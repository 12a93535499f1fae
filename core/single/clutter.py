# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve or clutter: log odds of each piece, against clutter as the scene itself has it.

A curve goes on as it did before, clutter turns at random. `departures` says by how much each step departs from what
the two steps before foretell. A mixture of two kinds of pieces is fitted to all pieces of the scene (EM): how much
they depart, how long they are and, where the input says so, how sharp. Nothing says how much clutter there is; a
scene without any has none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import expit, logit

ROUNDS, SETTLED = 200, 1e-6
"""Most rounds of EM, and the change of the probabilities at which it ends."""


@dataclass(frozen=True)
class Mixture:
    """What was fitted.

    log_odds : (p,) float64, of each free piece to be a curve and no clutter
    share : expected share of curves among the free pieces
    noise : radians, standard deviation of departures where curves run smoothly
    shares : (3,) float64, shares of the steps of a curve that run smoothly, bend, and turn a corner
    """

    log_odds: np.ndarray
    share: float
    noise: float
    shares: np.ndarray


def departures(points, closed, step):
    """Turning (m, 3) of unit steps and departures (m,) in radians, at all places of a piece.

    Three steps of `step` samples each follow each other. The third departs by its angle from the second one turned
    once more as the first was turned to the second: 0 on straight lines and circles.
    """
    k = len(points)
    line = points[np.arange(k + 3 * step) % k] if closed else points
    u = line[step:] - line[:-step]
    u = u / np.maximum(np.linalg.norm(u, axis=1), 1e-12)[:, None]
    first, second, third = u[: -2 * step], u[step:-step], u[2 * step :]
    foretold = 2 * (first * second).sum(1)[:, None] * second - first
    cosine = np.clip((foretold * third).sum(1), -1, 1)
    return third - second, np.arccos(cosine)


def fit_mixture(pieces, known, *, step, strength=None) -> Mixture:
    """Log odds of free pieces against clutter.

    Parameters
    ----------
    pieces, known : lists of `Piece`, free ones and such as are known to be curves
    step : samples of the steps by which departures are measured
    strength : (p + q,) float64 of pieces and known ones, NaN where unknown, or None

    Notes
    -----
    Linear in the number of samples. Steps overlap and noise is alike over about a step: a sample counts for half a
    step.
    """
    everything = [*pieces, *known]
    bends = Departures(everything, step)
    scalars = [Scalar(np.log([max(p.length, 1.0) for p in everything]), low=np.log(2.5 * step))]
    if strength is not None and np.isfinite(strength).any():
        scalars.append(Scalar(np.log(np.maximum(strength, 1e-9))))
    free = np.arange(len(everything)) < len(pieces)
    odds = bends.odds()
    belief = np.where(free, expit(odds), 1.0)
    # What is too short to depart is judged by what longer pieces say of lengths, and says nothing itself: it is as
    # likely the one as the other but for the calm of the scene.
    speaks = bends.speaks
    count, mute = (free & speaks).sum(), (free & ~speaks).sum() + PRIOR
    share = 0.5
    for _ in range(ROUNDS):
        # Clutter comes of the noise that makes curves jagged: where they run smoothly little of it is expected.
        calm = PRIOR * (bends.curve / (10 * LOOSE)) ** 1.5
        more = min(calm, CALM * count)
        share = (belief[free & speaks].sum() + PRIOR + more) / (count + 2 * PRIOR + more)
        bends.fit(belief)
        odds = np.where(speaks, logit(share), np.log1p(2 * min(calm, CALM * mute) / mute)) + bends.odds()
        for scalar in scalars:
            scalar.fit(belief, speaks)
            odds = odds + scalar.odds()
        new = np.where(free, expit(odds), 1.0)
        moved, belief = np.abs(new - belief).max(initial=0.0), new
        if moved < SETTLED:
            break
    return Mixture(odds[: len(pieces)], float(share), float(1 / np.sqrt(bends.curve)), bends.shares)


PRIOR, FIRM, LOOSE, SHARES = 2.0, 20.0, 2.0, np.array([0.75, 0.15, 0.1])
"""What is believed before anything is seen: pieces of each kind; how many half steps the beliefs about them weigh; the
concentration of clutter; and the shares of smooth, bent and turning steps of curves."""
ALIKE, CALM = 0.02, 30.0
"""Share of curves that are as clutter is in one respect, be it that they wind throughout or are short; and for how many
times the pieces of a scene its calmness may speak."""


def bounded(odds):
    """Log odds where a share `ALIKE` of curves is like clutter: no respect alone speaks without end against a curve."""
    return np.logaddexp(np.log1p(-ALIKE) + odds, np.log(ALIKE))


class Departures:
    """Departures of all pieces, and their distribution along curves and clutter.

    Angles follow the distribution of von Mises and Fisher on the sphere, density k / (4 pi sinh k) exp(k cos a). What
    is shorter than three steps is smoothed as a whole and says nothing.
    """

    def __init__(self, pieces, step):
        cosines = [np.cos(departures(p.points, p.closed, step)[1]) for p in pieces]
        count = np.array([len(c) for c in cosines], np.int64)
        ring = np.array([p.closed for p in pieces], bool)
        self.cosine = np.concatenate([*cosines, []])
        self.owner = np.repeat(np.arange(len(pieces)), count)
        self.speaks = count > 0
        # Departures at places within two steps of each other are alike.
        alone = (count + np.where(ring, 0, step)) / (2 * step)
        self.weight = np.repeat(alone / np.maximum(count, 1), count)
        self.many, self.shares, self.clutter, self.curve = len(pieces), SHARES, LOOSE, 10 * LOOSE

    def parts(self):
        """(3, a) density of each angle where a curve runs smoothly, bends and turns a corner, times their shares, as
        multiples of the density along clutter. Bends lie midway between noise and clutter."""
        base = log_concentrated(self.cosine, self.clutter)
        bent = log_concentrated(self.cosine, np.sqrt(self.clutter * self.curve)) - base
        smooth = log_concentrated(self.cosine, self.curve) - base
        return self.shares[:, None] * np.exp(np.stack([smooth, bent, np.zeros_like(base)]))

    def odds(self):
        """(p,) float64, log odds of each piece by its departures."""
        value = np.bincount(self.owner, self.weight * np.log(self.parts().sum(axis=0)), minlength=self.many)
        return bounded(value)

    def fit(self, belief):
        """Concentrations and shares, given how much each piece is believed to be a curve."""
        parts = self.parts()
        parts /= parts.sum(axis=0)
        w, b = self.weight, belief[self.owner]
        self.shares = (parts * w * b).sum(axis=1) + FIRM * SHARES
        self.shares /= self.shares.sum()
        self.clutter = concentration(self.cosine, w * (1 - b), LOOSE, FIRM)
        self.curve = max(2 * self.clutter, concentration(self.cosine, w * b * parts[0], 10 * LOOSE, 1.0))


def log_concentrated(cosine, k):
    """Log density on the sphere of von Mises and Fisher, k > 0."""
    return np.log(k / (2 * np.pi)) - np.log1p(-np.exp(-2 * k)) + k * (cosine - 1)


def concentration(cosine, weight, prior, count):
    """Concentration of weighted angles, with `count` more of the concentration `prior`.

    The mean cosine is coth k - 1 / k; k is found from its usual approximation (Banerjee and others 2005) by Newton.
    """
    mean = 1 / np.tanh(prior) - 1 / prior
    r = (np.dot(cosine, weight) + count * mean) / (weight.sum() + count)
    r = np.clip(r, 1e-3, 1 - 1e-7)
    k = r * (3 - r * r) / (1 - r * r)
    for _ in range(3):
        value = 1 / np.tanh(k) - 1 / k
        k = max(k - (value - r) / max(1 - value * value - 2 * value / k, 1e-12), 1e-3)
    return float(k)


class Scalar:
    """A number of each piece, normal with the same spread for both kinds; more of it never speaks for clutter."""

    def __init__(self, values, low=None):
        self.values = np.asarray(values, float)
        self.seen = np.isfinite(self.values)
        inside = self.values[self.seen]
        self.centre = float(np.median(inside)) if low is None else low
        self.high = self.low = self.centre
        self.variance = 1.0

    def fit(self, belief, speaks):
        own = self.seen & speaks
        x, b = self.values[own], belief[own]
        self.high = (b @ x + PRIOR * self.centre) / (b.sum() + PRIOR)
        self.low = min(self.high, ((1 - b) @ x + PRIOR * self.centre) / ((1 - b).sum() + PRIOR))
        spread = b @ (x - self.high) ** 2 + (1 - b) @ (x - self.low) ** 2
        self.variance = max((spread + PRIOR) / (len(x) + PRIOR), 1e-6)

    def odds(self):
        middle = (self.high + self.low) / 2
        value = (self.high - self.low) / self.variance * (self.values - middle)
        return np.where(self.seen, bounded(value), 0.0)
