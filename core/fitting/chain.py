# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of a curve fitted together: they share their joints, and where they are tangent they stay so."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import shapes
from .shapes import OWN

ROUNDS, SOFT, STIFF, HOLD, ENOUGH = 14, 3.0, 1e3, 0.03, 0.01
"""Most steps of Gauss and Newton; the weight of a tangent joint beside that of the samples, at first and at last; of an
inner joint's first place, a share of a sample's, for what the samples leave open; the gain that ends the steps."""


@dataclass(frozen=True)
class Chain:
    """Pieces in a row, each with the samples it explains.

    kinds : (k,) int64, 0 line, 1 arc, 2 Bezier segment
    ranges : (k, 2) int64, samples from and to (exclusive) of each piece; samples between ranges belong to a corner
    closed : the last piece ends where the first begins
    tangent : (j,) bool, joints at which the direction goes on; joint i is where piece i begins
    joints : (j, 3) float64, k of them where closed, otherwise k + 1
    own : the own numbers of each piece, see `shapes`
    unexplained : (k,) float64, sum of squared distances of each piece's samples, over the variance
    """

    kinds: np.ndarray
    ranges: np.ndarray
    closed: bool
    tangent: np.ndarray
    joints: np.ndarray
    own: tuple[np.ndarray, ...]
    unexplained: np.ndarray | None = None

    def row(self, i) -> np.ndarray:
        return np.concatenate([self.joints[i], self.joints[(i + 1) % len(self.joints)], self.own[i]])

    def primitives(self) -> tuple:
        return tuple(shapes.primitive(kind, self.row(i)) for i, kind in enumerate(self.kinds))

    def angles(self) -> np.ndarray:
        """(j,) float64, by how much the direction turns at each joint, radians; 0 at open ends."""
        tangents = np.array([shapes.ends(kind, self.row(i)) for i, kind in enumerate(self.kinds)])
        out = np.zeros(len(self.joints))
        cosine = (tangents[:-1, 1] * tangents[1:, 0]).sum(axis=1)
        out[1 : len(self.kinds)] = np.arccos(np.clip(cosine, -1, 1))
        if self.closed:
            out[0] = np.arccos(np.clip(tangents[-1, 1] @ tangents[0, 0], -1, 1))
        return out


def first_chain(points, kinds, ranges, closed) -> Chain:
    """The chain before it is fitted: joints half way between the samples of two pieces."""
    k = len(kinds)
    joints = np.zeros((k if closed else k + 1, 3))
    before, after = ranges[:-1, 1] - 1, ranges[1:, 0]
    joints[1:k] = (points[before] + points[after]) / 2
    if closed:
        joints[0] = (points[ranges[-1, 1] - 1] + points[ranges[0, 0]]) / 2
    else:
        joints[0], joints[-1] = points[ranges[0, 0]], points[ranges[-1, 1] - 1]
    chain = Chain(np.asarray(kinds), np.asarray(ranges), closed, np.zeros(len(joints), bool), joints, ())
    own = []
    for i, (kind, (a, b)) in enumerate(zip(kinds, ranges)):
        q, _ = shapes.first_guess(kind, points[a:b], joints[i], joints[(i + 1) % len(joints)])
        own.append(q[6:])
    return replace(chain, own=tuple(own))


def fit_chain(points, chain: Chain, *, variance, held=None) -> Chain:
    """The chain with the least squared distances of its samples across its pieces.

    Parameters
    ----------
    held : (j,) bool, joints that stay where they are, or None
    variance : of one sample along one axis

    Notes
    -----
    Gauss and Newton's method with Levenberg's damping. What a sample is off along its piece does not count.
    """
    sigma = np.sqrt(variance)
    size = max(float(np.ptp(points, axis=0).max()), 1e-300)
    spacing = max(size / len(points), sigma)
    anchor, where, unexplained = chain.joints, None, None
    # A stiff joint at once would make the steps tiny: it is first made nearly tangent.
    for stiff in (SOFT, STIFF) if chain.tangent.any() else (STIFF,):
        chain, where, unexplained = _descend(
            lambda c, w, stiff=stiff: _equations(points, c, sigma, size, spacing, anchor, w, stiff),
            chain, where, _free(chain, held),
        )  # fmt: skip
    return replace(chain, unexplained=unexplained)


def _descend(equations, chain, where, free):
    """The chain after the steps, where its samples are on it, and what it leaves unexplained."""
    damping = 1e-6
    system, gradient, cost, unexplained, where = equations(chain, where)
    for _ in range(ROUNDS):
        scale = np.sqrt(np.maximum(np.diag(system), 1e-12 * np.diag(system).max()))[free]
        matrix = system[free[:, None], free] / scale / scale[:, None] + damping * np.eye(len(free))
        step = np.zeros(len(system))
        step[free] = np.linalg.solve(matrix, -gradient[free] / scale) / scale
        moved = _moved(chain, step)
        found = equations(moved, where)
        if found[2] > cost * (1 + 1e-12):
            damping = max(damping * 30, 1e-4)
            if damping > 1e4:
                break
            continue
        gain = cost - found[2]
        chain, damping = moved, max(damping / 10, 1e-9)
        system, gradient, cost, unexplained, where = found
        if gain <= ENOUGH:
            break
    return chain, where, unexplained


