# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences of a template wherever they are (section 5.2): also beside a lattice, and where there is none.

The graph of one transformation joins a curve with its image only. Things that stand in no regular order are related by
another motion for every pair, and the wings of a facade by none of a lattice's. Here the template itself is looked
for: every match of a curve that shows it with a curve that nothing explains says where it may be once more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .clustering import group_motions, perturbed
from .drafts import along
from .geometry.motions import inverse
from .network.network import CurveNetwork
from .support import Screen, in_long_stretches

APART, MOST, REFINED = 8.0, 4000, 200
"""Edge lengths between two occurrences, candidates that are looked at, and candidates that are refined."""

SEEN, SEEN_CLEAR, DOUBTFUL, OVER_CHANCE, STIFF = 0.45, 0.65, 0.8, 1.3, 5.0
"""Share of what the known occurrences show that another one must show, and the share where they show nearly all (the
more is seen, the more is asked for); share below which an occurrence is tried again; by what factor an occurrence must
exceed what places beside the known ones show; and what must hold its pose in the direction that is held least (edge
lengths)."""


@dataclass(frozen=True)
class Pattern:
    """What is looked for, as samples: points, tangents (n, 3); weights, curve_of (n,); normals, kind as a network's."""

    points: np.ndarray
    tangents: np.ndarray
    weights: np.ndarray
    curve_of: np.ndarray
    normals: np.ndarray | None
    kind: np.ndarray | None


