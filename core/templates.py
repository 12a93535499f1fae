# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates (section 5.2): the clean curves of one cell, where they occur, and which belong together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation import condense, fit_curves, trace_curves
from .network import CurveNetwork
from .occurrences import congruent_parts, share_place, starred
from .overlay import Overlay, agreement, chance_shifts, fold_orbit, fold_poses
from .rigid import best_rotation, motion

CHANCE_SHARE = 0.1
"""Largest share of the agreeing samples that chance may explain."""

CHANCE_SEEN = 0.15
"""Share of a curve that clutter seems to show at a place where the curve does not occur."""


@dataclass(frozen=True)
class Draft:
    """Clean curves of one common cell and the places where the cell recurs.

    curves : list of (k, 3) float64 points in the cell's frame; closed : list of bool
    poses : (a, 4, 4) float64, cell to network; keys : (a, g) int64, powers of the generators
    evidence : (a, c) float64, share of each curve that the network shows in each cell
    transformation : index of the orbit in the model
    orbital : whether the keys are powers of that orbit's generators
    """

    curves: list
    closed: list
    poses: np.ndarray
    keys: np.ndarray
    evidence: np.ndarray
    transformation: int
    orbital: bool = True


def consolidate(
    network: CurveNetwork, overlay: Overlay, transformation: int, *, epsilon, images=(), progress=None
) -> Draft:
    """The curves on which the occurrences of an overlay agree.

    A sample is kept when enough other occurrences show it: as many as leave only `CHANCE_SHARE` to chance, which
    is what is left when the occurrences are shifted against each other.
    """
    weight = network.weights[overlay.sample] * overlay.inner
    count, mean = agreement(overlay, radius=1.25 * epsilon, progress=progress)
    shifts = chance_shifts(overlay)
    wrong, _ = agreement(overlay, radius=1.25 * epsilon, shifts=shifts)
    least = least_agreement(count, wrong, weight)
    keep = (count >= least) & overlay.inner
    empty = Draft([], [], overlay.poses, overlay.keys, np.zeros((len(overlay.poses), 0)), transformation)
    if not keep.any():
        return empty
    points, tangents = condense(mean[keep], overlay.tangents[keep], weight[keep], radius=1.0 * epsilon)
    curves, closed = fit_curves(
        trace_curves(points, tangents), mean[keep], tangents, weight[keep], overlay.run[keep],
        trails=(mean, overlay.tangents, overlay.run), images=images,
    )  # fmt: skip
    if not curves:
        return empty
    evidence = seen_share(network, curves, overlay.poses, radius=1.25 * epsilon)
    return Draft(curves, closed, overlay.poses, overlay.keys, evidence, transformation)


def least_agreement(count, wrong, weight):
    """Fewest agreeing occurrences that leave at most `CHANCE_SHARE` of the length to chance."""
    top = int(count.max(initial=0))
    for least in range(1, top + 1):
        seen, chance = weight[count >= least].sum(), weight[wrong >= least].sum()
        if chance <= CHANCE_SHARE * seen:
            return least
    return max(1, top)


def seen_share(network: CurveNetwork, curves, poses, *, radius, cosine=0.75):
    """(a, c) float64, share of each curve, placed by each pose, that lies along samples of the network."""
    points = np.concatenate(curves)
    of_curve = np.repeat(np.arange(len(curves)), [len(c) for c in curves])
    tangents = np.concatenate([_directions(c) for c in curves])
    tree = cKDTree(network.points)
    share = np.zeros((len(poses), len(curves)))
    size = np.bincount(of_curve)
    for a, pose in enumerate(poses):
        placed, lines = points @ pose[:3, :3].T + pose[:3, 3], tangents @ pose[:3, :3].T
        distance, near = tree.query(placed, k=3, distance_upper_bound=radius, workers=-1)
        found = np.isfinite(distance)
        along = np.abs((network.tangents[np.where(found, near, 0)] * lines[:, None]).sum(-1)) > cosine
        share[a] = np.bincount(of_curve, (found & along).any(axis=1), minlength=len(size)) / size
    return share


