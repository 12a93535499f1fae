# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates (section 5.2): the clean curves of one cell, where they occur, and which belong together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .copies import unite
from .courses import Course, find_courses
from .drafting import consolidate, consolidate_places
from .drafts import Draft, along, explained_samples, seen_share
from .geometry.polylines import directions
from .grouping import at_their_borders, group, kinds_of_cells
from .network.network import CurveNetwork
from .occurrences import Pattern, Search, shown
from .orbits import Orbit
from .overlay import fold_orbit
from .polishing import fit_orbit, fit_to_samples, settled
from .sublattices import coarser, steps_of, sublattice
from .support import Screen, long_stretches

MARGIN = {1: 0.5, 2: 0.35}
"""Share of a cell of an orbit with so many generators in which curves may reach over its border and stay whole."""

HELD, BIT = 2.0, 0.6
"""What must hold the poses of a template in the direction that is held least, edge lengths (see `occurrences.shown`);
half of what an occurrence must show that is found later: there are many places where one may be found. And the
shortest template, in multiples of l0: clutter shows a shorter one anywhere."""

FEW, ROUNDS, GROWS, DEEPEST, COURSES = 4, 6, 1.03, 3, 3
"""Occurrences below which those found later may change the curves, rounds of looking for more of them, by what factor
the curves must have grown for another round, sub-lattices within each other, and rounds of looking for courses."""


def extract_templates(network: CurveNetwork, model, votes, clusters, screen: Screen, parameters, *, progress=None):
    """Templates of all transformations of the model, one after the other on what is not explained yet.

    Each transformation gives the curves on which its cells agree: those that run on through all cells are courses,
    the others templates. A template is then looked for in all that is left. In the end templates that are copies of
    each other become one, with the occurrences of all.

    Returns
    -------
    drafts : list of Draft; courses : list of Course; orbits : those of the model, fitted to their cells
    """
    maker = _Maker(network, model, votes, clusters, screen, parameters, progress)
    # What stands in an orbit is known best, and must not be taken for a poor occurrence of something else.
    single = [orbit.kind == "single" for orbit in model.orbits]
    for k in np.argsort(single, kind="stable"):
        if single[k] and not maker.searched:
            maker.search_all()
        maker.take(int(k))
    maker.search_all()
    maker.report(0.8)
    drafts = unite(
        network, maker.drafts, maker.beside_courses, parameters, threads=screen.threads, tick=lambda: maker.report(0.8)
    )
    return drafts, maker.courses, [maker.orbits.get(k, orbit) for k, orbit in enumerate(model.orbits)]


