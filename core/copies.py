# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates that are rigid copies of each other, or that hold copies within themselves, become one (section 5.2)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from .blast import feature_blast
from .clustering import cluster_votes
from .drafting import consolidate_places
from .drafts import Draft, explained_samples, placed, seen_share
from .grouping import group
from .network import CurveNetwork, build_network
from .occurrences import share_place
from .polishing import settled
from .rigid import best_rotation, inverse, motion
from .support import Screen, long_stretches
from .values import Curves
from .voting import vote


def unite(network: CurveNetwork, drafts: list[Draft], free, parameters, *, threads=1) -> list[Draft]:
    """Drafts in which curves that are rigid copies of each other are one template with the occurrences of all.

    free : (n,) bool, samples that may show them

    A template of two pairs of things becomes one pair first, and then one thing.
    """
    for _ in range(4):
        united = _united(network, drafts, free, parameters, threads)
        if united is drafts:
            break
        drafts = united
    return drafts


def _united(network, drafts, free, parameters, threads):
    """The drafts after one round, or just the given ones where nothing is a copy of anything."""
    p, epsilon = parameters, parameters.epsilon
    items = [(d, c) for d, draft in enumerate(drafts) for c in range(len(draft.curves))]
    if len(items) < 2:
        return drafts
    first = [np.asarray(drafts[d].poses[0]) for d, _ in items]
    lines = [drafts[d].curves[c] @ m[:3, :3].T + m[:3, 3] for (d, c), m in zip(items, first)]
    surface = (None, None)
    if network.normals is not None:
        nearest = cKDTree(network.points).query(np.concatenate(lines))[1]
        surface = network.normals[nearest], None if network.kind is None else network.kind[nearest]
    alike = find_alike(
        lines, surface, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, epsilon=epsilon, threads=threads
    )  # fmt: skip
    groups = congruent_parts(alike, [d for d, _ in items], l0=p.l0)
    united = []
    for places in groups:
        used = [items[k] for _, members in places for k in members]
        draft = _whole(network, drafts, items, lines, places, free, epsilon)
        new, _ = group(network, draft, free, radius=1.25 * epsilon)
        # What was explained by the parts must be explained by the whole.
        before = [drafts[d].part([c for e, c in used if e == d]) for d in sorted({d for d, _ in used})]
        if _explained_length(network, new, epsilon) >= 0.97 * _explained_length(network, before, epsilon):
            united += new
    if not united:
        united = _one_of_figures(network, drafts, alike.motions, free, epsilon)
    if not united:
        return drafts
    return united + [left for draft in drafts if (left := _uncovered(draft, united, 1.25 * epsilon)) is not None]


def _whole(network, drafts, items, lines, places, free, epsilon):
    """One draft of what is at several places: the longest version of its curves, with the occurrences of all."""
    place, members = max(places, key=lambda entry: sum(len(lines[k]) for k in entry[1]))
    back = inverse(place)
    curves = [lines[k] @ back[:3, :3].T + back[:3, 3] for k in members]
    closed = [drafts[d].closed[c] for d, c in (items[k] for k in members)]
    # What is at one place may be from several drafts; each knows occurrences of it.
    known = [(place, d) for place, members in places for d in sorted({items[k][0] for k in members})]
    sources = [drafts[d] for _, d in known]
    most = max(sources, key=lambda source: len(source.poses))
    poses = [source.poses @ inverse(source.poses[0]) @ place for source, (place, _) in zip(sources, known)]
    cells = [
        (source.keys, source.orbital)
        if source.transformation == most.transformation
        else (np.zeros((len(source.poses), most.keys.shape[1]), np.int64), np.zeros(len(source.poses), bool))
        for source in sources
    ]
    keys, orbital = (np.concatenate(x) for x in zip(*cells))
    # Cells of one place move together: all of them tell where that place is. Others stand alone.
    together = np.repeat(np.arange(len(known)), [len(p) for p in poses])
    together = np.where(orbital, together, len(known) + np.arange(len(together)))
    poses = np.concatenate(poses)
    evidence = seen_share(network, curves, poses, radius=1.25 * epsilon, free=free)
    draft = Draft(curves, closed, poses, keys, evidence, most.transformation, orbital)
    kept = _one_a_place(draft)
    return settled(network, draft.part(cells=kept), free, radius=1.25 * epsilon, together=together[kept])