def _directions(curve):
    step = np.gradient(curve, axis=0)
    return step / np.maximum(np.linalg.norm(step, axis=1), 1e-12)[:, None]


def group(draft: Draft, chance: float) -> list[Draft]:
    """Split the curves of a draft into templates: curves that occur in the same cells belong together.

    chance : share of a curve that is seen where it does not occur
    """
    rest = np.arange(len(draft.curves))
    length = np.array([len(c) for c in draft.curves], float)
    out = []
    while len(rest):
        member, cells = _largest_group(draft.evidence[:, rest], length[rest], chance)
        if len(cells) >= 2:
            pick = rest[member]
            out.append(
                replace(
                    draft,
                    curves=[draft.curves[i] for i in pick],
                    closed=[draft.closed[i] for i in pick],
                    poses=draft.poses[cells],
                    keys=draft.keys[cells],
                    evidence=draft.evidence[np.ix_(cells, pick)],
                )
            )
        rest = np.delete(rest, member)
    return out


def _largest_group(evidence, length, chance):
    """Members (indices) and cells of the set of curves that occur together with the longest curve.

    The longest curve says where to look first. A curve joins when it is seen in those cells about as often as the
    members are, and not in others; with the members' evidence the cells are found anew.
    """
    member = np.zeros(len(length), bool)
    member[np.argmax(length)] = True
    seen_before = None
    for _ in range(6):
        share = evidence[:, member] @ length[member] / length[member].sum()
        level = np.median(np.sort(share)[::-1][: max(2, int((share > 2 * chance).sum()))])
        cells = share > chance + _least_share(level) * max(level - chance, 0)
        if cells.sum() < 2 or (seen_before is not None and (cells == seen_before).all()):
            break
        seen_before = cells
        typical = float(share[cells].mean())
        inside = evidence[cells].mean(axis=0)
        outside = np.maximum(evidence[~cells] - chance, 0).sum(axis=0)
        within = np.maximum(evidence[cells] - chance, 0).sum(axis=0)
        now = (inside > 0.4 * typical) & (within >= 0.7 * (within + outside))
        now[np.argmax(length)] = True
        member = now
    return np.flatnonzero(member), np.flatnonzero(cells)


def extract_templates(network: CurveNetwork, model, clusters, screen, parameters, *, progress=None) -> list[Draft]:
    """Templates of all transformations of the model, one after the other on what is not explained yet.

    Orbits first, cell by cell; then what stands in no lattice; then templates that are copies of each other become
    one, with the occurrences of all.
    """
    epsilon = parameters.epsilon
    free = np.ones(len(network.points), bool)
    drafts = []
    report = progress or (lambda stage, fraction: None)
    for at, (k, orbit) in enumerate(zip(range(len(model.orbits)), model.orbits)):
        begin, width = 0.6 * at / len(model.orbits), 0.6 / len(model.orbits)
        step = lambda f, begin=begin, width=width: report("completion", begin + width * f)  # noqa: E731
        step(0.0)
        if orbit.kind == "single":
            poses, region = starred(network, orbit.generators[0], clusters.motions, screen, free)
            if len(poses) < 2:
                continue
            draft = consolidate_places(network, poses, network.points[region], k, free, epsilon=epsilon, progress=step)
        else:
            # What slips along this orbit may have been given to another one, but is shown by it all the same.
            own = np.isin(model.of_curve, (-1, k))[network.curve_of] | (model.hits[k] >= 2)
            use = np.flatnonzero(own & free)
            if len(use) < 2:
                continue
            overlay = fold_orbit(network, orbit, use, model.hits[k][use].astype(float))
            unit = np.eye(len(orbit.twists), dtype=np.int64)
            images = orbit.power(np.concatenate([unit, -unit]))
            draft = consolidate(network, overlay, k, epsilon=epsilon, images=images, progress=step)
        for one in group(draft, CHANCE_SEEN):
            drafts.append(one)
            free &= ~explained_samples(network, one, radius=1.25 * epsilon)
    report("completion", 0.7)
    return unite(network, drafts, parameters, threads=screen.threads)


