# SPDX-License-Identifier: GPL-3.0-or-later
"""Orbits (section 4.1.2, after Pauly et al. 2008): transformations that are powers of one or two generators."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .clustering import Clusters
from .geometry.motions import embed, exponential, inverse, motion, rotation_vector, screw_velocity
from .network.network import CurveNetwork
from .support import Screen

CANDIDATES, SEEDS, ROOTS, SAME = 100, 6, 12, 5.0
"""Motions that are looked at, those of them that are tried for each orbit, roots that are tried, and the RMS edge
lengths within which motions are one."""

SHARE, CLOSED_SHARE = 0.75, 0.5
"""Share of the support that a root must keep, and the first power of a rotation that closes a circle."""

CLOSE = 0.02, 0.06
"""Shares of a step by which a rotation that closes a circle may be off: at all, and where the closed one explains no
less."""

DISTINCT, ROWS, LIFT, MUTUAL = 0.25, 0.3, 1.35, 0.4
"""Share of its support by which a motion must stand out from those beside it (on a scan straight jambs and mouldings,
which support slides as well, are most of the length); share of the better supported generator's support that the
other generator of a grid must have; and by what factor more of what recurs along that one must recur along the first
than of the network, unless that share of it does (see `_Finder.one_lattice`)."""


@dataclass(frozen=True)
class Orbit:
    """A recurrence in the network's frame.

    kind : "single", "translation", "grid", "rotation" or "screw"
    twists : (g, 6) float64, one a generator: rotation vector w (radians a step) and velocity u at the origin
    count : (g,) int64, number of steps over which the recurrence is seen; of a closed rotation its order less one
    closed : whether the rotation's order brings it back to the start
    support : length that the powers of the generators explain together, edge lengths
    """

    kind: str
    twists: np.ndarray
    count: np.ndarray
    closed: bool
    support: float

    def power(self, k):
        """Motions (n, 4, 4) of the integer powers k (n, g). Translations commute; only they come in twos."""
        return exponential(np.asarray(k, float) @ self.twists)

    @property
    def generators(self):
        """(g, 4, 4) float64."""
        return exponential(self.twists)

    @property
    def powers(self):
        """(n, g) int64, all powers that may relate two cells, without the identity."""
        if self.closed:
            return np.arange(1, self.count[0] + 1)[:, None]
        axes = [np.arange(-c, c + 1) for c in self.count]
        k = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes))
        return k[(k != 0).any(axis=1)]


def detect_orbits(network: CurveNetwork, clusters: Clusters, screen: Screen, *, progress=None) -> list[Orbit]:
    """Orbits of the clusters, best supported first, singles among them.

    Clusters that are powers of an orbit's generators are part of it. A generator that is a multiple of the true
    step falls back to the step: the roots of a motion are tried, and the finest that keeps its share of the
    support is taken. A motion must explain something that no orbit before it does.
    """
    finder = _Finder(network, clusters, screen)
    limit = 1.2 * clusters.chance
    left = np.flatnonzero(clusters.support > limit)
    held = np.zeros(len(clusters))
    held[left] = screen.held(clusters.motions[left]) * doubts(clusters.motions[left], screen)
    left = left[np.argsort(-held[left], kind="stable")[:CANDIDATES]]
    distinct = finder.screen.prominence(clusters.motions[left])
    left = left[distinct > np.maximum(DISTINCT * clusters.support[left], 0.5 * clusters.chance)]
    total, found, tries = max(1, len(left)), [], {}
    while len(left) and len(found) < 40:
        # Any power of a generator may be the best supported motion; the orbit that explains most has the generator.
        seeds = left[:SEEDS][held[left[:SEEDS]] >= SHARE * held[left[0]]]
        for k in seeds:
            if k not in tries and not any(finder.has(tries[j], clusters.motions[k]) for j in seeds if j in tries):
                tries[k] = finder.orbit(clusters.motions[k], clusters.motions[left])
        orbit = max((o for k in seeds if (o := tries.get(k)) is not None), key=lambda o: o.support, default=None)
        if orbit is not None and not any(finder.contains(known, orbit) for known in found):
            found.append(orbit)
        left = left[1:] if orbit is not None else left[len(seeds) :]
        if orbit is not None and len(left):
            left = left[finder.beyond(orbit, clusters.motions[left]) > limit]
            finder.explain(orbit)
            left = left[finder.unexplained(clusters.motions[left]) > limit]
        if progress:
            progress("orbits", 1 - len(left) / total)
    return sorted(found, key=lambda o: -o.support)


HALF_TURN = 0.6
"""What the evidence for a half turn counts, where nothing tells the front of a thing from its back."""


def doubts(motions, screen):
    """(k,) float64, HALF_TURN for half turns, 1 for all else; 1 for all where the surface's outside is known.

    A nearly flat, mirror-symmetric thing maps onto itself and onto its neighbours by half a turn about its own axis
    just as by a translation. It does so in the data; as a template it would swap front and back.
    """
    if screen.normals is not None:
        return np.ones(len(motions))
    trace = np.trace(motions[:, :3, :3], axis1=1, axis2=2)
    return np.where((trace - 1) / 2 < np.cos(np.radians(175)), HALF_TURN, 1.0)


class _Finder:
    def __init__(self, network, clusters, screen):
        self.screen, self.chance = screen, clusters.chance
        self.spread = np.sqrt((network.weights @ network.points**2) / network.weights.sum())
        self.extent = np.ptp(network.points, axis=0)
        self.still = screen.still
        self.left = screen.weight.copy()

    def distance(self, a, b):
        return np.linalg.norm(embed(a, self.spread) - embed(b, self.spread), axis=1)

    def contains(self, known, orbit):
        """Whether the generators of an orbit are powers of those of a known one."""
        return all(self.has(known, generator) for generator in orbit.generators)

    def has(self, known, motion):
        """Whether a motion (4, 4) is a power of the generators of a known orbit, which may be None."""
        if known is None:
            return False
        powers = known.generators if known.kind == "single" else known.power(known.powers)
        powers = np.concatenate([powers, inverse(powers)])
        return bool(self.distance(np.broadcast_to(motion, powers.shape), powers).min() < SAME)

    def explain(self, orbit):
        """Take what an orbit explains off the length that is left to others."""
        powers = orbit.generators if orbit.kind == "single" else orbit.power(orbit.powers)
        self.left[self.screen.supported(np.concatenate([powers, inverse(powers)]))] = 0

    def unexplained(self, motions):
        """Length at either end of each motion that it explains and nothing found so far does."""
        return np.maximum(*(self.screen.score(m, weight=self.left) for m in (motions, inverse(motions))))

    def beyond(self, orbit, motions):
        """Support of motions by what neither is a power of the orbit's generators nor slips from one of them."""
        powers = orbit.generators if orbit.kind == "single" else orbit.power(orbit.powers)
        powers = np.concatenate([powers, inverse(powers)])
        gap = embed(motions, self.spread)[:, None] - embed(powers, self.spread)[None]
        gap = np.linalg.norm(gap, axis=2)
        support = self.screen.score(motions, beside=powers[gap.argmin(axis=1)])
        return np.where(gap.min(axis=1) < SAME, 0, support)

    def orbit(self, seed, others):
        """The orbit that a motion belongs to, or None where nothing of it is supported."""
        twist = np.concatenate(screw_velocity(seed[None]), axis=1)[0]
        twist, support = self.root(twist)
        twist, kind = self.simplify(twist)
        twist, count, closed, support = self.fit(twist, kind)
        if count == 0 or self.motion_of(twist[None])[0, 0] < 1.5 * self.still:
            return None
        if kind == "translation":
            grid = self.grid(twist, count, others)
            if grid is not None:
                return grid
        if count == 1 and not closed:
            kind = "single"
        return Orbit(kind, twist[None], np.array([count]), closed, support)

    def root(self, twist):
        """The finest root of a motion that keeps its share of the support, and its support."""
        k = np.arange(1, ROOTS + 1)
        k = k[np.linalg.norm(self.motion_of(twist / k[:, None]), axis=1) > 2 * self.still]
        k = k if len(k) else np.array([1])
        roots = self.screen.refine(exponential(twist / k[:, None]), 2)
        near = self.distance(roots, exponential(twist / k[:, None])) < SAME
        support = self.screen.prominence(roots)
        support = np.where(near, support, 0)
        fine = np.flatnonzero((support >= SHARE * support[0]) & (support > 0.5 * self.chance))
        best = fine[-1] if len(fine) else 0
        return np.concatenate(screw_velocity(roots[best : best + 1]), axis=1)[0], support[best]

    def motion_of(self, twists):
        """Mean way that the curves go along twists (n, 6), as vectors of its size over the axes."""
        m = exponential(twists) - np.eye(4)
        return np.stack([np.linalg.norm(embed(m, self.spread), axis=1)], axis=1)

    def simplify(self, twist):
        """A twist without the small turn of a translation or the small shift of a rotation, and its kind."""
        w, u = twist[:3], twist[3:]
        angle = np.linalg.norm(w)
        plain = self.screen.score(exponential(twist[None]))[0]
        if angle < np.radians(5):
            straight = np.concatenate([np.zeros(3), exponential(twist[None])[0, :3, 3]])
            m = self.screen.refine(exponential(straight[None]), 2)
            straight[3:] = m[0, :3, 3]
            if self.screen.score(exponential(straight[None]))[0] >= 0.9 * plain:
                return straight, "translation"
        axis = w / max(angle, 1e-12)
        pitch = axis @ u
        if abs(pitch) < 4:
            flat = np.concatenate([w, u - pitch * axis])
            if self.screen.score(exponential(flat[None]))[0] >= 0.9 * plain:
                return flat, "rotation"
        return twist, "screw"

    def fit(self, twist, kind):
        """Generator refined on all powers that are supported; (twist, steps, closed, support)."""
        angle = np.linalg.norm(twist[:3])
        size = self.motion_of(twist[None])[0, 0]
        if kind == "rotation":
            most = max(1, int(np.floor(2 * np.pi / angle + 0.25)) - 1)
        else:
            step = np.linalg.norm(twist[3:]) if kind == "translation" else abs(twist[:3] @ twist[3:]) / angle
            most = int(np.linalg.norm(self.extent) / max(step, self.still)) + 1
            most = min(most, 64)
        reach = 2
        while True:
            k = np.arange(1, min(reach, most) + 1)
            use = k[k * angle < np.radians(150)] if angle > 0 else k
            use = use if len(use) else k[:1]
            guess = exponential(twist * use[:, None])
            better = self.screen.refine(guess, 2)
            support = self.screen.score(better)
            good = (self.distance(better, guess) < SAME) & (support > self.chance)
            if good.any():
                twist = self.average(better[good], use[good], support[good], kind)
            if reach >= most or reach * angle > np.radians(150) or not good[-1]:
                break
            reach *= 2
        closed, order = False, 0
        if kind == "rotation":
            order = int(round(2 * np.pi / np.linalg.norm(twist[:3])))
            snapped = twist * (2 * np.pi / order / np.linalg.norm(twist[:3]))
            k = np.arange(1, order)
            seen = self.screen.score(exponential(snapped * k[:, None]))
            seen = seen > max(2 * self.chance, 0.3 * seen.max(initial=0))
            # A power and its inverse are one fact; what an open arc does not show are the powers half way round.
            seen = seen[(order - 1) // 4 : order - 1 - (order - 1) // 4]
            off = self.motion_of(twist[None] - snapped[None])[0, 0] / size
            near = off < CLOSE[0] or (off < CLOSE[1] and self.gains(twist, snapped))
            if order > 1 and seen.mean() >= 0.6 and near:
                closed, twist = True, snapped
        k = np.arange(1, (order - 1 if closed else most) + 1)
        support = self.screen.score(exponential(twist * k[:, None]))
        # Cells next to each other have most in common. Where the first step shows less than a later one, the later
        # one is the step, and the first is a root that only parts of the network follow. All powers of a closed
        # rotation are seen; one that shows more has a sub-lattice of its own.
        if support[0] < (CLOSED_SHARE if closed else SHARE) * support.max():
            return twist, 0, False, 0.0
        seen = support > 2 * self.chance
        if closed:
            return twist, order - 1, True, float(support.sum())
        # Steps are counted on until three in a row are missing: a motion far out may agree by chance.
        gaps = np.diff(np.concatenate([[0], k[seen], [most + 4]]))
        count = int(np.concatenate([[0], k[seen]])[np.flatnonzero(gaps > 3)[0]]) if len(gaps) else 0
        # Beyond half a turn a power is the inverse of another one, and would count twice.
        once = seen & (k * np.linalg.norm(twist[:3]) <= np.pi) if kind == "rotation" else seen
        return twist, count, False, float(2 * support[:count][once[:count]].sum())

    def gains(self, twist, other):
        """Whether the first powers of another twist explain as much as those of the given one: rings of roundels, which
        turn in their places, and ornaments that are round leave a step that is some degrees off."""
        k = np.arange(1, max(2, int(np.pi / np.linalg.norm(other[:3]))) + 1)[:, None]
        here, there = (self.screen.score(exponential(t * k)).sum() for t in (twist, other))
        return there >= here

    def average(self, motions, k, support, kind):
        """The twist whose powers k come nearest to the motions: least squares over log motion = k twist."""
        weight = support / support.sum()
        if kind == "translation":
            u = (weight * k) @ motions[:, :3, 3] / (weight @ k**2)
            return np.concatenate([np.zeros(3), u])
        twists = np.concatenate(screw_velocity(motions), axis=1)
        twist = (weight * k) @ twists / (weight @ k**2)
        if kind == "rotation":
            axis = twist[:3] / np.linalg.norm(twist[:3])
            twist[3:] -= axis * (axis @ twist[3:])
        return twist

    def grid(self, twist, count, others):
        """The grid of a translation and the best second one among the other motions, or None."""
        g0 = twist[3:]
        angle = np.linalg.norm(rotation_vector(others[:, :3, :3]), axis=1)
        v = others[angle < np.radians(3)][:, :3, 3]
        along = v @ g0 / (g0 @ g0)
        across = np.linalg.norm(v - along[:, None] * g0, axis=1)
        v = v[across > 2 * self.still][:5]
        best = None
        for candidate in v:
            g1 = candidate - np.round(candidate @ g0 / (g0 @ g0)) * g0
            i, k = (x.ravel() for x in np.meshgrid(np.arange(-1, 4), np.arange(1, 5)))
            use = (i < k) & ((k > 1) | (i <= 1))
            i, k = i[use], k[use]
            tries = (g1 + i[:, None] * g0) / k[:, None]
            use = np.linalg.norm(tries, axis=1) > 2 * self.still
            tries, k = tries[use], k[use]
            m = self.screen.refine(self.shift(tries), 2)
            near = np.linalg.norm(m[:, :3, 3] - tries, axis=1) < SAME
            # A lattice vector is judged by its whole row of cells: a slip along straight parts hides one of them.
            rows = near * sum(
                self.screen.score(self.shift(m[:, :3, 3] + j * g0), beside=self.shift([j * g0] * len(m)))
                for j in (-1, 0, 1)
            )
            top = rows.max()
            if top <= 3 * self.chance:
                continue
            row = np.concatenate([self.shift(m[:, :3, 3] + j * g0) for j in (-1, 0, 1)])
            distinct = (self.screen.prominence(row) > DISTINCT * self.screen.score(row)).reshape(3, -1).sum(axis=0)
            rows = rows * (distinct >= 2)
            top = rows.max()
            if top <= 3 * self.chance:
                continue
            fine = rows >= SHARE * top
            pick = np.flatnonzero(fine & (k == k[fine].max()))
            pick = pick[np.argmax(rows[pick])]
            if best is None or rows[pick] > best[0]:
                best = (rows[pick], m[pick, :3, 3])
        if best is None:
            return None
        return self.fit_grid(g0, count, best[1])

    @staticmethod
    def shift(v):
        return motion(np.broadcast_to(np.eye(3), (len(v), 3, 3)), v)

    def fit_grid(self, g0, count, g1):
        g = np.stack([g0, g1])
        reach = np.array([min(count, 8), 2])
        for _ in range(2):
            g = self.reduce(g)
            k = self.half(reach)
            guess = self.shift(k @ g)
            better = self.screen.refine(guess, 2)
            support = self.screen.score(better)
            good = (self.distance(better, guess) < SAME) & (support > self.chance)
            if good.sum() >= 2 and np.linalg.matrix_rank(k[good]) == 2:
                w = np.sqrt(support[good])[:, None]
                g = np.linalg.lstsq(w * k[good], w * better[good][:, :3, 3], rcond=None)[0]
            span = np.linalg.norm(self.extent)
            reach = np.minimum((span / np.linalg.norm(g, axis=1)).astype(int) + 1, 24)
            support = self.screen.score(self.shift(self.half(reach) @ g))
            seen = self.half(reach)[support > self.chance]
            reach = np.abs(seen).max(axis=0) if len(seen) else np.array([1, 1])
            reach = np.maximum(reach, 1)
        # A lattice is more than two motions that happen to be translations: most of its vectors recur.
        inside = (np.abs(self.half(reach)) <= np.maximum(reach // 2, 1)).all(axis=1)
        support = self.screen.score(self.shift(self.half(reach) @ g))
        seen = support > self.chance
        if seen.sum() < 4 or seen[inside].mean() < 0.6 or np.linalg.norm(g, axis=1).min() < 2 * self.still:
            return None
        if not self.one_lattice(g):
            return None
        total = 2 * float(support[seen].sum())
        twists = np.concatenate([np.zeros((2, 3)), g], axis=1)
        return Orbit("grid", twists, reach, False, total)

    def one_lattice(self, g):
        """Whether two translations (2, 3) are generators of one lattice.

        Floors that are alike in part only are no rows of one lattice: folded onto each other they would mix. Of the
        cells of a lattice the same curves recur both ways. Where sills and jambs chance to fit those of another floor,
        they recur along the floor no more often than any other curve does.
        """
        each = self.screen.score(self.shift(g))
        if each.min() < ROWS * each.max():
            return False
        weight = self.screen.weight
        both_ways = [self.screen.supported(self.shift(np.stack([v, -v])), specific=True) for v in g]
        a, b = sorted(both_ways, key=lambda seen: weight @ seen)
        share, usual = weight @ (a & b) / max(weight @ a, 1e-9), weight @ b / weight.sum()
        return share >= min(MUTUAL, LIFT * usual)

    @staticmethod
    def reduce(g):
        """Shortest basis of the lattice (Gauss)."""
        a, b = g
        while True:
            if a @ a > b @ b:
                a, b = b, a
            n = np.round(a @ b / (a @ a))
            if n == 0 or abs(a @ b) <= 0.5001 * (a @ a):
                return np.stack([a, b])
            b = b - n * a

    @staticmethod
    def half(reach):
        """Powers of two generators up to `reach`, one of each pair of inverses."""
        k = np.stack(np.meshgrid(*(np.arange(-r, r + 1) for r in reach), indexing="ij"), -1).reshape(-1, 2)
        return k[(k[:, 0] > 0) | ((k[:, 0] == 0) & (k[:, 1] > 0))]
