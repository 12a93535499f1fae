# SPDX-License-Identifier: GPL-3.0-or-later
"""Growth of a thing from a seed: more poses, then more curves, in turn, while the score rises."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align
from ..evidence.decoys import SHIFTS, decoys, slipped
from ..evidence.field import Field
from ..geometry.motions import inverse
from ..transformations.description import worth_saying
from .extent import chance_at, extended
from .hypothesis import Hypothesis, distinct, explained, pose_scores
from .seeding import Seeds
from .symmetry import oriented

CAREFUL, EAGER = (25.0, 6.0), (10.0, 1.0)
"""Prices of a pose: the log odds that it must have, and what each other prediction of it by two others takes off that.
A careful one names six numbers, each of which could be anything in the scene; an eager one is the best of some thousand
candidates. At an eager price small things find their many weak poses, and large ones fall apart into what repeats
within them; where both come to something, that which saves more is taken."""

ORBIT_POSE = 7.0
"""Least price of a pose, that of one that an orbit predicts."""

PROMINENT = 5.0
"""Log odds by which a pose must beat its own shifts."""

PARTIAL = 0.5
"""Share of what an occurrence typically shows that each must show: what shows less is another thing's."""

SAME_POSE, NEAR_SEED = 6.0, 4.0
"""RMS edge lengths within which poses are one, and edge lengths within which a seed starts in a thing."""

REACHES, WIDE = (20.0, 40.0), 90.0
"""Edge lengths that a thing grows by in the first rounds, and in the last."""

TRIED, FINE, SAMPLED, CLOSURES = 1_500, 150, (16, 120), 16
"""Candidates that are looked at, those that are scored in full, points that all are looked at with and those of these
that are likely, and poses whose closures are formed; counts that bound the work."""


def grown(
    field: Field, thing: Hypothesis, seeds: Seeds, taken, reaches, *, price=CAREFUL, pairs=None, tick=lambda: None
) -> Hypothesis | None:
    """The thing after a round of growth for each reach (0 keeps its curves); None where it comes to nothing.

    pairs : PointPairs, to look for poses in the whole network; None asks the seeds alone
    """
    for reach in reaches:
        tick()
        if reach:
            thing = extended(field, thing, taken, reach=reach)
            if thing is None:
                return None
        thing = worth_saying(_with_poses(field, thing, seeds, taken, price, pairs))
        if len(thing) < 2:
            return None
        if reach:
            thing = oriented(field, thing, taken)
    return thing


def _with_poses(field, thing, seeds, taken, price, pairs):
    """The thing with its poses aligned, more poses, and without those that do not pay."""
    thing = replace(thing, poses=align(field, thing.poses, thing.probe, radii=(2.5, 2.0)))
    more = with_more_poses(field, thing, seeds, taken, price, pairs.poses(thing) if pairs else None)
    return rescored(field, more, taken)


def full_grown(
    field: Field, thing: Hypothesis, seeds: Seeds, taken, *, price=CAREFUL, rounds=3, pairs=None, tick=lambda: None
) -> Hypothesis:
    """The thing grown until its poses do not change.

    pairs : PointPairs, to look for poses in the whole network, and to turn each pose as all the others say; None asks
        the seeds alone
    """
    for _ in range(rounds):
        tick()
        wider = extended(field, thing, taken, reach=WIDE)
        if wider is None:
            break
        wider = _with_poses(field, wider, seeds, taken, price, pairs)
        if pairs is None:
            wider = worth_saying(wider)
        if len(wider) < 2:
            break
        turned = oriented(field, wider, taken, by_all=pairs is not None)
        if turned is not wider:
            thing = rescored(field, turned, taken)
            continue
        done = len(wider) == len(thing)
        thing = wider
        if done:
            break
    return thing