def _one_of_figures(network, drafts, motions, free, epsilon):
    """The best pair of drafts that make the same figure, as one draft in a list; an empty list where there is none.

    A rosette and another one may be cut into petals at other places, so that no petal of one is a petal of the other.
    """
    for a, b, figure_motion in same_figures(drafts, motions, radius=1.25 * epsilon):
        one = drafts[a]
        there = _taken_over(one, drafts[b], figure_motion)
        both = replace(
            one,
            poses=np.concatenate([one.poses, there]),
            keys=np.concatenate([one.keys, np.zeros((len(there), one.keys.shape[1]), np.int64)]),
            orbital=np.concatenate([one.orbital, np.zeros(len(there), bool)]),
        )
        evidence = seen_share(network, both.curves, both.poses, radius=1.25 * epsilon, free=free)
        second = np.repeat([0, 1], [len(one.poses), len(there)])
        both = settled(network, replace(both, evidence=evidence), free, radius=1.25 * epsilon, together=second)
        # Twice as many occurrences tell better which curve goes on in which.
        figure = np.concatenate(both.curves)
        made = consolidate_places(network, both.poses, figure, both.transformation, free, epsilon=epsilon)
        if made.curves:
            both = replace(made, poses=both.poses, keys=both.keys, orbital=both.orbital)
            both = settled(network, both, free, radius=1.25 * epsilon, together=second)
        new, _ = group(network, both, free, radius=1.25 * epsilon)
        before = _explained_length(network, [one, drafts[b]], epsilon)
        if _explained_length(network, new, epsilon) >= 0.95 * before:
            return new
    return []


def _taken_over(one, other, figure_motion):
    """Poses (b, 4, 4) of the curves of one draft in the same figure that another one shows.

    The other's occurrences were fitted to what is seen there; how its curves lie to those of the first is one motion.
    Where it has none the figure of the first tells.
    """
    points = np.concatenate(one.curves)[::4]

    def places(poses):
        return (points @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, None, :3, 3]).reshape(len(poses), -1)

    moved = figure_motion @ one.poses
    best, least = moved, np.inf
    for pose in other.poses:
        poses = other.poses @ inverse(pose) @ moved[0]
        gap = cdist(places(moved), places(poses)).min(axis=1) / np.sqrt(len(points))
        if np.median(gap) < least:
            best, least = np.concatenate([poses, moved[gap > LOST]]), np.median(gap)
    return best


def same_figures(drafts, motions, *, radius, whole=0.85, most=0.6):
    """Pairs of drafts that show the same figure, all occurrences together: (a, b, motion (4, 4)) each, best first.

    The motion takes the figure of a to that of b; it or its inverse begins as one of the given (k, 4, 4). At least a
    share `whole` of one figure is in the other, and `most` of that one in the first, which may have holes.
    """
    found = []
    figures = [placed(draft)[:2] for draft in drafts]
    both = np.concatenate([motions, inverse(motions)]) if len(motions) else np.zeros((0, 4, 4))
    for a, one in enumerate(figures):
        for b, other in enumerate(figures):
            if a == b or (drafts[a].lengths.sum(), -a) < (drafts[b].lengths.sum(), -b):
                continue
            away = both[:, :3, :3] @ one[0].mean(axis=0) + both[:, :3, 3] - other[0].mean(axis=0)
            near = np.linalg.norm(away, axis=1) < NEAR * np.linalg.norm(one[0].std(axis=0)) + 2 * radius
            best = (0.0, None)
            for m in both[near]:
                some = one[0][::8] @ m[:3, :3].T + m[:3, 3], one[1][::8] @ m[:3, :3].T
                if _covered(some, other, 2 * radius) < BEGIN:
                    continue
                m = _aligned(m, one, other, radius=2 * radius)
                moved = one[0] @ m[:3, :3].T + m[:3, 3], one[1] @ m[:3, :3].T
                there, back = _covered(moved, other, radius), _covered(other, moved, radius)
                if max(there, back) >= whole and min(there, back) >= most and there + back > best[0]:
                    best = (there + back, m)
            if best[1] is not None:
                found.append((best[0], a, b, best[1]))
    return [f[1:] for f in sorted(found, key=lambda f: -f[0])]


NEAR, BEGIN, LOST = 0.4, 0.3, 5.0
"""Share of its size by which the middle of a figure may lie beside that of the other, which has holes; share of it
that must lie on the other to be aligned; RMS edge lengths from which on an occurrence of one has none there."""