class Search:
    """Looks for patterns in a network.

    votes, clusters : what Feature BLAST found: where a pattern may be
    screen : support on the network; its radius is the final tolerance
    """

    def __init__(self, network: CurveNetwork, votes, clusters, screen: Screen):
        self.network, self.votes, self.screen = network, votes, screen
        self.pool = np.concatenate([clusters.motions[:150], inverse(clusters.motions[:150])])
        self.wide = Screen(network, radius=2 * screen.radius, still=None, threads=screen.threads).field

    def find(self, pattern: Pattern, poses, free, *, raw=False):
        """More poses of a pattern, beside the known ones.

        Parameters
        ----------
        poses : (a, 4, 4), known poses, pattern to network
        free : (n,) bool, samples that may show it
        raw : whether the pattern is just what the known places have in common, so that they show all of it

        Returns
        -------
        (b, 4, 4), best shown first; they share no place with each other or with the known ones
        """
        more = {"threads": self.screen.threads, "tick": self.screen.tick, "still": None}
        fine = self._fine(pattern)
        owner, known_by = self._owner(pattern, poses)
        typical = np.median(shown(fine, poses, free | known_by)[0])
        free = free & ~known_by
        known = poses[:: max(1, len(poses) // 20)]
        beside = perturbed(np.repeat(known, max(1, 40 // len(known)), axis=0), pattern.points.std(axis=0))
        wide = {"radius": 2 * self.screen.radius, "field": self.wide, **more}
        coarse = Screen(self.network, pattern, stride=2, stretch=6.0, **wide)
        floor = np.quantile(shown(fine, fitted(fine, fitted(coarse, beside, free, 2), free, 2), free)[0], 0.9)
        tries = self._candidates(pattern, poses, owner, free)
        if not len(tries):
            return tries
        rough = shown(coarse, tries, free)[0]
        order = np.argsort(-rough, kind="stable")
        enough = SEEN if raw else float(np.clip(typical - 0.2, SEEN, SEEN_CLEAR))
        order = order[rough[order] > 0.5 * enough * typical][:1500]
        # Candidates near each other are refined to the same pose.
        _, lead = np.unique(group_motions(tries[order], 6.0, 4.0), return_index=True)
        tries = tries[order[np.sort(lead)[:REFINED]]]
        tries = fitted(fine, fitted(coarse, tries, free, 4), free, 2)
        least = max(enough * typical, OVER_CHANCE * floor)
        found = np.zeros((0, 4, 4))
        share, stiff = shown(fine, tries, free)
        while len(tries):
            keep = (share >= least) & (stiff >= STIFF)
            tries, share = tries[keep], share[keep]
            if not len(tries):
                break
            best = tries[np.argmax(share)][None]
            found = np.concatenate([found, best])
            tries = tries[~share_place(pattern.points, tries, best)]
            # A sample is evidence for one occurrence only.
            free = free & ~self._owner(pattern, best)[1]
            share, stiff = shown(fine, tries, free)
        return found

    def reconsider(self, pattern: Pattern, poses, free):
        """The known poses once more, and others, now that the pattern may have grown.

        What was found by a part of the pattern may lie wrongly, half a turn off perhaps, where the whole of it does
        not fit. Occurrences that show clearly less than the rest give way to better ones at their places.

        Returns
        -------
        keep : (a,) bool, known poses that stay; found : (b, 4, 4), others
        """
        fine = self._fine(pattern)
        known_by = self._owner(pattern, poses)[1]
        share = shown(fine, poses, free | known_by)[0]
        weak = share < DOUBTFUL * np.median(share)
        weak[np.argsort(-share, kind="stable")[:2]] = False
        sure_by = self._owner(pattern, poses[~weak])[1]
        left = (free | known_by) & ~sure_by
        found = self.find(pattern, poses[~weak], left)
        better, keep = shown(fine, found, left)[0], np.ones(len(poses), bool)
        for k in np.flatnonzero(weak):
            at = share_place(pattern.points, found, poses[k : k + 1])
            if at.any() and better[at].max() > share[k]:
                keep[k] = False
            elif at.any():
                found, better = found[~at], better[~at]
        return keep, found

    def _fine(self, pattern):
        return Screen(
            self.network, pattern, radius=self.screen.radius, field=self.screen.field, still=None,
            threads=self.screen.threads, tick=self.screen.tick,
        )  # fmt: skip

    def _candidates(self, pattern, poses, owner, free):
        """Poses (k, 4, 4) to which matches of what shows the pattern lead, best first, none at a known place."""
        source, target = self.votes.pair.T
        new = np.bincount(self.network.curve_of, free) > 0.5 * np.diff(self.network.offsets)
        there = np.flatnonzero((owner[source] >= 0) & new[target])
        back = np.flatnonzero((owner[target] >= 0) & new[source])
        motions = np.concatenate([self.votes.motions[there], inverse(self.votes.motions[back])])
        at = np.concatenate([owner[source[there]], owner[target[back]]])
        order = np.argsort(-self.votes.weight[np.concatenate([there, back])], kind="stable")[:MOST]
        tries = motions[order] @ poses[at[order]]
        some = poses[:: max(1, len(poses) // 8)]
        pool = (self.pool[:, None] @ some[None]).reshape(-1, 4, 4)
        low, high = self.network.points.min(axis=0), self.network.points.max(axis=0)
        middle = pool[:, :3, :3] @ pattern.points.mean(axis=0) + pool[:, :3, 3]
        pool = pool[((middle > low - 10) & (middle < high + 10)).all(axis=1)]
        tries = np.concatenate([tries, pool])
        return tries[~share_place(pattern.points, tries, poses)]

    def _owner(self, pattern, poses):
        """The pose at which each curve shows the pattern, or -1, and which samples show it."""
        r, t = poses[:, :3, :3], poses[:, None, :3, 3]
        points = (pattern.points @ np.swapaxes(r, 1, 2) + t).reshape(-1, 3)
        lines = (pattern.tangents @ np.swapaxes(r, 1, 2)).reshape(-1, 3)
        seen, near, _ = along(self.network, points, lines, 1.25 * self.screen.radius)
        counts = np.zeros((len(self.network), len(poses)))
        np.add.at(counts, (self.network.curve_of[seen], near[seen] // len(pattern.points)), 1)
        size = np.diff(self.network.offsets)
        best = counts.argmax(axis=1)
        return np.where(counts.max(axis=1) >= np.minimum(0.3 * size, 15), best, -1), seen


def shown(probe: Screen, poses, free):
    """Share (h,) of a pattern that the free samples show at each pose, and how well they hold the pose (h,).

    What holds a pose is the least eigenvalue of the normal matrix of the distances across the curves, rotations
    measured at the pattern's radius of gyration: the length of pattern that resists a move in the direction that is
    held least. A straight line alone gives 0, it slides and rolls.
    """
    share, stiff = np.zeros(len(poses)), np.zeros(len(poses))
    total = probe.weight.sum()
    size = max(1, 200_000 // max(1, len(probe.points)))
    for begin in range(0, len(poses), size):
        part = slice(begin, begin + size)
        i, k = _free_hits(probe, poses[part], free)[:2]
        count = len(poses[part])
        share[part] = np.bincount(i, probe.weight[k], minlength=count) / total
        normal = np.zeros((count, 36))
        for column, term in enumerate((probe.weight[k][:, None, None] * _resistance(probe)[k]).reshape(-1, 36).T):
            normal[:, column] = np.bincount(i, term, minlength=count)
        stiff[part] = np.linalg.eigvalsh(normal.reshape(-1, 6, 6))[:, 0]
        probe.tick()
    return share, stiff


def _resistance(probe):
    """(n, 6, 6) float64, for each sample: J^T J of its distance across its tangent under a small shift and turn."""
    arm = probe.points - probe.points.mean(axis=0)
    arm = arm / max(np.sqrt((arm**2).sum(axis=1).mean()), 1e-9)
    across = np.eye(3) - probe.tangents[:, :, None] * probe.tangents[:, None, :]
    turn = np.cross(np.eye(3)[None], arm[:, None, :])
    move = np.concatenate([np.broadcast_to(np.eye(3), (len(arm), 3, 3)), np.swapaxes(turn, 1, 2)], axis=2)
    jacobian = across @ move
    return np.swapaxes(jacobian, 1, 2) @ jacobian


def _free_hits(probe, poses, free):
    i, k, j = probe.hits(poses)
    good = free[j]
    i, k, j = i[good], k[good], j[good]
    good = in_long_stretches(i, k, probe.curve, probe.least)
    return i[good], k[good], j[good]


def fitted(probe: Screen, poses, free, rounds):
    """Poses moved so that the pattern lies on the free samples that show it (ICP to the tangent lines)."""
    poses = poses.copy()
    size = max(1, 200_000 // max(1, len(probe.points)))
    for begin in range(0, len(poses), size):
        part = slice(begin, begin + size)
        for _ in range(rounds):
            poses[part] = probe.align(poses[part], *_free_hits(probe, poses[part], free))
        probe.tick()
    return poses


def share_place(points, motions, known):
    """(k,) bool, which motions (k, 4, 4) put points (n, 3) where one of the known motions puts them already."""
    if not len(known) or not len(motions):
        return np.zeros(len(motions), bool)
    middle = points.mean(axis=0)
    size = np.sqrt(((points - middle) ** 2).sum(1).mean())
    place = motions[:, :3, :3] @ middle + motions[:, :3, 3]
    other = known[:, :3, :3] @ middle + known[:, :3, 3]
    gap = np.linalg.norm(place[:, None] - other[None], axis=2)
    # A thing is as large as it is: two occurrences do not share a place, whichever way they are turned.
    return (gap < max(APART, 0.5 * size)).any(axis=1)
