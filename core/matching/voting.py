# SPDX-License-Identifier: GPL-3.0-or-later
"""Votes for transformations (section 4.1.1): the maxima of the 7-dimensional voting space of each pair of curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.motions import apply
from ..network.network import CurveNetwork
from .blast import Matches


@dataclass(frozen=True)
class Votes:
    """Maxima of the voting spaces. motions : (k, 4, 4) float64; weight : (k,) float64; pair : (k, 2) int64 curves."""

    motions: np.ndarray
    weight: np.ndarray
    pair: np.ndarray

    def __len__(self):
        return len(self.weight)


def vote(network: CurveNetwork, matches: Matches, *, bin_translation, bin_rotation) -> Votes:
    """Let the matches of each pair of curves vote for motions and return the maxima.

    Parameters
    ----------
    bin_translation : edge lengths, measured where the first curve's middle goes
    bin_rotation : degrees, angle between the rotations

    Notes
    -----
    A match votes with its affinity, weighted by how well it fixes the rotation. A bin stands around each
    maximum instead of in a fixed lattice, so that no border splits a peak: the strongest vote of a pair opens a
    bin, takes in the votes within the bin size, and so on with the rest. Rounds go over all pairs at once.
    """
    k = len(matches)
    if not k:
        return Votes(np.zeros((0, 4, 4)), np.zeros(0), np.zeros((0, 2), np.int64))
    weight = matches.affinity * (0.05 + matches.stiffness)
    middle = np.add.reduceat(network.points, network.offsets[:-1]) / np.diff(network.offsets)[:, None]
    place = apply(matches.motions, middle[matches.curve[:, 0]][:, None])[:, 0]
    pair = matches.curve[:, 0] * len(network) + matches.curve[:, 1]
    order = np.lexsort((matches.start[:, 1], matches.start[:, 0], matches.direction, -weight, pair))
    leaders, sums = [], []
    limit = np.cos(np.radians(bin_rotation))
    while len(order):
        first = np.ones(len(order), bool)
        first[1:] = pair[order[1:]] != pair[order[:-1]]
        group = np.cumsum(first) - 1
        leader = order[first][group]
        near = np.linalg.norm(place[order] - place[leader], axis=1) <= bin_translation
        trace = np.einsum("kij,kij->k", matches.motions[order, :3, :3], matches.motions[leader, :3, :3])
        near &= (trace - 1) / 2 >= limit - 1e-9
        leaders.append(order[first])
        sums.append(np.bincount(group[near], weight[order[near]], minlength=group[-1] + 1))
        order = order[~near]
    leaders, sums = np.concatenate(leaders), np.concatenate(sums)
    best = np.lexsort((leaders, -sums))
    return Votes(matches.motions[leaders[best]], sums[best], matches.curve[leaders[best]])
