# SPDX-License-Identifier: GPL-3.0-or-later
"""The shortest description of one curve: pieces found, fitted together, made tangent, merged and sharpened."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from .breakpoints import NUMBERS, find_pieces
from .chain import Chain, distances, first_chain
from .corners import GENTLE, SHORT, allowed, dimension, fitted, gathered, part, sharpened, strays, turned
from .costs import LEAST, Moments, arc_cost, cubic_cost, line_cost
from .samples import Samples


def describe(samples: Samples, *, blur: float = 0.0) -> tuple[Samples, Chain | None]:
    """The chain of pieces with the least cost whose samples are all within its bound.

    blur : length over which the curve was smoothed; corners are looked for behind what that rounds off

    Returns the samples, where closed from another first one on, and the chain; None where no such chain was found:
    then only the polyline itself is true to its samples.
    """
    pieces = find_pieces(samples.points, variance=samples.variance, dimension=dimension(samples))
    if blur > 0:
        found, chain = _chain(*gathered(samples, pieces, SHORT * blur), blur)
        if chain is not None and not _off(found, chain, blur).any() and not strays(found, chain, blur).any():
            return found, chain
    kinds, knots = pieces.kinds, pieces.knots
    for finer in (1, 4, 16, 64):
        found, chain = _chain(samples, kinds, knots, 0.0, merge=finer == 1)
        if chain is None:
            break
        off = _off(found, chain, 0.0)
        for a, b in chain.ranges[strays(found, chain, 0.0)]:
            off[a:b] = True
        if not off.any():
            return found, chain
        samples, chain = found, replace(chain, tangent=np.zeros_like(chain.tangent))
        kinds, knots = _split(samples, chain, off, samples.variance / finer / 4)
    return samples, None


def _off(samples, chain, blur):
    """(n,) bool, samples that are further from the chain than they may be."""
    return samples.off(distances(samples.points, chain)) > allowed(samples, chain, blur)


def cost(samples: Samples, chain: Chain) -> float:
    """What the chain leaves unexplained, and what its numbers cost."""
    numbers = NUMBERS[dimension(samples)][chain.kinds].sum() - _saved(samples) * chain.tangent.sum()
    return float(chain.unexplained.sum() + samples.price * numbers)


def _chain(samples, kinds, knots, blur, merge=True):
    ranges = np.stack([knots[:-1], knots[1:]], axis=1)
    if samples.closed and len(kinds) == 1:
        middle = len(samples.points) // 2
        kinds, ranges = np.repeat(kinds, 2), np.array([[0, middle], [middle, len(samples.points)]])
        if middle < LEAST[kinds[0]]:
            return samples, None
    chain = fitted(samples, first_chain(samples.points, kinds, ranges, samples.closed))
    if blur > 0:
        samples, chain = sharpened(samples, chain, blur)
    for _ in range(merge * (1 + samples.closed)):
        merged = _merged(samples, chain)
        chain = chain if merged is chain else fitted(samples, merged)
        samples, chain = turned(samples, chain, len(chain.kinds) // 2 if samples.closed else 0)
    tangent = _tangent_joints(samples, chain)
    if tangent.any():
        chain = fitted(samples, replace(chain, tangent=tangent))
    return samples, chain


def _saved(samples):
    """Numbers that a tangent joint saves."""
    return 1 if samples.plane else 2


def from_corner(samples: Samples, blur: float = 0.0) -> Samples:
    """A closed curve that begins where it turns most: at a knot of it, or amid what smoothing made of a corner."""
    n, p = len(samples.points), samples.points
    at, reach = np.arange(n), max(2, n // 40)
    if blur > 0:
        reach = max(reach, int(2 * blur / samples.spacing))
    else:
        pieces = find_pieces(p, variance=samples.variance, dimension=dimension(samples))
        at = pieces.knots[1:-1] if len(pieces.knots) > 2 else at
    before, after = p[(at - 1) % n] - p[(at - 1 - reach) % n], p[(at + reach) % n] - p[at % n]
    size = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return samples.rolled(at[((before * after).sum(axis=1) / np.maximum(size, 1e-300)).argmin()])


def _tangent_joints(samples, chain):
    """(j,) bool, joints at which going on straight costs less than a direction of its own."""
    out = np.zeros(len(chain.joints), bool)
    k = len(chain.kinds)
    angles = chain.angles()
    worth = samples.price * _saved(samples)
    for joint in range(0 if chain.closed else 1, k):
        before = (joint - 1) % k
        if before == joint or angles[joint] > GENTLE or not (chain.kinds[[before, joint]] > 0).any():
            continue
        if chain.ranges[joint, 0] < chain.ranges[before, 1]:  # where a closed curve was cut
            out[joint] = angles[joint] < 0.15
            continue
        pair = part(chain, [before, joint])
        free = fitted(samples, pair)
        kept = fitted(samples, replace(free, tangent=np.array([False, True, False])))
        out[joint] = kept.unexplained.sum() <= free.unexplained.sum() + worth
    return out


def _merged(samples, chain):
    """The chain with neighbours made one piece wherever that costs less."""
    numbers = NUMBERS[dimension(samples)]

    # Most neighbours are the same after two others were made one.
    @cache
    def least(kind, a, b):
        return _least_left(samples.points[a:b], kind)

    @cache
    def fit(kind, a, b):
        return fitted(samples, first_chain(samples.points, np.array([kind]), np.array([[a, b]]), False))

    @cache
    def is_near(kind, a, b):
        return _within(samples, fit(kind, a, b))

    while len(chain.kinds) > (2 if chain.closed else 1):
        best, found = 1e-9, None
        for i in range(len(chain.kinds) - 1):
            pair = chain.unexplained[[i, i + 1]].sum() + samples.price * (numbers[chain.kinds[[i, i + 1]]].sum())
            pair -= samples.price * _saved(samples)
            a, b = int(chain.ranges[i, 0]), int(chain.ranges[i + 1, 1])
            for kind in range(3):
                gain = pair - samples.price * numbers[kind]
                if gain <= best or b - a < LEAST[kind] or least(kind, a, b) > 2 * gain * samples.variance:
                    continue
                one = fit(kind, a, b)
                if gain - one.unexplained[0] > best and is_near(kind, a, b):
                    best, found = gain - one.unexplained[0], (i, one)
        if found is None:
            return chain
        chain = _joined(chain, *found)
    return chain


def _least_left(points, kind):
    """What a piece of a kind leaves of points at least, by what is known without fitting it."""
    moments, a, b = Moments.of(points), np.array([0]), np.array([len(points)])
    if kind == 2:
        return cubic_cost(moments, a, b)[0] / LOOSE
    left, mean, spread = line_cost(moments, a, b)
    return (arc_cost(moments, a, b, mean, spread) if kind == 1 else left)[0]


LOOSE = 50
"""How much more a cubic in the sample's number may leave than the best Bezier segment."""


