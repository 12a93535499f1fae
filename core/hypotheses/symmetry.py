# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetric cores: a square fits onto another in eight ways. What is around it says which one is right."""

from __future__ import annotations

from dataclasses import replace

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

BETTER, TURNED = 8, 0.5
"""Samples by which a way round shows more: two observations of curve each in four directions; and by how much the trace
of the turn from pose to pose must grow where two ways show as much (tolerance: a turn by 40 degrees)."""


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


def oriented(field: Field, thing: Hypothesis, taken) -> Hypothesis:
    """The thing with each pose turned the way that carries what is around the best pose, and of ways that carry as much
    the one that is turned least from the pose beside; itself where none turns."""
    ways = symmetries(thing)
    if len(ways) < 2:
        return thing
    near = field.targets(thing.poses, thing.probe)
    label = np.full(len(field), -1)
    for k in range(len(thing))[::-1]:
        label[near[k][near[k] >= 0]] = k
    label = field.watershed(label)
    label[taken] = -1
    best = int((near >= 0).mean(axis=1).argmax())
    sample = np.flatnonzero(label == best)
    back = inverse(thing.poses[best])
    at = field.points[sample] @ back[:3, :3].T + back[:3, 3]
    sample = sample[cKDTree(thing.points).query(at)[0] < AROUND]
    if len(sample) < FEWEST:
        return thing
    around = field.probe(sample[:: max(1, len(sample) // 300)])
    around = replace_frame(around, back)
    weight = len(sample) / len(around)
    centres = thing.centres()
    poses, changed = thing.poses.copy(), False
    done, left = [best], [k for k in range(len(thing)) if k != best]
    while left:
        # From pose to pose, so that ways that show as much are told by the pose beside.
        gap = np.linalg.norm(centres[left][:, None] - centres[done][None], axis=2)
        k, beside = np.unravel_index(gap.argmin(), gap.shape)
        k, beside = left.pop(k), done[beside]
        done.append(k)
        tries = align(field, poses[k] @ ways, around, radii=(4.0, 2.5, 2.0))
        shown = field.targets(tries, around)
        mine = np.append(np.flatnonzero(np.linalg.norm(centres - centres[k], axis=1) < 10), -1)
        count = ((shown >= 0) & np.isin(label[shown], mine)).sum(axis=1) * weight
        like = np.einsum("wij,ij->w", tries[:, :3, :3], poses[beside, :3, :3])
        like[count < count.max() - BETTER] = -np.inf
        way = int(like.argmax())
        if way and like[way] > like[0] + TURNED:
            poses[k], changed = tries[way], True
    return replace(thing, poses=poses) if changed else thing


def replace_frame(probe, back):
    """A probe of the network in a frame; `back` (4, 4) leads from the network to the frame."""
    moved = probe.moved(back[None])
    return type(probe)(
        moved.points[0], moved.tangents[0], None if moved.normals is None else moved.normals[0], moved.kind
    )
