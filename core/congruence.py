# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups of clean curves that rigid motions take onto each other, by Feature BLAST on the curves alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .clustering import cluster_votes
from .geometry.motions import inverse
from .matching.blast import feature_blast
from .matching.voting import vote
from .network.building import build_network
from .network.network import CurveNetwork
from .support import Screen, long_stretches
from .values import Curves


@dataclass(frozen=True)
class Alike:
    """Curves as a network of their own, and the rigid motions that take some of them onto others.

    motions : (k, 4, 4) float64, of the space that the curves are in, best supported first
    """

    network: CurveNetwork
    screen: Screen
    motions: np.ndarray


def find_alike(curves, surface=(None, None), *, l0, s, t, delta_l, epsilon, threads=1, tick=None) -> Alike:
    """What Feature BLAST and clustering find among clean curves.

    Parameters
    ----------
    curves : list of (k, 3) float64, edge lengths
    surface : normals (n, 3) and kinds (n,) of all points, or None
    tick : called between steps, so that the run can be stopped
    """
    normals, kind = surface
    lines = replace(Curves.from_list(curves), normals=normals, kind=kind)
    sub = build_network(lines, edge_length=1.0, smoothing=0.0)
    screen = Screen(sub, radius=epsilon, stretch=6.0, still=8.0, threads=threads, tick=tick)
    least = max(8.0, 0.6 * l0)
    strong = np.flatnonzero(sub.lengths > least)
    if len(strong) < 2:
        return Alike(sub, screen, np.zeros((0, 4, 4)))
    matches = feature_blast(
        sub, strong, l0=least, s=s, t=t, delta_l=delta_l, threads=threads, progress=lambda *_: screen.tick()
    )  # fmt: skip
    votes = vote(sub, matches, bin_translation=2.0, bin_rotation=1.5)
    clusters = cluster_votes(sub, votes, screen, cluster_translation=2.0, cluster_rotation=1.5)
    return Alike(sub, screen, sub.motion_to_world(clusters.motions))


def congruent_parts(alike: Alike, owner, *, l0):
    """Groups of clean curves that rigid motions take onto each other.

    Three curves of one template that keep their places to each other are one thing twice; fewer may be two parts of
    one thing that look alike (the halves of an arch). Two templates are one when nearly all of both agrees: a window
    and its mirror image have much in common, and are not the same.

    Parameters
    ----------
    owner : (c,) int64, the template of each curve, or of the templates that stand together

    Returns
    -------
    list of groups, each a list of (motion (4, 4), members list of int): the motion takes the first member set's
    place to this one's. The first motion is the identity.
    """
    sub, screen = alike.network, alike.screen
    found = []
    for m, own in zip(alike.motions, sub.motion_from_world(alike.motions)):
        screen.tick()
        source, target = _whole_sides(sub, screen, own)
        length = sub.lengths[source].sum()
        if length < l0 or set(source) & set(target):
            continue
        within = len(np.unique(np.asarray(owner)[sub.source[np.union1d(source, target)]])) == 1
        if (within and min(len(source), len(target)) >= 3) or all(_is_most(sub, s, owner) for s in (source, target)):
            found.append((length, m, source, target))
    found.sort(key=lambda f: -f[0])
    groups = _grouped([f[1:] for f in found])
    return [[(m, sub.source[members].tolist()) for m, members in g] for g in groups]


def _is_most(network, curves, owner, *, least=0.9):
    """Whether curves are most of the templates that they belong to."""
    owner = np.asarray(owner)[network.source]
    own = np.isin(owner, owner[list(curves)])
    return network.lengths[list(curves)].sum() >= least * network.lengths[own].sum()


def _whole_sides(network, screen, motion, *, least=0.65):
    """Curves that a motion takes onto others as a whole, and those others, which they show as a whole."""
    least_run = np.minimum(screen.least, np.diff(network.offsets))[network.curve_of]
    near, hit = screen.nearest(np.stack([motion, inverse(motion)]))
    hit = long_stretches(hit, screen.curve, least_run)
    hit &= network.curve_of[near] != network.curve_of
    m = len(network)
    share = [np.bincount(network.curve_of[h], minlength=m) / np.diff(network.offsets) for h in hit]
    source, target = (x >= least for x in share)
    for _ in range(3):
        meets = [np.zeros(m, bool), np.zeros(m, bool)]
        for side, other in ((0, target), (1, source)):
            to = network.curve_of[near[side][hit[side]]]
            good = np.bincount(network.curve_of[hit[side]], other[to], minlength=m)
            meets[side] = good >= least * np.diff(network.offsets)
        source, target = source & meets[0], target & meets[1]
    return np.flatnonzero(source), np.flatnonzero(target)


def _grouped(found):
    """Groups of places of one thing, from motions with the curves they start from and lead to, best first."""
    groups, where = [], {}

    def add(group, motion, members):
        groups[group].append((motion, list(members)))
        where.update({k: (group, len(groups[group]) - 1) for k in members})

    for way, source, target in found:
        at, to = ({where[k] for k in side if k in where} for side in (source, target))
        if not at and not to:
            groups.append([])
            add(len(groups) - 1, np.eye(4), source)
            add(len(groups) - 1, way, target)
        elif len(at) == 1 and not to:
            group, place = at.pop()
            add(group, way @ groups[group][place][0], target)
        elif len(to) == 1 and not at:
            group, place = to.pop()
            add(group, inverse(way) @ groups[group][place][0], source)
    return groups
