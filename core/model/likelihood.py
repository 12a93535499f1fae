# SPDX-License-Identifier: GPL-3.0-or-later
"""How well each hypothesis explains each curve (section 4.2.1, equation 1).

The affinity of a curve averages over its samples those of Feature BLAST, l exp(-d / (0.5 t)): l is the length of the
stretch that recurs, d its distance, summed over the poses that show it again; a sample that nothing shows again has 0.
"""

from __future__ import annotations

import numpy as np

from ..evidence.field import Field
from ..evidence.odds import between, sliding
from ..hypotheses.hypothesis import beside

BREAK = 4
"""Samples without a hit that end a stretch (tolerance: the points of a thing are two edges apart)."""


def affinities(field: Field, thing, *, t):
    """(m,) float64, the affinity of each curve under a thing; and (n,) int64, how often each sample recurs.

    t : edge lengths, as in Algorithm 1
    """
    network = field.network
    near = field.targets(thing.poses, thing.probe)
    other = thing.poses[beside(thing.centres())]
    slides = sliding(field, between(thing.poses, other), thing.probe.moved(other))
    hit = (near >= 0) & ~slides
    again = np.maximum(hit.sum(axis=0) - 1, 0)
    pose, point = np.nonzero(hit)
    sample = near[pose, point].astype(np.int64)
    at = np.einsum("nij,nj->ni", thing.poses[pose, :3, :3], thing.points[point]) + thing.poses[pose, :3, 3]
    gap = field.points[sample] - at
    line = field.tangents[sample]
    gap -= (gap * line).sum(axis=1)[:, None] * line
    distance = np.sqrt((gap**2).sum(axis=1))
    order = np.argsort(sample, kind="stable")
    sample, distance, again = sample[order], distance[order], again[point][order]
    affinity = np.zeros(len(network))
    recurs = np.zeros(len(field), np.int64)
    if len(sample):
        fresh = np.r_[True, (np.diff(sample) > BREAK) | (np.diff(network.curve_of[sample]) != 0)]
        stretch = np.cumsum(fresh) - 1
        first = np.flatnonzero(fresh)
        last = np.r_[first[1:], len(sample)] - 1
        length = (sample[last] - sample[first] + 1).astype(float)
        mean = np.bincount(stretch, distance) / np.bincount(stretch)
        times = np.bincount(stretch, again) / np.bincount(stretch)
        worth = length * np.exp(-mean / (0.5 * t)) * times
        np.add.at(affinity, network.curve_of[sample[first]], worth * length)
        np.maximum.at(recurs, sample, again)
    return affinity / np.maximum(network.lengths, 1.0), recurs