def with_more_poses(field: Field, thing: Hypothesis, seeds: Seeds, taken, price=CAREFUL, more=None) -> Hypothesis:
    """The thing with the poses that seeds and closures lead to and the score accepts, best first.

    more : (k, 4, 4) float64, other candidates
    """
    poses, witnesses = _candidates(thing, seeds, field)
    if more is not None:
        poses, witnesses = np.concatenate([poses, more]), np.concatenate([witnesses, np.ones(len(more))])
    if not len(poses):
        return thing
    owned = taken | explained(field, thing)
    for points, most, least in zip(SAMPLED, (4 * TRIED, TRIED), (0.15, 0.3)):
        rough = thing.probe.take(np.arange(0, len(thing.probe), max(1, len(thing.probe) // points)))
        near = field.targets(poses, rough, 1.75 * field.radius)
        share = ((near >= 0) & ~owned[near]).mean(axis=1)
        order = np.argsort(-share, kind="stable")[:most]
        order = order[share[order] > least * thing.shown]
        poses, witnesses, share = poses[order], witnesses[order], share[order]
    order = distinct(thing, poses, share + 0.02 * np.minimum(witnesses, 4), gap=3.0)[:FINE]
    if not len(order):
        return thing
    poses, witnesses = align(field, poses[order], rough, radii=(4.0, 2.5, 2.0)), witnesses[order]
    cost = np.maximum(price[0] - price[1] * (np.minimum(witnesses, 4) - 1), ORBIT_POSE)
    score = pose_scores(field, thing, poses, owned, beside=thing.poses)[0]
    good = np.flatnonzero(score > cost)
    poses, cost, score = align(field, poses[good], thing.probe, radii=(2.5, 2.0)), cost[good], score[good]
    good = np.flatnonzero(prominence(field, thing, poses, owned) >= PROMINENT)
    return accepted(field, thing, poses[good], cost[good], owned)


def accepted(field, thing, poses, cost, owned):
    """The thing with those of the poses (k, 4, 4) that pay, the best first, each sample explained once."""
    known, scores, costs = [thing.poses], [thing.scores], [thing.cost]
    alive, touched = np.ones(len(poses), bool), np.ones(len(poses), bool)
    score, centres = np.zeros(len(poses)), thing.centres(poses)
    reach = 2 * np.linalg.norm(thing.points - thing.points.mean(axis=0), axis=1).max() + 2 * field.radius
    while alive.any():
        left = np.flatnonzero(alive & touched)
        score[left] = pose_scores(field, thing, poses[left], owned, beside=np.concatenate(known))[0]
        alive[left] = score[left] > cost[left]
        if not alive.any():
            break
        best = int(np.where(alive, score - cost, -np.inf).argmax())
        alive[best] = False
        known.append(poses[best : best + 1])
        scores.append(score[best : best + 1])
        costs.append(cost[best : best + 1])
        owned = owned | explained(field, thing, poses[best : best + 1])
        # Farther ones share no sample with it.
        touched = np.linalg.norm(centres - centres[best], axis=1) < reach
    return replace(thing, poses=np.concatenate(known), scores=np.concatenate(scores), cost=np.concatenate(costs))


def posed(thing: Hypothesis, poses) -> Hypothesis:
    """The thing at other poses (k, 4, 4), all but the first at the least price; they are not scored yet."""
    cost = np.full(len(poses), ORBIT_POSE)
    cost[0] = 0.0
    return replace(thing, poses=poses, scores=np.zeros(len(poses)), cost=cost)


def prominence(field, thing, poses, owned):
    """(k,) float64, by how much poses (k, 4, 4) beat their own shifts."""
    wrong = decoys(poses, thing.points.mean(axis=0), thing.tangents)[:, :SHIFTS]
    wrong = np.concatenate([wrong, slipped(poses, thing.points, thing.tangents)], axis=1)
    score = pose_scores(field, thing, poses, owned)[0]
    beside = pose_scores(field, thing, wrong.reshape(-1, 4, 4), owned)[0].reshape(len(poses), wrong.shape[1])
    return score - beside.max(axis=1)


def _candidates(thing, seeds, field):
    """Poses (k, 4, 4) that seeds and closures lead to, and how many say so of each."""
    source = field.points[seeds.source]
    tree = cKDTree(thing.points)
    out = [np.zeros((0, 4, 4))]
    for pose in thing.poses:
        back = inverse(pose)
        inside = np.isfinite(tree.query(source @ back[:3, :3].T + back[:3, 3], distance_upper_bound=NEAR_SEED)[0])
        out.append(seeds.motions[inside] @ pose)
    poses = np.concatenate(out)
    witnesses = np.ones(len(poses))
    if len(thing) >= 3:
        more, many = closures(thing)
        poses, witnesses = np.concatenate([poses, more]), np.concatenate([witnesses, many])
    return poses, witnesses


def closures(thing):
    """Poses (k, 4, 4) that what leads from one pose to another predicts, and how many predictions agree on each."""
    poses = thing.poses[:CLOSURES]
    k = len(poses)
    steps = poses[:, None] @ inverse(poses)[None]
    i, j, m = (x.ravel() for x in np.meshgrid(*[np.arange(k)] * 3, indexing="ij"))
    use = (i != j) & (j != m)
    predicted = steps[i[use], j[use]] @ poses[m[use]]
    vectors = thing.embedded(predicted)
    return predicted, cKDTree(vectors).query_ball_point(vectors, SAME_POSE, return_length=True)


def rescored(field: Field, thing: Hypothesis, taken) -> Hypothesis:
    """The thing with the scores of its poses in order, each sample explained once; without those that do not pay."""
    owned = taken.copy()
    kept, scores = [], []
    for k in range(len(thing)):
        pose = thing.poses[k : k + 1]
        known = thing.poses[kept] if kept else None
        score, terms, near = pose_scores(field, thing, pose, owned, beside=known)
        if kept:
            hit, tells = (near[0] >= 0) & (terms[0] > 0), terms[0] != 0
            if score[0] < max(thing.cost[k], ORBIT_POSE) or hit.sum() < PARTIAL * thing.shown * tells.sum():
                continue
        kept.append(k)
        scores.append(score[0])
        owned |= explained(field, thing, pose)
    out = replace(thing.at(kept), scores=np.array(scores))
    return replace(out, cost=np.maximum(out.cost, ORBIT_POSE))


def appraised(field: Field, thing: Hypothesis, taken) -> Hypothesis:
    """The thing with chance measured at the poses that it has now: things of other growths are held against it."""
    if len(thing) < 2:
        return thing
    return rescored(field, replace(thing, chance=chance_at(field, thing.poses, thing.probe)), taken)
