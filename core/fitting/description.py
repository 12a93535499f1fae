# SPDX-License-Identifier: GPL-3.0-or-later
"""The shortest description of one curve: pieces found, fitted together, made tangent, merged and sharpened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .breakpoints import NUMBERS, find_pieces
from .chain import Chain, distances, first_chain, fit_chain
from .costs import LEAST, Moments, arc_cost, cubic_cost, line_cost
from .samples import Samples

GENTLE = 0.45
"""Radians up to which a joint may be tangent in truth; sharper ones are corners."""

ROUNDED, SHORT = 0.75, 4.0
"""How far smoothing over `blur` takes points from a corner, with some reserve, and how long a piece it can make of one;
multiples of `blur`."""


def describe(samples: Samples, *, blur: float = 0.0) -> tuple[Samples, Chain | None]:
    """The chain of pieces with the least cost whose samples are all within its bound.

    blur : length over which the curve was smoothed; corners are looked for behind what that rounds off

    Returns the samples, where closed from another first one on, and the chain; None where no such chain was found:
    then only the polyline itself is true to its samples.
    """
    pieces = find_pieces(samples.points, variance=samples.variance, dimension=_dimension(samples))
    if blur > 0:
        found, chain = _chain(*_gathered(samples, pieces, SHORT * blur), blur)
        if chain is not None and not _off(found, chain, blur).any():
            return found, chain
    kinds, knots = pieces.kinds, pieces.knots
    for finer in (1, 4, 16, 64):
        found, chain = _chain(samples, kinds, knots, 0.0, merge=finer == 1)
        if chain is None:
            break
        off = _off(found, chain, 0.0)
        if not off.any():
            return found, chain
        samples, chain = found, replace(chain, tangent=np.zeros_like(chain.tangent))
        kinds, knots = _split(samples, chain, off, samples.variance / finer / 4)
    return samples, None


def _off(samples, chain, blur):
    """(n,) bool, samples that are further from the chain than they may be."""
    return samples.off(distances(samples.points, chain)) > allowed(samples, chain, blur)


def allowed(samples: Samples, chain: Chain, blur: float) -> np.ndarray:
    """(n,) float64, how far each sample may be off: more where it belongs to a corner."""
    owned = np.zeros(len(samples.points), bool)
    for a, b in chain.ranges:
        owned[a:b] = True
    return np.where(owned, samples.bound, max(samples.bound, ROUNDED * blur))


def cost(samples: Samples, chain: Chain) -> float:
    """What the chain leaves unexplained, and what its numbers cost."""
    numbers = NUMBERS[_dimension(samples)][chain.kinds].sum() - _saved(samples) * chain.tangent.sum()
    return float(chain.unexplained.sum() + samples.price * numbers)


def _chain(samples, kinds, knots, blur, merge=True):
    ranges = np.stack([knots[:-1], knots[1:]], axis=1)
    if samples.closed and len(kinds) == 1:
        middle = len(samples.points) // 2
        kinds, ranges = np.repeat(kinds, 2), np.array([[0, middle], [middle, len(samples.points)]])
        if middle < LEAST[kinds[0]]:
            return samples, None
    chain = _fitted(samples, first_chain(samples.points, kinds, ranges, samples.closed))
    if blur > 0:
        samples, chain = _sharpened(samples, chain, blur)
    for _ in range(merge * (1 + samples.closed)):
        merged = _merged(samples, chain)
        chain = chain if merged is chain else _fitted(samples, merged)
        samples, chain = _turned(samples, chain, len(chain.kinds) // 2 if samples.closed else 0)
    tangent = _tangent_joints(samples, chain)
    if tangent.any():
        chain = _fitted(samples, replace(chain, tangent=tangent))
    return samples, chain


def _gathered(samples, pieces, longest):
    """Samples, kinds and knots with runs of short pieces as one, up to a longest; a closed curve begins with its
    longest piece."""
    kinds, size = pieces.kinds, np.diff(pieces.knots)
    if samples.closed:
        i = int(size.argmax())
        samples, kinds, size = samples.rolled(pieces.knots[i]), np.roll(kinds, -i), np.roll(size, -i)
    most = longest / samples.spacing
    found = [(kinds[0], size[0])]
    for kind, count in zip(kinds[1:], size[1:]):
        if max(count, found[-1][1]) <= most / 2 and len(found) > 1:
            found[-1] = 0, found[-1][1] + count
        else:
            found.append((kind, count))
    kinds, size = zip(*found)
    return samples, np.array(kinds), np.r_[0, np.cumsum(size)]


def _turned(samples, chain, i):
    """A closed curve and its chain from piece i on."""
    if not i:
        return samples, chain
    first = chain.ranges[i, 0]
    n = len(samples.points)
    ranges = np.roll(chain.ranges, -i, axis=0) - first
    ranges[len(ranges) - i :] += n
    own = (*chain.own[i:], *chain.own[:i])
    kinds, tangent = np.roll(chain.kinds, -i), np.roll(chain.tangent, -i)
    left = None if chain.unexplained is None else np.roll(chain.unexplained, -i)
    return samples.rolled(first), Chain(kinds, ranges, True, tangent, np.roll(chain.joints, -i, axis=0), own, left)


def _fitted(samples, chain):
    return fit_chain(samples.points, chain, variance=samples.variance)


def _dimension(samples):
    return 2 if samples.plane else 3


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
        pieces = find_pieces(p, variance=samples.variance, dimension=_dimension(samples))
        at = pieces.knots[1:-1] if len(pieces.knots) > 2 else at
    before, after = p[(at - 1) % n] - p[(at - 1 - reach) % n], p[(at + reach) % n] - p[at % n]
    size = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return samples.rolled(at[((before * after).sum(axis=1) / np.maximum(size, 1e-300)).argmin()])


def _part(chain, members):
    """Some neighbouring pieces as an open chain of their own."""
    j = [*members, (members[-1] + 1) % len(chain.joints)]
    return Chain(
        chain.kinds[members], chain.ranges[members], False, np.zeros(len(j), bool), chain.joints[j],
        tuple(chain.own[i] for i in members),
    )  # fmt: skip


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
        pair = _part(chain, [before, joint])
        free = _fitted(samples, pair)
        kept = _fitted(samples, replace(free, tangent=np.array([False, True, False])))
        out[joint] = kept.unexplained.sum() <= free.unexplained.sum() + worth
    return out


def _merged(samples, chain):
    """The chain with neighbours made one piece wherever that costs less."""
    numbers = NUMBERS[_dimension(samples)]
    while len(chain.kinds) > (2 if chain.closed else 1):
        best, found = 1e-9, None
        for i in range(len(chain.kinds) - 1):
            pair = chain.unexplained[[i, i + 1]].sum() + samples.price * (numbers[chain.kinds[[i, i + 1]]].sum())
            pair -= samples.price * _saved(samples)
            a, b = chain.ranges[i, 0], chain.ranges[i + 1, 1]
            for kind in range(3):
                gain = pair - samples.price * numbers[kind]
                if gain <= best or b - a < LEAST[kind] or _hopeless(samples, kind, a, b, gain):
                    continue
                one = _fitted(samples, first_chain(samples.points, np.array([kind]), np.array([[a, b]]), False))
                if gain - one.unexplained[0] > best and _within(samples, one):
                    best, found = gain - one.unexplained[0], (i, one)
        if found is None:
            return chain
        chain = _joined(chain, *found)
    return chain


def _hopeless(samples, kind, a, b, gain):
    """Whether a piece from sample a to b, by what is known without fitting it, leaves far more than may be left."""
    moments, a, b = Moments.of(samples.points[a:b]), np.array([0]), np.array([b - a])
    left, mean, spread = line_cost(moments, a, b)
    if kind == 1:
        left = arc_cost(moments, a, b, mean, spread)
    if kind == 2:
        left = cubic_cost(moments, a, b) / LOOSE
    return left[0] > 2 * gain * samples.variance


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


def _sharpened(samples, chain, blur):
    """The chain with corners in the place of what smoothing made of them.

    A short piece between two that meet close to it goes; then the samples about each corner have no say.
    """
    if chain.closed:
        for _ in range(len(chain.kinds)):
            count = len(chain.kinds)
            if count > 3:
                chain = _without(samples, chain, 1, blur)
            samples, chain = _turned(samples, chain, 0 if len(chain.kinds) < count else 1)
    else:
        for i in reversed(range(1, len(chain.kinds) - 1)):
            chain = _without(samples, chain, i, blur)
    trim = int(np.ceil(1.5 * blur / samples.spacing))
    inner = chain.ranges + np.where(chain.kinds[:, None] > 0, [[trim, -trim]], 0)
    inner = np.where(np.diff(inner, axis=1) >= 2 * trim, inner, chain.ranges)
    core = _simpler(samples, replace(chain, ranges=inner))
    same = (core.kinds == chain.kinds)[:, None]
    if not same.all():
        chain = _fitted(samples, replace(core, ranges=np.where(same, chain.ranges, inner)))
    ranges = chain.ranges.copy()
    angles, k = chain.angles(), len(chain.kinds)
    for joint in range(0 if chain.closed else 1, k):
        before = (joint - 1) % k
        if angles[joint] < GENTLE or before == joint:
            continue
        for piece, side, way in ((before, 1, -1), (joint, 0, 1)):
            spare = int(ranges[piece, 1] - ranges[piece, 0] - max(LEAST[chain.kinds[piece]], 4))
            ranges[piece, side] += way * max(0, min(trim, spare))
    return samples, _simpler(samples, replace(chain, ranges=ranges)) if (ranges != chain.ranges).any() else chain


def _simpler(samples, chain):
    """The chain, fitted, with the cheapest kind for each piece now that the corners have no say."""
    kinds, own, changed = chain.kinds.copy(), list(chain.own), _fitted(samples, chain)
    numbers = NUMBERS[_dimension(samples)]
    for i, (a, b) in enumerate(chain.ranges):
        for kind in range(kinds[i]):
            one = first_chain(samples.points, np.array([kind]), np.array([[a, b]]), False)
            one = _fitted(samples, one)
            gain = samples.price * (numbers[kinds[i]] - numbers[kind])
            if one.unexplained[0] - changed.unexplained[i] < gain:
                kinds[i], own[i] = kind, one.own[0]
                break
    return changed if (kinds == chain.kinds).all() else _fitted(samples, replace(chain, kinds=kinds, own=tuple(own)))


def _without(samples, chain, i, blur):
    """The chain without piece i, if its neighbours meet near the samples of it; otherwise as it was."""
    a, b = chain.ranges[i]
    k = len(chain.kinds)
    around = [i - 1, i + 1]
    length = (b - a) * samples.spacing
    rest = samples.spacing * np.diff(chain.ranges[around], axis=1).min()
    if length > SHORT * blur or rest < length:
        return chain
    pair = _part(chain, around)
    joints = chain.joints[[around[0], i, (around[1] + 1) % len(chain.joints)]].copy()
    joints[1] = samples.points[a:b].mean(axis=0)
    pair = _fitted(samples, replace(pair, joints=joints))
    row = replace(pair, ranges=np.array([[chain.ranges[around[0], 0], a], [b, chain.ranges[around[1], 1]]]))
    first = row.ranges[0, 0]
    off = distances(samples.points[first : row.ranges[1, 1]], replace(row, ranges=row.ranges - first))
    if off[a - first : b - first].max() > max(ROUNDED * blur, samples.bound) or pair.angles()[1] < GENTLE:
        return chain
    keep = np.delete(np.arange(k), i)
    joints = chain.joints.copy()
    joints[(i + 1) % len(joints)] = pair.joints[1]
    out = Chain(
        chain.kinds[keep], chain.ranges[keep], chain.closed, np.delete(chain.tangent, i),
        np.delete(joints, i, axis=0), tuple(chain.own[j] for j in keep),
    )  # fmt: skip
    return _fitted(samples, out)


def _split(samples, chain, off, variance):
    """Kinds and knots with a finer description of the pieces that are too far off."""
    kinds, knots = [], [0]
    bounds = np.r_[0, (chain.ranges[:-1, 1] + chain.ranges[1:, 0] + 1) // 2, len(samples.points)]
    for kind, a, b in zip(chain.kinds, bounds[:-1], bounds[1:]):
        if off[a:b].any() and b - a > 3:
            part = find_pieces(samples.points[a:b], variance=variance, dimension=_dimension(samples))
            kinds.extend(part.kinds)
            knots.extend(a + part.knots[1:])
        else:
            kinds.append(kind)
            knots.append(b)
    return np.array(kinds), np.array(knots)
