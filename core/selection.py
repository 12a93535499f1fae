# SPDX-License-Identifier: GPL-3.0-or-later
"""Bayesian model selection (section 4.2): the few transformations that explain the curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .clustering import perturbed
from .geometry.motions import inverse
from .network.network import CurveNetwork
from .orbits import Orbit, doubts
from .support import Screen, in_long_stretches, slips


@dataclass(frozen=True)
class Model:
    """The selected transformations.

    orbits : the transformations that are kept, most support by what does not slip first
    log_bayes_factor : (k,) float64, log K of the model with each against the model without it
    of_curve : (m,) int64, the transformation that generated each curve (index into `orbits`), -1 for T_null
    hits : (k, n) int64, occurrences that show each sample under each transformation, slipping ones included
    support : (k,) float64, length of the samples that recur under each, edge lengths
    """

    orbits: list[Orbit]
    log_bayes_factor: np.ndarray
    of_curve: np.ndarray
    hits: np.ndarray
    support: np.ndarray


def select_model(network: CurveNetwork, orbits, screen: Screen, *, l0, t, bayes_ratio, progress=None) -> Model:
    """Remove transformations until the Bayes ratio says that one is needed (section 4.2.2)."""
    affinities, hits = [], []
    specific = np.zeros(len(orbits))
    for k, orbit in enumerate(orbits):
        a, h, s = curve_affinities(network, orbit, screen, t=t)
        affinities.append(a * doubts(orbit.generators, screen).min())
        hits.append(h)
        specific[k] = s
        if progress:
            progress("selection", (k + 1) / (len(orbits) + 1))
    if not orbits:
        none = np.full(len(network), -1)
        return Model([], np.zeros(0), none, np.zeros((0, len(network.points)), np.int64), np.zeros(0))
    affinity = np.array(affinities)
    null = l0 * np.exp(-2.0)
    kept, loss, best = eliminate(affinity, null, bayes_ratio)
    hits = np.array(hits)[kept]
    support = (hits > 0) @ network.weights
    order = np.argsort(-specific[kept], kind="stable")
    place = np.full(len(kept) + 1, -1)
    place[order] = np.arange(len(order))
    return Model([orbits[kept[i]] for i in order], loss[order], place[best], hits[order], support[order])


TRIES = 8
"""Motions beside the given ones that chance is learnt from, at least."""


def curve_affinities(network: CurveNetwork, orbit: Orbit, screen: Screen, *, t):
    """Average Feature BLAST affinity of every curve under a transformation, summed over its recurrences.

    Returns (m,) float64; (n,) int64, the recurrences that show each sample; and the length of the samples that some
    recurrence shows and that do not slip along it. The motion being given, a match is an unbroken stretch of samples
    on the network; its samples have affinity l exp(-d / (0.5 t)), others 0.
    What motions a little beside explain is chance and is taken off: else many recurrences, each explaining a
    little by chance, would add up to an explanation. What slips along the motions tells nothing for them.
    """
    powers = orbit.generators if orbit.kind == "single" else orbit.power(orbit.powers)
    if orbit.kind == "single":
        powers = np.concatenate([powers, inverse(powers)])
    total, hits = _affinity(network, powers, screen, t)
    # A single motion has one other beside it by luck; the mean over several says what chance gives.
    many = max(1, TRIES // len(powers))
    beside = perturbed(np.repeat(powers, many, axis=0), screen.points.std(axis=0))
    chance = _affinity(network, beside, screen, t)[0] / many
    counts = np.diff(network.offsets)
    own, other = (np.add.reduceat(x, network.offsets[:-1]) / counts for x in (total, chance))
    return np.maximum(own - other, 0), hits, network.weights @ (total > 0)


def _affinity(network, powers, screen, t):
    """Affinity (n,) float64 and recurrences (n,) int64 of every sample, summed over the motions."""
    n = len(network.points)
    total, hits = np.zeros(n), np.zeros(n, np.int64)
    least = np.minimum(screen.least, np.diff(network.offsets))[network.curve_of]
    size = max(1, 400_000 // n)
    for i in range(0, len(powers), size):
        part = powers[i : i + size]
        h, k, j = screen.hits(part)
        good = in_long_stretches(h, k, screen.curve, least)
        h, k, j = h[good], k[good], j[good]
        hits += np.bincount(k, minlength=n)
        good = ~slips(part, h, screen.points[k], screen.tangents[k])
        h, k, j = h[good], k[good], j[good]
        if not len(h):
            continue
        moved = np.einsum("nij,nj->ni", part[h, :3, :3], network.points[k]) + part[h, :3, 3]
        target, line = network.points[j], network.tangents[j]
        offset = moved - target
        offset -= line * (offset * line).sum(-1)[:, None]
        distance = np.sqrt((offset**2).sum(-1))
        new = np.ones(len(h), bool)
        new[1:] = (h[1:] != h[:-1]) | (k[1:] != k[:-1] + 1) | (network.curve_of[k[1:]] != network.curve_of[k[:-1]])
        run = np.cumsum(new) - 1
        length = np.bincount(run, network.weights[k])
        mean = np.bincount(run, distance) / np.bincount(run)
        total += np.bincount(k, (length * np.exp(-mean / (0.5 * t)))[run], minlength=n)
    return total, hits


def eliminate(affinity, null, bayes_ratio):
    """Greedy elimination on the affinities (k, m) of k transformations and m curves.

    Removing one changes only the curves it explains best, from their best to their second best affinity, so that
    a step costs O(m). The likelihood never rises by a removal: it ends when the least loss exceeds log K.

    Returns
    -------
    kept : list of int; loss : (len(kept),) float64, log K of each; best : (m,) int64, index into kept, len(kept)
    for T_null
    """
    k, m = affinity.shape
    score = np.log(np.maximum(np.concatenate([affinity, np.full((1, m), null)]), null))
    # T_null explains what nothing explains better; at equal likelihood the earlier transformation wins.
    alive = np.ones(k + 1, bool)
    order = np.argsort(-score, axis=0, kind="stable")
    order = np.where(np.take_along_axis(score, order, 0) > np.log(null), order, k)
    first, second = np.zeros(m, np.int64), np.ones(m, np.int64)
    column = np.arange(m)
    while True:
        best, next_ = order[first, column], order[np.minimum(second, k), column]
        gain = score[best, column] - score[next_, column]
        loss = np.bincount(best, gain, minlength=k + 1)[:k]
        candidates = np.flatnonzero(alive[:k])
        if not len(candidates):
            break
        worst = candidates[np.argmin(loss[candidates])]
        if loss[worst] > np.log(bayes_ratio):
            break
        alive[worst] = False
        for c in np.flatnonzero((best == worst) | (next_ == worst)):
            left = np.flatnonzero(alive[order[:, c]])
            first[c] = left[0]
            second[c] = left[1] if len(left) > 1 else left[0]
    kept = np.flatnonzero(alive[:k])
    place = np.full(k + 1, len(kept))
    place[kept] = np.arange(len(kept))
    return list(kept), loss[kept], place[order[first, column]]
