# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences in no regular order: one thing that several transformations describe (section 5.2, components).

The graph of one transformation joins a curve with its image only. Things that stand in no lattice are related by
a different motion for every pair; the components of those motions share curves and are one thing. Here a thing
is the place that a motion starts from, and its occurrences are found by what the other motions show of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .blast import feature_blast
from .clustering import cluster_votes
from .network import CurveNetwork, build_network
from .rigid import inverse
from .support import Screen, in_long_stretches, long_stretches
from .values import Curves
from .voting import vote

SEEN, ROUNDS, APART = 0.3, 3, 8.0
"""Share of a thing that an occurrence must show, rounds of composing motions, edge lengths between occurrences."""


def starred(network: CurveNetwork, seed, pool, screen: Screen, free):
    """Occurrences of what a motion maps: its own two places and all others that the pool's motions lead to.

    Parameters
    ----------
    seed : (4, 4); pool : (k, 4, 4) other motions, each taken with its inverse
    free : (n,) bool, samples that nothing explains yet

    Returns
    -------
    poses : (a, 4, 4), the identity first; region : (r,) int64, samples of the thing at its first place
    """
    _, hit = screen.nearest(seed[None])
    hit = long_stretches(hit, screen.curve, screen.least)[0] & free
    region = _main_part(network, np.flatnonzero(hit))
    if len(region) < 2 * screen.least:
        return np.eye(4)[None], region
    steps = np.concatenate([seed[None], inverse(seed[None]), pool, inverse(pool)])
    poses = np.eye(4)[None]
    fresh = poses
    for _ in range(ROUNDS):
        tries = (steps[None] @ fresh[:, None]).reshape(-1, 4, 4)
        tries = tries[~_near(network, region, tries, poses)]
        if not len(tries):
            break
        tries, share = fit_on(network, screen, tries, region, free)
        accepted = []
        for k in np.argsort(-share, kind="stable"):
            if share[k] < SEEN:
                break
            known = np.concatenate([poses, *[a[None] for a in accepted]])
            if not _near(network, region, tries[k : k + 1], known)[0]:
                accepted.append(tries[k])
        if not accepted:
            break
        fresh = np.array(accepted)
        poses = np.concatenate([poses, fresh])
    return poses, region


def _main_part(network, samples, gap=12.0):
    """The largest group of samples that lie within `gap` of each other."""
    if not len(samples):
        return samples
    pair = cKDTree(network.points[samples]).query_pairs(gap, output_type="ndarray")
    n = len(samples)
    graph = coo_matrix((np.ones(len(pair)), (pair[:, 0], pair[:, 1])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    return samples[label == np.argmax(np.bincount(label))]


def _near(network, region, motions, known):
    """Which motions put a region where one of the known motions puts it already."""
    return share_place(network.points[region], motions, known)


def share_place(points, motions, known):
    """(k,) bool, which motions (k, 4, 4) put points (n, 3) where one of the known motions puts them already."""
    middle = points.mean(axis=0)
    size = np.sqrt(((points - middle) ** 2).sum(1).mean())
    place = motions[:, :3, :3] @ middle + motions[:, :3, 3]
    other = known[:, :3, :3] @ middle + known[:, :3, 3]
    gap = np.linalg.norm(place[:, None] - other[None], axis=2)
    # A thing is as large as it is: two occurrences do not share a place, whichever way they are turned.
    return (gap < max(APART, 0.5 * size)).any(axis=1)


def fit_on(network: CurveNetwork, screen: Screen, motions, region, free, *, rounds=3):
    """Motions refined on the samples of a region, and the share of its length that each shows."""
    motions = motions.copy()
    inside = np.zeros(len(network.points), bool)
    inside[region] = True
    weight = network.weights[region].sum()
    share = np.zeros(len(motions))
    size = max(1, 400_000 // len(network.points))
    for begin in range(0, len(motions), size):
        part = slice(begin, begin + size)
        for last in range(rounds + 1):
            i, k, j = screen.hits(motions[part])
            good = inside[k] & free[j]
            i, k, j = i[good], k[good], j[good]
            good = in_long_stretches(i, k, screen.curve, screen.least)
            i, k, j = i[good], k[good], j[good]
            share[part] = np.bincount(i, network.weights[k], minlength=len(motions[part])) / weight
            if last < rounds:
                motions[part] = screen.align(motions[part], i, k, j)
    return motions, share


def congruent_parts(curves, owner, surface=(None, None), *, l0, s, t, delta_l, epsilon, threads=1):
    """Groups of clean curves that rigid motions take onto each other.

    Three curves that keep their places to each other are one thing twice; fewer may be two parts of one thing
    that look alike (the halves of an arch), unless they are all there is of their templates.

    Parameters
    ----------
    curves : list of (k, 3) float64, edge lengths
    owner : (c,) int64, the template of each curve
    surface : normals (n, 3) and kinds (n,) of all points, or None

    Returns
    -------
    list of groups, each a list of (motion (4, 4), members list of int): the motion takes the first member set's
    place to this one's. The first motion is the identity.
    """
    normals, kind = surface
    lines = replace(Curves.from_list(curves), normals=normals, kind=kind)
    sub = build_network(lines, edge_length=1.0, smoothing=0.0)
    least = max(8.0, 0.6 * l0)
    strong = np.flatnonzero(sub.lengths > least)
    if len(strong) < 2:
        return []
    matches = feature_blast(sub, strong, l0=least, s=s, t=t, delta_l=delta_l, threads=threads)
    votes = vote(sub, matches, bin_translation=2.0, bin_rotation=1.5)
    screen = Screen(sub, radius=epsilon, stretch=6.0, still=APART, threads=threads)
    clusters = cluster_votes(sub, votes, screen, cluster_translation=2.0, cluster_rotation=1.5)
    found = []
    for motion in clusters.motions:
        source, target = _whole_sides(sub, screen, motion)
        length = sub.lengths[source].sum()
        if length < l0 or set(source) & set(target):
            continue
        sides = (source, target)
        if min(map(len, sides)) >= 3 or all(_is_most(sub, side, owner) for side in sides):
            found.append((length, motion, source, target))
    found.sort(key=lambda f: -f[0])
    groups = _grouped([f[1:] for f in found])
    return [[(sub.motion_to_world(m[None])[0], sub.source[members].tolist()) for m, members in g] for g in groups]


def _is_most(network, curves, owner, *, least=0.7):
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

    for motion, source, target in found:
        at, to = ({where[k] for k in side if k in where} for side in (source, target))
        if not at and not to:
            groups.append([])
            add(len(groups) - 1, np.eye(4), source)
            add(len(groups) - 1, motion, target)
        elif len(at) == 1 and not to:
            group, place = at.pop()
            add(group, motion @ groups[group][place][0], target)
        elif len(to) == 1 and not at:
            group, place = to.pop()
            add(group, inverse(motion) @ groups[group][place][0], source)
    return groups