def _within(samples, one):
    """Whether a single piece is near enough to all its samples."""
    a, b = one.ranges[0]
    off = distances(samples.points[a:b], replace(one, ranges=one.ranges - a))
    return (np.hypot(off, samples.height[a:b]) <= samples.bound).all()


def _joined(chain, i, one):
    """The chain with one piece in the place of pieces i and i + 1."""
    return Chain(
        np.r_[chain.kinds[:i], one.kinds, chain.kinds[i + 2 :]],
        np.r_[chain.ranges[:i], one.ranges, chain.ranges[i + 2 :]],
        chain.closed, np.delete(chain.tangent, i + 1), np.delete(chain.joints, i + 1, axis=0),
        (*chain.own[:i], *one.own, *chain.own[i + 2 :]),
        np.r_[chain.unexplained[:i], one.unexplained, chain.unexplained[i + 2 :]],
    )  # fmt: skip


def _split(samples, chain, off, variance):
    """Kinds and knots with a finer description of the pieces that are too far off."""
    kinds, knots = [], [0]
    bounds = np.r_[0, (chain.ranges[:-1, 1] + chain.ranges[1:, 0] + 1) // 2, len(samples.points)]
    for kind, a, b in zip(chain.kinds, bounds[:-1], bounds[1:]):
        if off[a:b].any() and b - a > 3:
            part = find_pieces(samples.points[a:b], variance=variance, dimension=dimension(samples))
            kinds.extend(part.kinds)
            knots.extend(a + part.knots[1:])
        else:
            kinds.append(kind)
            knots.append(b)
    return np.array(kinds), np.array(knots)