def distances(points, chain: Chain) -> np.ndarray:
    """(n,) float64, of each sample from the nearest of the pieces about it, their ends taken as ends."""
    out = np.full(len(points), np.inf)
    k = len(chain.kinds)
    for i, kind in enumerate(chain.kinds):
        q = chain.row(i)
        a = chain.ranges[max(i - 1, 0), 0]
        b = chain.ranges[min(i + 1, k - 1), 1]
        # The corner at which a closed curve begins has samples on both sides of the cut.
        use = np.arange(len(points)) if chain.closed and i in (0, k - 1) else np.arange(a, b)
        before = None
        if kind == 2:
            grid = np.linspace(0, 1, 33)
            before = grid[((points[use][:, None] - shapes.at(2, q, grid)) ** 2).sum(axis=2).argmin(axis=1)]
        u = np.clip(shapes.nearest(kind, q, points[use], before, rounds=4), 0, 1)
        out[use] = np.minimum(out[use], np.linalg.norm(points[use] - shapes.at(kind, q, u), axis=1))
    return out


def _free(chain, held):
    """Numbers of the chain that may change: joints come first, three each, then what the pieces own."""
    count = 3 * len(chain.joints)
    fixed = np.zeros(count + sum(OWN[kind] for kind in chain.kinds), bool)
    if held is not None:
        fixed[:count] = np.repeat(held, 3)
    return np.flatnonzero(~fixed)


def _places(chain):
    """For each piece, which numbers of the chain are its row."""
    own = 3 * len(chain.joints) + np.cumsum([0, *(OWN[kind] for kind in chain.kinds)])
    for i in range(len(chain.kinds)):
        j = (i + 1) % len(chain.joints)
        yield np.array([*range(3 * i, 3 * i + 3), *range(3 * j, 3 * j + 3), *range(own[i], own[i + 1])])


def _moved(chain, step):
    count = 3 * len(chain.joints)
    own = np.cumsum([count, *(OWN[kind] for kind in chain.kinds)])
    return replace(
        chain,
        joints=chain.joints + step[:count].reshape(-1, 3),
        own=tuple(o + step[a:b] for o, a, b in zip(chain.own, own[:-1], own[1:])),
    )


def _equations(points, chain, sigma, size, spacing, anchor, where, stiff):
    """Normal equations at a chain: matrix, gradient, half of what is minimised times two, and where samples are."""
    count = 3 * len(chain.joints) + sum(OWN[kind] for kind in chain.kinds)
    system, gradient = np.zeros((count, count)), np.zeros(count)
    places, unexplained, now = list(_places(chain)), np.zeros(len(chain.kinds)), []
    for i, (kind, (a, b), rows) in enumerate(zip(chain.kinds, chain.ranges, places)):
        q, x = chain.row(i), points[a:b]
        before = shapes.first_guess(0, x, q[0:3], q[3:6])[1] if where is None else where[i]
        u, gap, matrix, pull = shapes.normal_equations(kind, q, x, before)
        now.append(u)
        system[rows[:, None], rows] += matrix / sigma**2
        gradient[rows] -= pull / sigma**2
        unexplained[i] = (gap * gap).sum() / sigma**2
    cost = unexplained.sum()
    own = np.arange(3 * len(chain.joints))
    off = (chain.joints - anchor).ravel()
    hold = np.full(len(own), HOLD / spacing)
    if not chain.closed:
        hold[[0, 1, 2, -3, -2, -1]] = 1 / spacing
    system[own, own] += hold**2
    gradient[own] += hold**2 * off
    cost += ((hold * off) ** 2).sum()
    cost += _tangency(chain, places, stiff * size / sigma, system, gradient)
    return system, gradient, cost, unexplained, now


def _tangency(chain, places, weight, system, gradient):
    """Adds the tangent joints to the equations; returns their cost."""
    cost = 0.0
    for joint in np.flatnonzero(chain.tangent):
        before, after = (joint - 1) % len(chain.kinds), joint % len(chain.kinds)
        qs = chain.row(before), chain.row(after)
        off = weight * (shapes.ends(chain.kinds[before], qs[0])[1] - shapes.ends(chain.kinds[after], qs[1])[0])
        slope = np.zeros((len(gradient), 3))
        np.add.at(slope, places[before], weight * shapes.end_slopes(chain.kinds[before], qs[0])[:, 1])
        np.add.at(slope, places[after], -weight * shapes.end_slopes(chain.kinds[after], qs[1])[:, 0])
        system += slope @ slope.T
        gradient += slope @ off
        cost += off @ off
    return cost
