# SPDX-License-Identifier: GPL-3.0-or-later
"""The cheapest words for a set of poses: free ones, or an orbit (minimum description length).

A free pose costs six numbers. In an orbit only the generators do; each pose then costs next to nothing, and so does
each empty cell. Step, closure, shear, gaps and sub-grids are the same question: what is cheapest.

In: the poses of a thing. Out: an Orbit, whose kind is "single" where nothing is cheaper than free poses.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.motions import exponential, inverse, screw_velocity
from .lattices import grids
from .orbits import NEAR, NEIGHBOURS, PAIRS, SMALL_TURN, Orbit

POSE, NUMBER, CELL = 25.0, 4.2, 0.7
"""Cost in nats of a free pose, of one number of a generator, and of a cell, full or empty (one bit)."""

LEAST = 4
"""Poses from which on an orbit says that others are none of it: three lie in a row often enough."""

SMALL_PITCH, LONGEST = 4.0, 64
"""Edge lengths below which a generator may be no slide, and most steps of an orbit (a count that bounds the work)."""

CLOSE, MOSTLY = 0.08, 0.6
"""Share of a step by which a rotation that closes a circle may be off, and the share of its cells that must be seen."""


def describe(thing) -> Orbit:
    """The cheapest description of the poses of a thing (`poses`, `embedded`, `centres`)."""
    poses = thing.poses
    best, least = _single(poses), len(poses) * POSE
    if len(poses) < 3:
        return best
    for orbit in [*_one_generator(thing), *grids(thing)]:
        orbit = with_strands(thing, orbit)
        cost = description_length(orbit, len(poses))
        if cost < least - 1e-6:
            best, least = orbit, cost
    return best


def saving(thing) -> float:
    """Nats that a thing saves: log odds of its poses but the first, less what it costs to say where they are; one
    pose saves nothing."""
    if len(thing.poses) < 2:
        return 0.0
    orbit = thing.orbit
    said = len(thing.poses) * POSE if orbit.kind == "single" else description_length(orbit, len(thing.poses))
    return float(thing.scores[1:].sum() - (said - POSE))


def worth_saying(thing):
    """The thing without the poses beside its orbit that tell less than it takes to say where they are."""
    if len(thing.poses) < LEAST or (thing.scores[1:] >= POSE).all():
        return thing
    orbit = thing.orbit
    worth = orbit.fits | (thing.scores >= POSE)
    worth[0] |= not orbit.fits.any()
    return thing if orbit.kind == "single" or worth.all() else thing.at(np.flatnonzero(worth))


def description_length(orbit: Orbit, count, pose=POSE) -> float:
    """Nats that describe `count` poses by an orbit and the rest as free ones; pose : nats of a free one."""
    numbers = {"translation": 3, "grid": 6, "rotation": 5, "screw": 6}[orbit.kind]
    if orbit.closed:
        numbers -= 1
    return pose * (len(orbit.bases) + count - orbit.fits.sum()) + NUMBER * numbers + CELL * orbit.spans


def with_strands(thing, orbit: Orbit) -> Orbit:
    """The orbit with what recurs under its generators from other bases: seats of the next row, the other wing."""
    keys, strand, bases = orbit.keys.copy(), orbit.strand.copy(), list(orbit.bases)
    vectors = thing.embedded(thing.poses)
    high = orbit.extent[:, 1]
    axes = [np.arange(orbit.order)] if orbit.closed else [np.arange(-2 * h - 2, 2 * h + 3) for h in high]
    powers = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
    motions = orbit.power(powers)
    for k in range(len(vectors)):
        if strand[k] >= 0:
            continue
        gap, at = cKDTree(thing.embedded(motions @ thing.poses[k])).query(vectors)
        mine = (gap < NEAR) & (strand < 0)
        mine[mine] &= _first_of_each(at[mine], gap[mine])
        if mine.sum() >= 2:
            strand[mine], keys[mine] = len(bases), powers[at[mine]]
            bases.append(thing.poses[k])
    return replace(orbit, keys=keys, strand=strand, bases=np.array(bases))


def _single(poses) -> Orbit:
    """The motion from the first pose to the nearest other one, with no cells; none of a pose alone."""
    if len(poses) < 2:
        return Orbit("single", np.zeros((1, 6)), np.zeros((1, 1), np.int64), np.full(1, -1), poses[:1])
    gap = np.linalg.norm(poses[1:, :3, 3] - poses[0, :3, 3], axis=1)
    step = poses[1 + int(gap.argmin())] @ inverse(poses[0])
    if np.linalg.det(step[:3, :3]) < 0:
        twist = np.zeros((1, 6))
    else:
        twist = np.concatenate(screw_velocity(step[None]), axis=1)
    keys = np.zeros((len(poses), 1), np.int64)
    return Orbit("single", twist, keys, np.full(len(poses), -1), poses[:1])


def _one_generator(thing):
    """Orbits of one generator, from the motions between poses near each other."""
    poses, centres = thing.poses, thing.centres()
    near = cKDTree(centres).query(centres, k=min(NEIGHBOURS + 1, len(poses)))[1][:, 1:]
    i, j = np.repeat(np.arange(len(poses)), near.shape[1]), near.ravel()
    steps = poses[j] @ inverse(poses[i])
    proper = np.linalg.det(steps[:, :3, :3]) > 0
    i, steps = i[proper], steps[proper]
    for members in _equal_steps(thing, i, steps):
        # A row may be longer from another of its poses: the first, the middle and the last one are asked.
        for m in np.unique(members[[0, len(members) // 2, -1]]):
            fitted = [_walked(thing, kind, twist, i[m]) for kind, twist in _kinds(steps[m], centres[i[m]])]
            fitted = [orbit for orbit in fitted if orbit is not None]
            yield from fitted
            if any(orbit.fits.sum() >= len(members) for orbit in fitted):
                break


def _equal_steps(thing, base, steps):
    """Lists of indices of steps (s, 4, 4) from base poses (s,) that are one motion or its inverse, most first."""
    left, out = np.arange(len(steps)), []
    while len(left) and len(out) < PAIRS:
        start = thing.poses[base[left]]
        there = thing.embedded(steps[left] @ start)
        like = np.zeros((len(left), len(left)), bool)
        for a, k in enumerate(left):
            for one in (steps[k], inverse(steps[k])):
                like[a] |= ((thing.embedded(one @ start) - there) ** 2).sum(axis=1) < NEAR**2
        best = int(like.sum(axis=1).argmax())
        out.append(left[like[best]])
        left = left[~like[best]]
    return out


def _kinds(step, centre):
    """What a step may be: (kind, twist), the simplest first."""
    twist = np.concatenate(screw_velocity(step[None]), axis=1)[0]
    angle = np.linalg.norm(twist[:3])
    if angle < np.radians(SMALL_TURN):
        yield "translation", np.concatenate([np.zeros(3), step[:3, :3] @ centre + step[:3, 3] - centre])
    if angle > np.radians(1.0):
        axis = twist[:3] / angle
        pitch = axis @ twist[3:]
        if abs(pitch) < SMALL_PITCH:
            yield "rotation", np.concatenate([twist[:3], twist[3:] - pitch * axis])
        if abs(pitch) > 1.0:
            yield "screw", twist


def _walked(thing, kind, twist, base):
    """The orbit of a twist about one pose: powers are followed further and further, and the twist fitted to them."""
    vectors = thing.embedded(thing.poses)
    angle = np.linalg.norm(twist[:3])
    most = min(LONGEST, int(2 * np.pi / angle) if kind == "rotation" else LONGEST)
    start, reach, keys, hit = thing.poses[base], 2, None, None
    for _ in range(12):
        powers = np.arange(-reach, reach + 1)
        there = thing.embedded(exponential(powers[:, None] * twist) @ start)
        gap, at = cKDTree(there).query(vectors)
        hit, keys = gap < NEAR, powers[at]
        if hit.sum() < 3:
            return None
        twist, start = _fitted(thing, kind, twist, start, keys[hit], thing.poses[hit])
        if reach >= most:
            break
        reach = min(2 * reach, most)
    closed, order = _closure(kind, twist, keys[hit])
    if closed:
        twist = twist * (2 * np.pi / order / np.linalg.norm(twist[:3]))
        there = thing.embedded(exponential(np.arange(order)[:, None] * twist) @ start)
        gap, keys = cKDTree(there).query(vectors)
        hit = gap < NEAR
    hit &= _first_of_each(keys, gap)
    if hit.sum() < 3:
        return None
    if not closed:
        low = keys[hit].min()
        keys, start = keys - low, exponential(low * twist[None])[0] @ start
    return Orbit(kind, twist[None], keys[:, None], np.where(hit, 0, -1), start[None], closed, order)


def _first_of_each(keys, gap):
    """(k,) bool, of the poses of each cell the nearest."""
    order = np.lexsort((gap, keys))
    first = np.ones(len(keys), bool)
    first[order] = np.r_[True, np.diff(keys[order]) != 0]
    return first


def _closure(kind, twist, keys):
    """Whether a rotation closes a circle, and its order."""
    if kind != "rotation":
        return False, 0
    angle = np.linalg.norm(twist[:3])
    order = int(round(2 * np.pi / angle))
    if order < 3 or abs(2 * np.pi / angle - order) * angle > CLOSE * angle * order:
        return False, 0
    return len(np.unique(keys % order)) >= MOSTLY * order, order


def _fitted(thing, kind, twist, start, keys, poses, rounds=2, small=1e-5):
    """Twist and first pose whose powers come nearest to the poses: Gauss and Newton on the embedded poses."""
    target = thing.embedded(poses)

    def residuals(twists, starts):
        """(v, 12 k) float64, for v twists (v, 6) and first poses (v, 4, 4) at a time."""
        there = exponential((twists[:, None] * keys[:, None]).reshape(-1, 6)).reshape(len(twists), -1, 4, 4)
        vectors = thing.embedded((there @ starts[:, None]).reshape(-1, 4, 4))
        return (vectors.reshape(len(twists), *target.shape) - target).reshape(len(twists), -1)

    def moved(changes):
        twists = np.array([_kept_kind(kind, twist, change[:6]) for change in changes])
        return twists, exponential(changes[:, 6:]) @ start

    for _ in range(rounds):
        # Without a change, and with each of the twelve.
        all_ = residuals(*moved(np.concatenate([np.zeros((1, 12)), small * np.eye(12)])))
        now, jacobian = all_[0], (all_[1:] - all_[0]).T / small
        scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-9)
        step = -np.linalg.lstsq(jacobian / scale, now, rcond=1e-6)[0] / scale
        twists, starts = moved(step[None])
        if (residuals(twists, starts)[0] ** 2).sum() >= (now**2).sum():
            break
        twist, start = twists[0], starts[0]
    return twist, start


def _kept_kind(kind, twist, change):
    """The changed twist (6,) without the turn or the slide that its kind has not."""
    new = twist + change
    if kind == "translation":
        new[:3] = 0
    if kind == "rotation":
        axis = new[:3] / max(np.linalg.norm(new[:3]), 1e-12)
        new[3:] -= axis * (axis @ new[3:])
    return new
