# SPDX-License-Identifier: GPL-3.0-or-later
"""Which curves belong to a thing: the samples about its poses, overlaid in its frame, by their log odds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..evidence.decoys import decoys
from ..evidence.field import Field, Probe
from ..evidence.odds import LEAST_CHANCE, UNIT, between, log_odds, sliding
from ..geometry.motions import inverse
from .hypothesis import SPACING, Hypothesis, beside

ALONG, CHANCE_ALONG, OFF = 6.0, 10.0, 1.5
"""Edge lengths along a curve over which log odds, and chance, are averaged: curves are there or not, points are not;
and edge lengths across it up to which a point is on the same curve (tolerance)."""

RIVAL = 0.5
"""Share of p that the alternative takes at least: a curve that half as many poses show as the others is no part."""

DECOYED = 6
"""Poses whose decoys tell chance; count."""

LEAST_POINTS, CONNECTED, PIECE = 10, 25.0, 3.0
"""Fewest points of a thing; edge lengths over which its parts hang together; log odds of a piece that stands alone."""


def chance_of(field: Field, poses, probe: Probe):
    """(m,) float64, how often decoys of the poses hit near each point of a probe, averaged along its curve."""
    wrong = decoys(poses[:DECOYED], probe.points.mean(axis=0), probe.tangents).reshape(-1, 4, 4)
    hit = (field.targets(wrong, probe) >= 0).mean(axis=0)
    return along_curves(hit, probe, CHANCE_ALONG)


def along_curves(values, probe: Probe, reach):
    """(m,) float64, means over the points of the same curve within reach; not over those of curves beside."""
    i, j = cKDTree(probe.points).query_pairs(reach, output_type="ndarray").T
    i, j = np.r_[i, j], np.r_[j, i]
    gap = probe.points[j] - probe.points[i]
    line = probe.tangents[i]
    off = gap - (gap * line).sum(axis=1)[:, None] * line
    same = (np.abs((line * probe.tangents[j]).sum(axis=1)) > 0.8) & ((off**2).sum(axis=1) < OFF**2)
    i, j = i[same], j[same]
    m = len(values)
    return (values + np.bincount(i, values[j], minlength=m)) / (1 + np.bincount(i, minlength=m))


def extended(field: Field, thing: Hypothesis, taken, *, reach) -> Hypothesis | None:
    """The thing with its curves made anew from all samples that its poses own; None where too little is left.

    Parameters
    ----------
    taken : (n,) bool, samples that other things explain; reach : edge lengths about the present points

    Notes
    -----
    A sample belongs to the pose that is nearest through the network. Each point counts only at the poses that own its
    place, so that a cell does not grow over its neighbours.
    """
    poses = thing.poses
    owner = _owners(field, thing, taken)
    sample = np.flatnonzero(owner >= 0)
    back = inverse(poses)[owner[sample]]
    probe = _taken_back(field.probe(sample), back)
    near = cKDTree(thing.points).query(probe.points, distance_upper_bound=reach)[0] < np.inf
    sample, probe = sample[near], probe.take(near)
    if len(sample) < LEAST_POINTS:
        return None
    pose_of = owner[sample]
    fine = _representatives(probe, pose_of)
    hit = field.targets(poses, fine) >= 0
    counts = _counts_at(field, poses, fine, owner, hit)
    p = min(thing.shown, 0.6)
    q = np.clip(chance_of(field, poses, fine), LEAST_CHANCE, p - 0.1)
    rival = np.maximum(q, RIVAL * p)
    # Its own sample is free: that something is there once is no evidence.
    odds = (log_odds(hit, p, rival) * counts).sum(axis=0) - np.log(p / rival)
    odds = along_curves(odds, fine, ALONG)
    odds = _whole_fragments(odds, fine, probe, pose_of * len(field.network) + field.network.curve_of[sample])
    good = (odds > 0) & ((hit & counts).sum(axis=0) >= 1) & (2 * counts.sum(axis=0) >= len(poses))
    keep = _hanging_together(fine, odds, good, thing)
    if keep is None:
        return None
    q[_running_on(field, poses, fine, hit)] = 1.0
    fine, q = fine.take(keep), q[keep]
    shown = float((field.targets(poses, fine) >= 0).mean())
    return replace(thing, probe=fine, chance=q, shown=float(np.clip(shown, *SHOWN)))


def _running_on(field, poses, probe, hit):
    """(m,) bool, points of curves that run on from most poses that show them to the next: a moulding, a ring. They
    tell nothing where they are shown, and so nothing where they are not.

    hit : (k, m) bool, which poses show each point
    """
    if len(poses) < 2:
        return np.zeros(len(probe), bool)
    centres = poses[:, :3, :3] @ probe.points.mean(axis=0) + poses[:, :3, 3]
    base = poses[beside(centres)]
    slides = sliding(field, between(poses, base), probe.moved(base))
    return 2 * (slides & hit).sum(axis=0) > hit.sum(axis=0)


def chance_at(field: Field, poses, probe: Probe):
    """(m,) float64, the chance of each point at the poses of a thing; 1 where it runs on from pose to pose."""
    q = np.maximum(chance_of(field, poses, probe), LEAST_CHANCE)
    q[_running_on(field, poses, probe, field.targets(poses, probe) >= 0)] = 1.0
    return q


SHOWN = 0.35, 0.75
"""Bounds of the share that an occurrence shows. Measured on chosen curves it runs upward; below the lower bound
anything would be explained."""


def _owners(field, thing, taken):
    """(n,) int64, the pose that owns each sample, -1 for none."""
    near = field.targets(thing.poses, thing.probe)
    label = np.full(len(field), -1)
    for k in range(len(thing.poses))[::-1]:
        label[near[k][near[k] >= 0]] = k
    label = field.watershed(label)
    label[taken] = -1
    return label


def _taken_back(probe: Probe, back) -> Probe:
    turn = lambda x: None if x is None else np.einsum("nij,nj->ni", back[:, :3, :3], x)  # noqa: E731
    return Probe(turn(probe.points) + back[:, :3, 3], turn(probe.tangents), turn(probe.normals), probe.kind)


def _representatives(probe: Probe, pose_of):
    """Points of the overlay about SPACING apart, where most poses show one, moved onto the mean of those around."""
    i, j = cKDTree(probe.points).query_pairs(1.5, output_type="ndarray").T
    own = np.arange(len(probe))
    i, j = np.r_[i, j, own], np.r_[j, i, own]
    same = np.abs((probe.tangents[i] * probe.tangents[j]).sum(axis=1)) > 0.8
    i, j = i[same], j[same]
    m = len(probe)
    seen = np.unique(i * (pose_of.max() + 1) + pose_of[j])
    poses_near = np.bincount(seen // (pose_of.max() + 1), minlength=m)
    count = np.bincount(i, minlength=m)
    chosen = spread(probe.points, poses_near + 1e-3 * count, SPACING)
    place = np.full(m, -1)
    place[chosen] = np.arange(len(chosen))
    use = place[i] >= 0
    offset = probe.points[j[use]] - probe.points[i[use]]
    line = probe.tangents[i[use]]
    offset -= (offset * line).sum(axis=1)[:, None] * line
    row = place[i[use]]
    mean = np.stack([np.bincount(row, offset[:, c], minlength=len(chosen)) for c in range(3)], axis=1)
    fine = probe.take(chosen)
    return replace(fine, points=fine.points + mean / np.bincount(row, minlength=len(chosen))[:, None])


def spread(points, key, radius):
    """Indices of a set of points none of which is within the radius of another, the greatest key first."""
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    rank = np.empty(len(points), np.int64)
    rank[np.argsort(-key, kind="stable")] = np.arange(len(points))
    a, b = pairs.T
    early, late = np.where(rank[a] < rank[b], a, b), np.where(rank[a] < rank[b], b, a)
    kept, dead = np.zeros(len(points), bool), np.zeros(len(points), bool)
    # In rounds: who has no living earlier neighbour is kept, and its later neighbours go.
    while True:
        live = ~kept & ~dead
        if not live.any():
            return np.flatnonzero(kept)
        open_ = live[early] & live[late]
        early, late = early[open_], late[open_]
        blocked = np.zeros(len(points), bool)
        blocked[late] = True
        new = live & ~blocked
        kept |= new
        dead[late[new[early]]] = True


def joined(a: Probe, b: Probe, spacing) -> Probe:
    """The points of two probes, none within a spacing (edge lengths) of another; the earlier ones stay."""
    pick = lambda x, y: None if x is None else np.concatenate([x, y])  # noqa: E731
    both = Probe(
        pick(a.points, b.points), pick(a.tangents, b.tangents), pick(a.normals, b.normals), pick(a.kind, b.kind)
    )
    return both.take(spread(both.points, -np.arange(len(both)), spacing))


def _counts_at(field, poses, fine, owner, hit):
    """(k, m) bool, whether the place of each point at each pose belongs to that pose, or to none and is empty."""
    _, node_of = field.graph
    at = fine.moved(poses).points
    distance, near = field.tree.query(at.reshape(-1, 3), distance_upper_bound=10.0)
    far = np.isinf(distance).reshape(hit.shape)
    label = owner[np.where(np.isinf(distance), 0, near)].reshape(hit.shape)
    return far | (label == np.arange(len(poses))[:, None]) | ((label == -1) & ~hit)


def _whole_fragments(odds, fine, probe, fragment):
    """Log odds with those of fragments that pay as a whole, and of which enough does, lifted above 0."""
    distance, near = cKDTree(fine.points).query(probe.points)
    _, fragment = np.unique(fragment, return_inverse=True)
    use = distance < 1.25 * SPACING
    count = np.bincount(fragment)
    total = np.bincount(fragment[use], odds[near[use]], minlength=len(count))
    share = np.bincount(fragment[use], odds[near[use]] > 0, minlength=len(count)) / count
    whole = (total > 0) & (share > 0.35)
    lift = near[use & whole[fragment] & (distance < 0.75 * SPACING)]
    odds = odds.copy()
    odds[lift] = np.maximum(odds[lift], 0.1)
    return odds


def _hanging_together(fine, odds, good, thing):
    """Indices of the good points that hang together with the present thing, or None."""
    keep = np.flatnonzero(good)
    if len(keep) < LEAST_POINTS:
        return None
    piece = _parts(fine.points[keep], 5.0)
    worth = np.bincount(piece, odds[keep] * SPACING / UNIT)[piece] > PIECE
    keep = keep[worth]
    if len(keep) < LEAST_POINTS:
        return None
    part = _parts(fine.points[keep], CONNECTED)
    home = cKDTree(thing.points).query(fine.points[keep])[0] < 3
    keep = keep[part == np.bincount(part, home).argmax()]
    return keep if len(keep) >= LEAST_POINTS else None


def _parts(points, gap):
    pairs = cKDTree(points).query_pairs(gap, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    return connected_components(graph, directed=False)[1]