def consolidate_places(network, poses, region, transformation, free, *, epsilon, progress=None, rounds=3) -> Draft:
    """Draft of a thing at given places; what some places show beside the region widens it."""
    for _ in range(rounds):
        overlay = fold_poses(network, poses, region, free, reach=12.0)
        draft = consolidate(network, overlay, transformation, epsilon=epsilon, progress=progress)
        draft = replace(draft, orbital=False)
        if not draft.curves:
            break
        region = np.concatenate(draft.curves)
        poses = refined_poses(network, draft, free, radius=2 * epsilon)
    return draft


def refined_poses(network: CurveNetwork, draft: Draft, free, *, radius, rounds=3):
    """Poses moved so that the draft's curves lie on the samples that show them; ICP, across the curves only.

    An occurrence that shows too little to hold it stays where it is.
    """
    points = np.concatenate(draft.curves)
    tangents = np.concatenate([_directions(c) for c in draft.curves])
    samples = np.flatnonzero(free)
    tree = cKDTree(network.points[samples])
    poses = draft.poses.copy()
    for a in range(len(poses)):
        for _ in range(rounds):
            r, t = poses[a, :3, :3], poses[a, :3, 3]
            moved, lines = points @ r.T + t, tangents @ r.T
            distance, near = tree.query(moved, distance_upper_bound=radius)
            hit = np.isfinite(distance)
            near = samples[np.where(hit, near, 0)]
            hit &= np.abs((network.tangents[near] * lines).sum(1)) > 0.8
            if hit.sum() < 30:
                break
            offset = network.points[near] - moved
            offset -= lines * (offset * lines).sum(1)[:, None]
            target = moved[hit] + offset[hit]
            mean_a, mean_b = points[hit].mean(0), target.mean(0)
            turn, _ = best_rotation(((target - mean_b).T @ (points[hit] - mean_a) + 1e-3 * r)[None])
            poses[a] = motion(turn[0], mean_b - turn[0] @ mean_a)
    return poses


def unite(network: CurveNetwork, drafts: list[Draft], parameters, *, threads=1) -> list[Draft]:
    """Drafts in which curves that are rigid copies of each other are one template with the occurrences of all."""
    p, epsilon = parameters, parameters.epsilon
    items = [(d, c) for d, draft in enumerate(drafts) for c in range(len(draft.curves))]
    if len(items) < 2:
        return drafts
    first = [np.asarray(drafts[d].poses[0]) for d, _ in items]
    lines = [drafts[d].curves[c] @ m[:3, :3].T + m[:3, 3] for (d, c), m in zip(items, first)]
    surface = (None, None)
    if network.normals is not None:
        nearest = cKDTree(network.points).query(np.concatenate(lines))[1]
        surface = network.normals[nearest], None if network.kind is None else network.kind[nearest]
    groups = congruent_parts(
        lines, [d for d, _ in items], surface, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, epsilon=epsilon,
        threads=threads,
    )
    united = []
    for places in groups:
        poses, region = [], []
        for place, members in places:
            back = np.linalg.inv(place)
            region += [lines[k] @ back[:3, :3].T + back[:3, 3] for k in members]
            source = drafts[items[members[0]][0]]
            poses.append(source.poses @ np.linalg.inv(source.poses[0]) @ place)
        poses, region = np.concatenate(poses), np.concatenate(region)
        poses = _one_a_place(network, poses, region, epsilon)
        most = max({items[k][0] for _, members in places for k in members}, key=lambda d: len(drafts[d].poses))
        free = np.ones(len(network.points), bool)
        draft = consolidate_places(network, poses, region, drafts[most].transformation, free, epsilon=epsilon)
        new = group(draft, CHANCE_SEEN)
        # What was explained by the parts must be explained by the whole.
        before = [_only(drafts[d], [c for e, c in (items[k] for _, m in places for k in m) if e == d]) for d in
                  sorted({items[k][0] for _, m in places for k in m})]  # fmt: skip
        if _explained_length(network, new, epsilon) >= 0.97 * _explained_length(network, before, epsilon):
            united += new
    if not united:
        return drafts
    return united + [left for draft in drafts if (left := _uncovered(draft, united, 1.25 * epsilon)) is not None]


