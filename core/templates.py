# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates (section 5.2): the clean curves of one cell, where they occur, and which belong together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation import condense, fit_curves, trace_curves
from .network import CurveNetwork
from .overlay import Overlay, agreement, chance_shifts

CHANCE_SHARE = 0.1
"""Largest share of the agreeing samples that chance may explain."""


@dataclass(frozen=True)
class Draft:
    """Clean curves of one common cell and the places where the cell recurs.

    curves : list of (k, 3) float64 points in the cell's frame; closed : list of bool
    poses : (a, 4, 4) float64, cell to network; keys : (a, g) int64, powers of the generators
    evidence : (a, c) float64, share of each curve that the network shows in each cell
    transformation : index of the orbit in the model
    """

    curves: list
    closed: list
    poses: np.ndarray
    keys: np.ndarray
    evidence: np.ndarray
    transformation: int


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
    points, tangents = condense(mean[keep], overlay.tangents[keep], weight[keep], radius=1.25 * epsilon)
    curves, closed = fit_curves(trace_curves(points, tangents), points, tangents, weight[keep], images=images)
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
    """Members (indices) and cells of the largest set of curves that occur together."""
    member = np.ones(len(length), bool)
    for _ in range(4):
        share = evidence[:, member] @ length[member] / length[member].sum()
        level = np.median(np.sort(share)[::-1][: max(2, int((share > chance).sum()))])
        cells = share > chance + 0.35 * max(level - chance, 0)
        if cells.sum() < 2:
            break
        typical = max(float(share[cells].mean()), 1e-9)
        inside, outside = evidence[cells].mean(axis=0), evidence[~cells].mean(axis=0) if (~cells).any() else 0
        seen = (evidence[cells] > chance + 0.2).mean(axis=0)
        now = (inside > 0.45 * typical) & (seen >= 0.4) & (outside < 0.6 * inside + chance)
        if not now.any() or (now == member).all():
            break
        member = now
    if cells.sum() < 2:
        lead = np.array([int(np.argmax(length))])
        own = evidence[:, lead[0]]
        return lead, np.flatnonzero(own > chance + 0.35 * max(own.max() - chance, 0))
    share = evidence[:, member] @ length[member] / length[member].sum()
    return np.flatnonzero(member), np.flatnonzero(cells)


def extract_templates(network: CurveNetwork, model, clusters, screen, *, epsilon, progress=None) -> list[Draft]:
    """Templates of all transformations of the model, one after the other on what is not explained yet."""
    from .overlay import fold_orbit

    del clusters, screen
    explained = np.zeros(len(network.points), bool)
    drafts = []
    lines = [k for k, o in enumerate(model.orbits) if o.kind != "single"]
    for at, k in enumerate(lines):
        # What slips along this transformation may have been given to another one, but is shown by it all the same.
        own = np.isin(model.of_curve, (-1, k))[network.curve_of] | (model.hits[k] >= 2)
        use = np.flatnonzero(own & ~explained)
        if len(use) < 2:
            continue
        overlay = fold_orbit(network, model.orbits[k], use, model.hits[k][use].astype(float))
        report = (lambda f, at=at: progress("completion", (at + f) / (len(lines) + 1))) if progress else None
        step = np.eye(len(model.orbits[k].twists), dtype=np.int64)
        images = model.orbits[k].power(np.concatenate([step, -step]))
        draft = consolidate(network, overlay, k, epsilon=epsilon, images=images, progress=report)
        found = group(draft, CHANCE_SEEN)
        drafts += found
        for one in found:
            explained |= explained_samples(network, one, radius=1.25 * epsilon)
    return drafts


CHANCE_SEEN = 0.15


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