class _Maker:
    """Goes through the transformations; `free` are the samples that nothing explains yet."""

    def __init__(self, network, model, votes, clusters, screen, parameters, progress):
        self.network, self.model, self.screen = network, model, screen
        self.epsilon, self.l0 = parameters.epsilon, parameters.l0
        self.radius = 1.25 * parameters.epsilon
        self.search = Search(network, votes, clusters, screen)
        self.free = np.ones(len(network.points), bool)
        self.beside_courses = self.free.copy()
        self.drafts: list[Draft] = []
        self.orbits: dict[int, Orbit] = {}
        self.taken = 0
        self.searched = 0
        self.courses: list[Course] = []
        self.progress = progress or (lambda stage, fraction: None)

    def report(self, fraction):
        self.progress("completion", fraction)

    def take(self, k):
        """Templates and courses of transformation k of the model."""
        begin, width = 0.8 * self.taken / len(self.model.orbits), 0.8 / len(self.model.orbits)
        self.report(begin)
        self.taken += 1
        orbit = self.model.orbits[k]
        step = lambda f: self.report(begin + 0.6 * width * f)  # noqa: E731
        if orbit.kind == "single":
            draft = self._single(orbit, k, step)
            if draft is not None and draft.curves:
                found, left = group(self.network, draft, self.free, radius=self.radius)
                for one in found:
                    if self._is_thing(one):
                        for whole in self._everywhere(one, left):
                            left = self._add(whole, left)
                self.searched = len(self.drafts)
        else:
            self._orbit(orbit, k, step)

    def _orbit(self, orbit: Orbit, k, step):
        """Templates and courses of an orbit, each part of it with the generator under which it recurs."""
        steps = steps_of(orbit, self.screen)
        orbit = self._part(orbit, k, step, steps == 1)
        for d in np.unique(steps[steps > 1]):
            self._part(coarser(orbit, d, orbit.support), k, step, steps == d, depth=1)

    def _part(self, orbit: Orbit, k, step, mine, depth=0):
        """Templates and courses of what samples `mine` (n,) bool show in the cells of an orbit, and of sub-lattices.

        depth : how many sub-lattices deep; the orbit, fitted to its cells, is returned
        """
        orbit, draft = self._cells(orbit, k, step, mine, known=depth > 0)
        if not draft.curves:
            return orbit
        for _ in range(COURSES):
            found, draft = self._without_courses(orbit, draft)
            if not found:
                break
            # A course that lay on other curves when folded has bent them: without it they are made anew.
            orbit, draft = self._cells(orbit, k, step, mine, known=depth > 0)
            if not draft.curves:
                return orbit
        found, left = group(self.network, draft, self.free, radius=self.radius)
        found = [one for one in found if one.lengths.sum() >= BIT * self.l0]
        apart = None if depth == DEEPEST else kinds_of_cells(self.network, draft, found, radius=self.radius)
        if apart is not None:
            for kind in range(apart.max() + 1):
                self._part(orbit, k, step, mine & (apart == kind), depth + 1)
            return orbit
        found = [one for one in found if len(one.poses) >= FEW or self._is_thing(one)]
        if not orbit.closed:
            found = [
                part for one in found
                for part in at_their_borders(
                    self.network, draft, one, left | explained_samples(self.network, one, radius=self.radius),
                    radius=self.radius,
                )
            ]  # fmt: skip
        most = max((len(one.poses) for one in found), default=0)
        for one in found:
            if 2 * len(one.poses) > most:
                self._add(one, left)
        # What only few cells show may be seen better under a power of the generators.
        finer = None
        if depth < DEEPEST:
            finer = sublattice(orbit, self.screen, self.free & self._own(k) & mine, shortest=self.l0)
        if finer is not None:
            self._part(finer, k, step, mine, depth + 1)
        for few in found:
            if 2 * len(few.poses) <= most:
                for one in group(self.network, few, self.free, radius=self.radius)[0]:
                    self._add(one, self.free)
        return orbit

    def search_all(self):
        """Look for the templates of orbits in what is left; those with most occurrences first."""
        mine = self.drafts[self.searched :]
        self.drafts = self.drafts[: self.searched]
        for draft in mine:
            for whole in self._everywhere(draft, self.free):
                self._add(whole, self.free)
        self.searched = len(self.drafts)

    def _add(self, draft, left):
        """Take a draft up; of the samples `left` those that it does not explain are returned."""
        free = left | explained_samples(self.network, draft, radius=self.radius)
        draft = settled(self.network, draft, free, radius=self.radius, tick=self.screen.tick)
        self.drafts.append(draft)
        explained = explained_samples(self.network, draft, radius=self.radius)
        self.free &= ~explained
        return left & ~explained

    def _cells(self, orbit: Orbit, k, step, mine, known):
        """The orbit, fitted to its cells, and a draft of what they agree on; of samples `mine` (n,) bool alone."""
        # What slips along this orbit may have been given to another one, but is shown by it all the same.
        own = self._own(k)
        if not known:
            own = own | (self.model.hits[k] >= 2)
        use = np.flatnonzero(own & self.free & mine)
        nothing = Draft([], [], np.zeros((0, 4, 4)), np.zeros((0, len(orbit.twists))), np.zeros((0, 0)), k, np.zeros(0))
        if len(use) < 2:
            return orbit, nothing
        weight = self.model.hits[k][use].astype(float)
        overlay = fold_orbit(self.network, orbit, use, weight)
        self.screen.tick()
        wide = fold_orbit(self.network, orbit, use, weight, share=MARGIN[len(orbit.twists)])
        draft = consolidate(self.network, overlay, k, epsilon=self.epsilon, orbit=orbit, wide=wide, progress=step)
        if not known:
            orbit, draft = fit_orbit(self.network, orbit, draft, use, radius=self.radius, tick=self.screen.tick)
        self.screen.tick()
        draft = fit_to_samples(self.network, draft, use, radius=self.radius, tick=self.screen.tick)
        self.orbits.setdefault(k, orbit)
        return orbit, draft

    def _without_courses(self, orbit, draft):
        """The courses of a draft, and the draft without them; their samples are free no more."""
        found, draft = find_courses(self.network, orbit, draft, self.free, radius=self.radius, shortest=self.l0)
        self.courses += found
        for course in found:
            shown_by = ~along(self.network, course.points, directions(course.points), self.radius)[0]
            self.free &= shown_by
            self.beside_courses &= shown_by
        return found, draft

    def _single(self, orbit: Orbit, k, step):
        """A draft of what one motion maps: its own two places, and all others where it is found."""
        seed = orbit.generators[0]
        _, hit = self.screen.nearest(seed[None])
        hit = long_stretches(hit, self.screen.curve, self.screen.least)[0] & self.free
        region = _main_part(self.network, np.flatnonzero(hit))
        if len(region) < 2 * self.screen.least:
            return None
        poses = np.stack([np.eye(4), seed])
        pattern = _samples(self.network, region)
        poses = np.concatenate([poses, self.search.find(pattern, poses, self.free, raw=True)])
        return consolidate_places(
            self.network, poses, pattern.points, k, self.free, epsilon=self.epsilon, progress=step
        )

    def _holds(self, draft: Draft):
        """Whether what is seen of a draft holds its poses: a straight line or a ring alone is at home anywhere."""
        pattern = _pattern(self.network, draft)
        probe = Screen(self.network, pattern, radius=self.radius, still=None, threads=self.screen.threads)
        return np.median(shown(probe, draft.poses, np.ones_like(self.free))[1]) >= HELD

    def _own(self, k):
        """(n,) bool, samples of the curves that the model gives to transformation k, or to none."""
        return np.isin(self.model.of_curve, (-1, k))[self.network.curve_of]

    def _is_thing(self, draft: Draft):
        """Whether a draft is more than a stretch that looks alike at a few places."""
        return draft.lengths.sum() >= self.l0 and self._holds(draft)

    def _everywhere(self, draft: Draft, free):
        """The draft with all its occurrences; where it had few, its curves are made anew from all of them."""
        if not self._holds(draft):
            return [draft]
        before = 0.0
        for _ in range(ROUNDS):
            pattern = _pattern(self.network, draft)
            orbital = draft.orbital.any()
            alone = not orbital or len(draft.poses) < FEW
            if orbital:
                # The orbit vouches for its cells, however little they show.
                poses = self.search.find(pattern, draft.poses, free)
            else:
                keep, poses = self.search.reconsider(pattern, draft.poses, free)
                draft = draft.part(cells=np.flatnonzero(keep))
            if not len(poses) and (orbital or len(pattern.points) < GROWS * before):
                break
            draft, before = _with_poses(draft, poses), len(pattern.points)
            if not alone:
                evidence = seen_share(self.network, draft.curves, poses, radius=self.radius, free=free)
                draft = replace(draft, evidence=np.concatenate([draft.evidence, evidence]))
                continue
            # What two places agree on is a part of the thing; all of them show the rest.
            mine = free | explained_samples(self.network, draft, radius=self.radius)
            new = consolidate_places(
                self.network, draft.poses, pattern.points, draft.transformation, mine, epsilon=self.epsilon
            )
            new = [one for one in group(self.network, new, mine, radius=self.radius)[0] if self._is_thing(one)]
            if len(new) != 1:
                return new
            draft = new[0]
        return [draft]


