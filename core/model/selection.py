# SPDX-License-Identifier: GPL-3.0-or-later
"""Bayesian model selection (section 4.2): the few hypotheses that explain the curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..evidence.field import Field
from .likelihood import affinities


@dataclass(frozen=True)
class Model:
    """The selected hypotheses.

    things : those that are kept, most support first
    log_bayes_factor : (k,) float64, log K of the model with each against the model without it
    of_curve : (m,) int64, the hypothesis that generated each curve (index into `things`), -1 for T_null
    support : (k,) float64, length of the samples that recur under each, edge lengths
    """

    things: list
    log_bayes_factor: np.ndarray
    of_curve: np.ndarray
    support: np.ndarray


def select_model(field: Field, things, *, l0, t, bayes_ratio, tick=lambda: None) -> Model:
    """Remove hypotheses until the Bayes ratio says that one is needed (section 4.2.2).

    things : list of Hypothesis; l0, t : edge lengths, as in Algorithm 1; bayes_ratio : K
    """
    network = field.network
    if not things:
        return Model([], np.zeros(0), np.full(len(network), -1), np.zeros(0))
    rows, support = [], []
    for thing in things:
        affinity, recurs = affinities(field, thing, t=t)
        rows.append(affinity)
        # The points of a thing are two edges apart: the samples beside a hit recur as well.
        support.append(network.weights @ field.widened(recurs > 0))
        tick()
    kept, loss, best = eliminate(np.array(rows), l0 * np.exp(-2.0), bayes_ratio)
    support = np.array(support)[kept]
    order = np.argsort(-support, kind="stable")
    place = np.full(len(kept) + 1, -1)
    place[order] = np.arange(len(order))
    return Model([things[kept[i]] for i in order], loss[order], place[best], support[order])


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