def _aligned(m, one, other, *, radius, rounds=6):
    """A motion moved so that it takes one figure (points, tangents) onto another one as well as it can."""
    tree, m = cKDTree(other[0]), m.copy()
    for _ in range(rounds):
        moved, ways = one[0] @ m[:3, :3].T + m[:3, 3], one[1] @ m[:3, :3].T
        distance, near = tree.query(moved, distance_upper_bound=radius, workers=-1)
        hit = np.flatnonzero(np.isfinite(distance))
        hit = hit[np.abs((other[1][near[hit]] * ways[hit]).sum(1)) > 0.7]
        if len(hit) < 30:
            break
        line = other[1][near[hit]]
        offset = other[0][near[hit]] - moved[hit]
        target = moved[hit] + offset - line * (offset * line).sum(1)[:, None]
        middle, aim = moved[hit].mean(axis=0), target.mean(axis=0)
        turn, _ = best_rotation(((target - aim).T @ (moved[hit] - middle))[None])
        m = motion(turn[0], aim - turn[0] @ middle) @ m
    return m


def _covered(one, other, radius):
    """Share of the points of a figure that lie on another one and run the same way; each is (points, tangents)."""
    distance, near = cKDTree(other[0]).query(one[0], distance_upper_bound=radius, workers=-1)
    found = np.flatnonzero(np.isfinite(distance))
    return float((np.abs((other[1][near[found]] * one[1][found]).sum(1)) > 0.7).sum() / max(len(one[0]), 1))


def _one_a_place(draft):
    """The occurrences (k,) without those that lie where another one does, which shows the curves better."""
    region = np.concatenate(draft.curves)
    share = draft.evidence @ draft.lengths
    kept = []
    for k in np.argsort(-share, kind="stable"):
        if not share_place(region, draft.poses[k : k + 1], draft.poses[kept])[0]:
            kept.append(int(k))
    return np.array(sorted(kept))


def _explained_length(network, drafts, epsilon):
    if not drafts:
        return 0.0
    shown = np.any([explained_samples(network, d, radius=1.25 * epsilon) for d in drafts], axis=0)
    return float(network.weights[shown].sum())


def _uncovered(draft, others, radius):
    """The draft without the curves that other drafts show already, or None."""
    points, tangents = (np.concatenate(x) for x in zip(*(placed(o)[:2] for o in others)))
    tree = cKDTree(points)
    own, way, _, curve = placed(draft)
    distance, near = tree.query(own, k=3, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    along = np.abs((tangents[np.where(found, near, 0)] * way[:, None]).sum(-1)) > 0.7
    covered = np.bincount(curve, (found & along).any(axis=1)) / np.bincount(curve)
    keep = np.flatnonzero(covered < 0.5)
    if not len(keep):
        return None
    return draft.part(keep)


@dataclass(frozen=True)
class Alike:
    """Curves as a network of their own, and the rigid motions that take some of them onto others.

    motions : (k, 4, 4) float64, of the space that the curves are in, best supported first
    """

    network: CurveNetwork
    screen: Screen
    motions: np.ndarray


def find_alike(curves, surface=(None, None), *, l0, s, t, delta_l, epsilon, threads=1) -> Alike:
    """What Feature BLAST and clustering find among clean curves.

    Parameters
    ----------
    curves : list of (k, 3) float64, edge lengths
    surface : normals (n, 3) and kinds (n,) of all points, or None
    """
    normals, kind = surface
    lines = replace(Curves.from_list(curves), normals=normals, kind=kind)
    sub = build_network(lines, edge_length=1.0, smoothing=0.0)
    screen = Screen(sub, radius=epsilon, stretch=6.0, still=8.0, threads=threads)
    least = max(8.0, 0.6 * l0)
    strong = np.flatnonzero(sub.lengths > least)
    if len(strong) < 2:
        return Alike(sub, screen, np.zeros((0, 4, 4)))
    matches = feature_blast(sub, strong, l0=least, s=s, t=t, delta_l=delta_l, threads=threads)
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
    owner : (c,) int64, the template of each curve

    Returns
    -------
    list of groups, each a list of (motion (4, 4), members list of int): the motion takes the first member set's
    place to this one's. The first motion is the identity.
    """
    sub, screen = alike.network, alike.screen
    found = []
    for m, own in zip(alike.motions, sub.motion_from_world(alike.motions)):
        source, target = _whole_sides(sub, screen, own)
        length = sub.lengths[source].sum()
        if length < l0 or set(source) & set(target):
            continue
        within = bool(np.intersect1d(*(np.asarray(owner)[sub.source[side]] for side in (source, target))).size)
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
