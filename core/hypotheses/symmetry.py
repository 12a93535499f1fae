# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetric cores: a square fits onto another in eight ways. What is around it says which one is right."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align, turned
from ..evidence.field import Field
from ..geometry.motions import best_rotation, inverse, motion
from .hypothesis import Hypothesis, distinct

TURNS = 24
"""Turns about each main axis that are tried; count."""

SYMMETRIC, ROUGHLY = 0.6, 0.5
"""Share of the curves that a symmetry takes onto themselves, within 3 and, at first, within 6 edge lengths."""

AROUND, FEWEST = 40.0, 30
"""Edge lengths about a thing that tell, and fewest samples there."""

BETTER, ALIKE, TURNED = 8, 0.25, 0.5
"""Samples that a way round must show more in one other pose (two observations of curve); what each further pose adds
to that, for they show the same curves; and by how much the trace of the turn from pose to pose must grow where two ways
show as much (tolerance: a turn by 40 degrees)."""

SEEN, NEIGHBOURS, MANY, BESIDE = 2.0, 16, 120, 4
"""Edge lengths within which a sample is shown; samples beside it that are looked at, samples that stand for what is
around a pose, and poses beside that are asked; counts that bound the work."""


def symmetries(thing: Hypothesis):
    """(k, 4, 4), rigid motions of the frame that take the thing's curves onto themselves, the identity first."""
    step = max(1, len(thing.points) // 150)
    points, tangents = thing.points[::step], thing.tangents[::step]
    centre, tree = thing.points.mean(axis=0), cKDTree(thing.points)
    off = thing.points - centre
    axes = np.linalg.eigh(off.T @ off)[1].T
    angles = np.arange(TURNS) * 2 * np.pi / TURNS
    about = turned((axes[:, None] * angles[None, :, None]).reshape(-1, 3))
    flips = turned(np.roll(axes, -1, axis=0) * np.pi)
    rotations = np.concatenate([about, about @ np.repeat(flips, TURNS, axis=0)])
    tries = motion(rotations, centre - rotations @ centre)

    def share(motions, radius):
        at = points @ np.swapaxes(motions[:, :3, :3], 1, 2) + motions[:, None, :3, 3]
        distance, near = tree.query(at)
        line = tangents @ np.swapaxes(motions[:, :3, :3], 1, 2)
        same = np.abs((line * thing.tangents[near]).sum(-1)) > 0.8
        return ((distance < radius) & same).mean(axis=1)

    tries = tries[share(tries, 6.0) > ROUGHLY]
    for _ in range(4):
        at = points @ np.swapaxes(tries[:, :3, :3], 1, 2) + tries[:, None, :3, 3]
        distance, near = tree.query(at)
        w = (distance < 6.0).astype(float)[..., None]
        total = np.maximum(w.sum(axis=1), 1)
        a, b = (w * at).sum(axis=1) / total, (w * thing.points[near]).sum(axis=1) / total
        turn, _ = best_rotation(np.swapaxes(w * (thing.points[near] - b[:, None]), 1, 2) @ (at - a[:, None]))
        tries = motion(turn, b - np.einsum("kij,kj->ki", turn, a)) @ tries
    score = share(tries, 3.0)
    tries, score = tries[score > SYMMETRIC], score[score > SYMMETRIC]
    turns = np.linalg.norm(tries[:, :3, :3] - np.eye(3), axis=(1, 2)) > 0.2
    tries, score = tries[turns], score[turns]
    return np.concatenate([np.eye(4)[None], tries[distinct(thing, tries, score, gap=6.0)]])


def oriented(field: Field, thing: Hypothesis, taken, *, by_all=False) -> Hypothesis:
    """The thing with each pose turned the way that shows what the poses beside it show around them, and of ways that
    show as much the one that is turned least; itself where none turns.

    by_all : turn each as all the others say, where their word is clear
    """
    ways = symmetries(thing)
    if len(ways) < 2:
        return thing
    near = field.targets(thing.poses, thing.probe)
    around = _surroundings(field, thing, near, taken)
    best = int((near >= 0).mean(axis=1).argmax())
    if len(around[best]) < FEWEST:
        return thing
    thin = [max(1, -(-len(samples) // MANY)) for samples in around]
    # Of each pose all ways, fitted to the network: a symmetry holds roughly only.
    tries = np.stack([align(field, pose @ ways, thing.probe, radii=(4.0, 2.5, 2.0)) for pose in thing.poses])
    views = [
        _View(thin[k], [replace_frame(field.probe(around[k][:: thin[k]]), inverse(t)) for t in tries[k]])
        for k in range(len(thing))
    ]
    way = _by_all(thing, tries, views) if by_all else _from_pose_to_pose(thing, tries, views, best)
    if not way.any():
        return thing
    return replace(thing, poses=tries[np.arange(len(way)), way])


def _surroundings(field, thing, near, taken):
    """Of each pose the samples (list of int64) about the thing that are nearer to it than to the other poses.

    near : (k, m) int32, samples that show the thing at its poses
    """
    label = np.full(len(field), -1)
    for k in range(len(thing))[::-1]:
        label[near[k][near[k] >= 0]] = k
    label = field.watershed(label)
    label[taken] = -1
    tree, out = cKDTree(thing.points), []
    for k, pose in enumerate(thing.poses):
        sample, back = np.flatnonzero(label == k), inverse(pose)
        gap = tree.query(field.points[sample] @ back[:3, :3].T + back[:3, 3], distance_upper_bound=AROUND)[0]
        out.append(sample[np.isfinite(gap)])
    return out


@dataclass(frozen=True)
class _View:
    """What is around a pose, in the frame of the thing as each way shows it. stands : samples for each that is left;
    ways : a probe for each way"""

    stands: int
    ways: list


def _from_pose_to_pose(thing, tries, views, best):
    """(k,) int64, the way of each pose that agrees best with those of the poses before; of equal ones that which is
    turned least from the pose beside. From the best pose on, always the nearest that is left."""
    centres, way = thing.centres(), np.zeros(len(thing), np.int64)
    done, left = [best], [k for k in range(len(thing)) if k != best]
    while left:
        gap = np.linalg.norm(centres[left][:, None] - centres[done][None], axis=2)
        k, beside = np.unravel_index(gap.argmin(), gap.shape)
        left_at, k, beside = k, left.pop(k), done[beside]
        few = [done[j] for j in np.argsort(gap[left_at], kind="stable")[:BESIDE]]
        agree = _agreement(views[k], [views[j].ways[way[j]] for j in few])
        like = np.einsum("wij,ij->w", tries[k][:, :3, :3], tries[beside, way[beside], :3, :3])
        like[agree < agree.max() - _tells(len(few))] = -np.inf
        best_way = int(like.argmax())
        if like[best_way] > like[0] + TURNED:
            way[k] = best_way
        done.append(k)
    return way


def _by_all(thing, tries, views, rounds=6):
    """The ways (k,) after each pose was turned as all the others say, until none turns; of ways that they say alike the
    one that is turned least from the pose beside."""
    way = np.zeros(len(views), np.int64)
    centres = thing.centres()
    beside = cKDTree(centres).query(centres, k=2)[1][:, 1]
    for _ in range(rounds):
        before = way.copy()
        for k in range(len(way)):
            agree = _agreement(views[k], [views[j].ways[way[j]] for j in range(len(way)) if j != k])
            if agree.max() > agree[way[k]] + _tells(len(way) - 1):
                like = np.einsum("wij,ij->w", tries[k][:, :3, :3], tries[beside[k], way[beside[k]], :3, :3])
                like[agree < agree.max() - _tells(len(way) - 1)] = -np.inf
                way[k] = int(like.argmax())
        if (way == before).all():
            break
    return way


def _tells(others):
    """By how much more others must agree with one way than with another, for a count of others."""
    return BETTER * (1 + ALIKE * (others - 1))


def _agreement(view, others):
    """(w,) float64, of each way of a pose how many samples others (probes) show, all together."""
    points = np.concatenate([o.points for o in others])
    lines = np.concatenate([o.tangents for o in others])
    owner = np.repeat(np.arange(len(others)), [len(o) for o in others])
    out = np.zeros(len(view.ways))
    if not len(points):
        return out
    tree = cKDTree(points)
    for w, around in enumerate(view.ways):
        found = tree.query(around.points, k=NEIGHBOURS, distance_upper_bound=SEEN)
        hit = np.isfinite(found[0])
        near = np.where(hit, found[1], 0)
        hit &= np.abs((lines[near] * around.tangents[:, None]).sum(-1)) > 0.8
        who = np.sort(np.where(hit, owner[near], -1), axis=1)
        out[w] = (np.diff(who, axis=1) > 0).sum() + (who[:, 0] >= 0).sum()
    return out * view.stands


def replace_frame(probe, back):
    """A probe of the network in a frame; `back` (4, 4) leads from the network to the frame."""
    moved = probe.moved(back[None])
    return type(probe)(
        moved.points[0], moved.tangents[0], None if moved.normals is None else moved.normals[0], moved.kind
    )
