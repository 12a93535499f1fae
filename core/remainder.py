# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model leaves unexplained, searched once more.

A small thing that repeats beside a large one (a ring of roundels over rows of windows) explains less of the whole
network than the large one does by chance. Among what the large one leaves it stands out.
"""

from __future__ import annotations

import numpy as np

from .clustering import cluster_votes
from .matching.voting import Votes
from .network.network import CurveNetwork
from .orbits import Orbit, detect_orbits
from .selection import Model, select_model
from .support import Screen

EXPLAINED, SPOKEN = 0.3, 4.0
"""Share of a curve's length from which on it counts as explained, and the support, in multiples of l0, without which
no motion is worth a search for orbits: two strong curves, each seen twice."""


def remainder(network: CurveNetwork, model: Model, votes: Votes) -> tuple[CurveNetwork, Votes]:
    """The curves that no transformation of the model maps and that are like another of them, in the same frame, and
    the votes of pairs of them."""
    mapped = (model.hits > 0).any(axis=0) * network.weights
    free = np.add.reduceat(mapped, network.offsets[:-1]) < EXPLAINED * network.lengths
    good = free[votes.pair].all(axis=1)
    kept, pair = np.unique(votes.pair[good], return_inverse=True)
    return network.part(kept), Votes(votes.motions[good], votes.weight[good], pair.reshape(-1, 2))


def further_orbits(network: CurveNetwork, model: Model, votes: Votes, screen: Screen, p) -> list[Orbit]:
    """Orbits that explain what the model does not; none where nothing recurs there.

    screen : of the whole network, whose radius, threads and tick are taken; p : Parameters
    """
    rest, votes = remainder(network, model, votes)
    if not len(votes):
        return []
    screen = Screen(rest, radius=screen.radius, threads=screen.threads, tick=screen.tick)
    clusters = cluster_votes(
        rest, votes, screen, cluster_translation=p.cluster_translation, cluster_rotation=p.cluster_rotation
    )
    # Noise is full of pairs of curves that are like each other; their motions explain nothing but the pair.
    if not len(clusters) or clusters.support.max() < SPOKEN * p.l0:
        return []
    orbits = detect_orbits(rest, clusters, screen)
    # Of many motions that were tried one explains something by luck: the evidence must outweigh their number.
    ratio = p.bayes_ratio * max(1, len(clusters))
    return select_model(rest, orbits, screen, l0=p.l0, t=p.t, bayes_ratio=ratio).orbits