def _one_a_place(network, poses, region, epsilon):
    """The poses (a, 4, 4) without those that put the region (n, 3) where another one does, which shows it better."""
    share = seen_share(network, [region], poses, radius=1.25 * epsilon)[:, 0]
    kept = []
    for k in np.argsort(-share, kind="stable"):
        if not kept or not share_place(region, poses[k : k + 1], poses[kept])[0]:
            kept.append(int(k))
    return poses[sorted(kept)]


def _only(draft, curves):
    """A draft with only some of its curves."""
    return replace(
        draft, curves=[draft.curves[i] for i in curves], closed=[draft.closed[i] for i in curves],
        evidence=draft.evidence[:, curves],
    )  # fmt: skip


def _explained_length(network, drafts, epsilon):
    if not drafts:
        return 0.0
    shown = np.any([explained_samples(network, d, radius=1.25 * epsilon) for d in drafts], axis=0)
    return float(network.weights[shown].sum())


def _uncovered(draft, others, radius):
    """The draft without the curves that other drafts show already, or None."""
    points, tangents = (np.concatenate(x) for x in zip(*(placed(o)[:2] for o in others)))
    tree = cKDTree(points)
    own, way, _, curve = placed(draft)
    distance, near = tree.query(own, k=3, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    along = np.abs((tangents[np.where(found, near, 0)] * way[:, None]).sum(-1)) > 0.7
    covered = np.bincount(curve, (found & along).any(axis=1)) / np.bincount(curve)
    keep = np.flatnonzero(covered < 0.5)
    if not len(keep):
        return None
    return _only(draft, keep)


def explained_samples(network: CurveNetwork, draft: Draft, *, radius, cosine=0.7):
    """(n,) bool, samples that lie along a curve of the draft at one of its occurrences."""
    points, tangents = placed(draft)[:2]
    return _along(network, points, tangents, radius, cosine)[0]


def placed(draft: Draft):
    """Points (k, 3), tangents (k, 3), occurrence (k,) and curve (k,) of all curves at all occurrences."""
    one = np.concatenate(draft.curves)
    way = np.concatenate([_directions(c) for c in draft.curves])
    curve = np.repeat(np.arange(len(draft.curves)), [len(c) for c in draft.curves])
    r, t = draft.poses[:, :3, :3], draft.poses[:, None, :3, 3]
    points = one @ np.swapaxes(r, 1, 2) + t
    tangents = way @ np.swapaxes(r, 1, 2)
    a = len(draft.poses)
    return points.reshape(-1, 3), tangents.reshape(-1, 3), np.repeat(np.arange(a), len(one)), np.tile(curve, a)


def _along(network, points, tangents, radius, cosine):
    """Which samples lie along the given points, and the nearest such point of each."""
    distance, near = cKDTree(points).query(network.points, k=4, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    good = found & (np.abs((tangents[near] * network.tangents[:, None]).sum(-1)) > cosine)
    first = np.argmax(good, axis=1)
    return good.any(axis=1), near[np.arange(len(near)), first]


def _least_share(level):
    """Share of what a full cell shows that makes a cell an occurrence: the more is seen, the more is asked for."""
    return float(np.clip(level - 0.3, 0.35, 0.55))