def _with_poses(draft: Draft, poses):
    """The draft with more poses, which are no cells of its orbit."""
    more = len(poses)
    return replace(
        draft,
        poses=np.concatenate([draft.poses, poses]),
        keys=np.concatenate([draft.keys, np.zeros((more, draft.keys.shape[1]), np.int64)]),
        orbital=np.concatenate([draft.orbital, np.zeros(more, bool)]),
    )


def _samples(network: CurveNetwork, region) -> Pattern:
    """Samples of the network as a pattern."""
    run = np.cumsum(np.r_[True, (np.diff(region) != 1) | (np.diff(network.curve_of[region]) != 0)])
    return Pattern(
        network.points[region], network.tangents[region], network.weights[region], run,
        *(None if x is None else x[region] for x in (network.normals, network.kind)),
    )  # fmt: skip


def _pattern(network: CurveNetwork, draft: Draft) -> Pattern:
    """The curves of a draft as a pattern; the surface is that of the samples which show it best."""
    points = np.concatenate(draft.curves)
    tangents = np.concatenate([directions(c) for c in draft.curves])
    run = np.repeat(np.arange(len(draft.curves)), [len(c) for c in draft.curves])
    normals = kind = None
    if network.normals is not None or network.kind is not None:
        best = draft.poses[np.argmax(draft.evidence @ draft.lengths)]
        near = cKDTree(network.points).query(points @ best[:3, :3].T + best[:3, 3])[1]
        normals = None if network.normals is None else network.normals[near] @ best[:3, :3]
        kind = None if network.kind is None else network.kind[near]
    return Pattern(points, tangents, np.ones(len(points)), run, normals, kind)


def _main_part(network, samples, gap=12.0):
    """The largest group of samples that lie within `gap` of each other."""
    if not len(samples):
        return samples
    pair = cKDTree(network.points[samples]).query_pairs(gap, output_type="ndarray")
    n = len(samples)
    graph = coo_matrix((np.ones(len(pair)), (pair[:, 0], pair[:, 1])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    return samples[label == np.argmax(np.bincount(label))]
