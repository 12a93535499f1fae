# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners that smoothing rounded off, found again behind the short pieces that it made of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from . import shapes
from .breakpoints import NUMBERS
from .chain import Chain, distances, first_chain, fit_chain
from .costs import LEAST
from .samples import Samples

GENTLE = 0.45
"""Radians up to which a joint may be tangent in truth; sharper ones are corners."""

ROUNDED, SHORT = 0.75, 4.0
"""How far smoothing over `blur` takes points from a corner, with some reserve, and how long a piece it can make of one;
multiples of `blur`."""


def allowed(samples: Samples, chain: Chain, blur: float) -> np.ndarray:
    """(n,) float64, how far each sample may be off: more where it belongs to a corner."""
    owned = np.zeros(len(samples.points), bool)
    for a, b in chain.ranges:
        owned[a:b] = True
    return np.where(owned, samples.bound, max(samples.bound, ROUNDED * blur))


STRAY = 1.5
"""How far a corner may lie from what smoothing left of it, in `blur`: a right angle is rounded by 0.56 of it."""


def strays(samples: Samples, chain: Chain, blur: float) -> np.ndarray:
    """(k,) bool, pieces that go where no sample is, as lines do that meet far behind a narrow turn."""
    tree = cKDTree(samples.points)
    limit = max(2 * samples.bound, STRAY * blur) + 1.5 * samples.spacing
    out = np.zeros(len(chain.kinds), bool)
    for i, (kind, (a, b)) in enumerate(zip(chain.kinds, chain.ranges)):
        points = shapes.at(kind, chain.row(i), np.linspace(0, 1, max(33, 2 * int(b - a))))
        out[i] = tree.query(points)[0].max() > limit
    return out


def gathered(samples, pieces, longest):
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


def turned(samples, chain, i):
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


def part(chain, members):
    """Some neighbouring pieces as an open chain of their own."""
    j = [*members, (members[-1] + 1) % len(chain.joints)]
    return Chain(
        chain.kinds[members], chain.ranges[members], False, np.zeros(len(j), bool), chain.joints[j],
        tuple(chain.own[i] for i in members),
    )  # fmt: skip


def fitted(samples, chain):
    return fit_chain(samples.points, chain, variance=samples.variance)


def dimension(samples):
    return 2 if samples.plane else 3


def sharpened(samples, chain, blur):
    """The chain with corners in the place of what smoothing made of them.

    A short piece between two that meet close to it goes; then the samples about each corner have no say.
    """
    if chain.closed:
        for _ in range(len(chain.kinds)):
            count = len(chain.kinds)
            if count > 3:
                chain = _without(samples, chain, 1, blur)
            samples, chain = turned(samples, chain, 0 if len(chain.kinds) < count else 1)
    else:
        for i in reversed(range(1, len(chain.kinds) - 1)):
            chain = _without(samples, chain, i, blur)
    trim = int(np.ceil(1.5 * blur / samples.spacing))
    inner = chain.ranges + np.where(chain.kinds[:, None] > 0, [[trim, -trim]], 0)
    inner = np.where(np.diff(inner, axis=1) >= 2 * trim, inner, chain.ranges)
    core = _simpler(samples, replace(chain, ranges=inner), moved=bool((inner != chain.ranges).any()))
    same = (core.kinds == chain.kinds)[:, None]
    if not same.all():
        chain = fitted(samples, replace(core, ranges=np.where(same, chain.ranges, inner)))
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


def _simpler(samples, chain, moved=True):
    """The chain, fitted, with the cheapest kind for each piece now that the corners have no say.

    moved : its ranges are others than it was fitted to
    """
    kinds, own, changed = chain.kinds.copy(), list(chain.own), fitted(samples, chain) if moved else chain
    numbers = NUMBERS[dimension(samples)]
    for i, (a, b) in enumerate(chain.ranges):
        for kind in range(kinds[i]):
            one = first_chain(samples.points, np.array([kind]), np.array([[a, b]]), False)
            one = fitted(samples, one)
            gain = samples.price * (numbers[kinds[i]] - numbers[kind])
            if one.unexplained[0] - changed.unexplained[i] < gain:
                kinds[i], own[i] = kind, one.own[0]
                break
    return changed if (kinds == chain.kinds).all() else fitted(samples, replace(chain, kinds=kinds, own=tuple(own)))


def _without(samples, chain, i, blur):
    """The chain without piece i, if its neighbours meet near the samples of it; otherwise as it was."""
    a, b = chain.ranges[i]
    k = len(chain.kinds)
    around = [i - 1, i + 1]
    length = (b - a) * samples.spacing
    rest = samples.spacing * np.diff(chain.ranges[around], axis=1).min()
    if length > SHORT * blur or rest < length:
        return chain
    pair = part(chain, around)
    joints = chain.joints[[around[0], i, (around[1] + 1) % len(chain.joints)]].copy()
    joints[1] = samples.points[a:b].mean(axis=0)
    pair = fitted(samples, replace(pair, joints=joints))
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
    return fitted(samples, out)
