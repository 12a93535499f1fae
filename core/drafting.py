# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts from overlaid occurrences: the curves on which the occurrences agree (section 5.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation.averaging import condense
from .consolidation.consolidation import fit_curves
from .consolidation.tracing import trace_curves
from .drafts import Draft, seen_share
from .geometry.motions import best_rotation, inverse, motion
from .geometry.polylines import directions
from .network.network import CurveNetwork
from .overlay import Overlay, agreement, chance_shifts, fold_poses

CHANCE_SHARE = 0.1
"""Largest share of the agreeing samples that chance may explain."""

TRACED = 30
"""Occurrences that curves are traced on; the memory for that grows with its square."""

FEW, MOSTLY = 5, 0.5
"""Occurrences up to which a curve is also taken from a single one, and the share of it that must be agreed on."""


def consolidate(
    network: CurveNetwork, overlay: Overlay, transformation: int, *, epsilon, orbit=None, wide=None, progress=None
) -> Draft:
    """The curves on which the occurrences of an overlay agree.

    A sample is kept when enough other occurrences show it: as many as leave only `CHANCE_SHARE` to chance, which
    is what is left when the occurrences are shifted against each other (see `agreed`).

    Parameters
    ----------
    orbit, wide : of cells side by side, the orbit and the overlay with wide margins. Curves are made in the cell
        and its margins, so that none ends where cells meet, and one is kept of those that the orbit takes onto
        each other.
    """
    report = progress or (lambda fraction: None)
    weight = network.weights[overlay.sample] * overlay.inner
    count, mean = agreement(overlay, radius=1.25 * epsilon, progress=lambda f: report(0.3 * f))
    shifts = chance_shifts(overlay)
    wrong, _ = agreement(overlay, radius=1.25 * epsilon, shifts=shifts, progress=lambda f: report(0.3 + 0.3 * f))
    least = least_agreement(count, wrong, weight)
    enough = agreed(count, least, overlay.run, few=_well_shown(overlay.cell, weight * (count > 0)) <= FEW)
    cells = np.ones(len(overlay.poses), bool)
    curves, closed = [], []
    if wide is None:
        keep = enough & overlay.inner
        if keep.any():
            curves, closed, _ = _clean(overlay, mean, keep, network.weights, epsilon, report)
    else:
        keep, mean = _carried(overlay, wide, enough, mean)
        if (keep & wide.inner).any():
            curves, closed, points = _clean(wide, mean, keep, network.weights, epsilon, report)
            tick = lambda: report(0.8)  # noqa: E731
            curves, closed = one_of_each(curves, closed, orbit, points, wide.inner[keep], tick=tick)
    if not curves:
        nothing = np.zeros((len(overlay.poses), 0))
        return Draft([], [], overlay.poses, overlay.keys, nothing, transformation, cells)
    report(0.9)
    evidence = seen_share(network, curves, overlay.poses, radius=1.25 * epsilon)
    return Draft(curves, closed, overlay.poses, overlay.keys, evidence, transformation, cells)


def _clean(overlay, mean, keep, weights, epsilon, report):
    """Clean curves through the samples of an overlay that are kept, and where those were moved."""
    weight = weights[overlay.sample[keep]]
    tick = lambda: report(0.7)  # noqa: E731
    some = _most_shown(overlay.cell[keep], weight)
    points, lines = condense(
        mean[keep][some], overlay.tangents[keep][some], weight[some], radius=1.0 * epsilon, tick=tick
    )  # fmt: skip
    paths = trace_curves(points, lines, tick=tick)
    tangents = overlay.tangents[keep]
    tangents[some] = lines
    curves, closed = fit_curves(
        paths, mean[keep], tangents, weight, overlay.run[keep], trails=(mean, overlay.tangents, overlay.run), tick=tick
    )
    return curves, closed, mean[keep]


def _well_shown(cell, weight):
    """Number of occurrences that show at least a quarter of what the fullest one does."""
    shown = np.bincount(cell, weight)
    return int((shown >= 0.25 * shown.max()).sum())


def _most_shown(cell, weight):
    """Indices (k,) of the samples of the occurrences that show most, at most `TRACED` of them.

    What runs where is plain from some; all of them say where exactly, and that costs no pairs of samples.
    """
    shown = np.bincount(cell, weight)
    if (shown > 0).sum() <= TRACED:
        return np.arange(len(cell))
    best = np.zeros(len(shown), bool)
    best[np.argsort(-shown, kind="stable")[:TRACED]] = True
    return np.flatnonzero(best[cell])


def _carried(overlay: Overlay, wide: Overlay, keep, mean):
    """Which are kept, and mean places, of the samples of an overlay for their copies in one with wider margins."""
    inner = np.flatnonzero(overlay.inner)
    twin = np.full(wide.sample.max() + 1, -1)
    twin[overlay.sample[inner]] = inner
    twin = twin[wide.sample]
    way = inverse(wide.poses)[wide.cell] @ overlay.poses[overlay.cell[twin]]
    return keep[twin], np.einsum("nij,nj->ni", way[:, :3, :3], mean[twin]) + way[:, :3, 3]


def one_of_each(curves, closed, orbit, points, inner, *, radius=2.5, covered=0.6, tick=None):
    """Of curves in a cell and its margins, one of those that the orbit takes onto each other; whole ones first.

    points : (n, 3) float64, what the curves run through; inner : (n,) bool, in the cell itself
    """
    if not curves:
        return [], []
    tree = cKDTree(points)
    own = np.array([inner[tree.query(c)[1]].sum() for c in curves])
    steps = np.stack(np.meshgrid(*[(-1, 0, 1)] * len(orbit.twists), indexing="ij"), -1).reshape(-1, len(orbit.twists))
    images = orbit.power(steps)
    out, rings, shown = [], [], np.zeros((0, 3))
    for k in sorted(range(len(curves)), key=lambda k: (-(len(curves[k]) // 4), -own[k])):
        if tick:
            tick()
        if not own[k]:
            continue
        if len(shown) and (cKDTree(shown).query(curves[k])[0] < radius).mean() > covered:
            continue
        curve = curves[k] if closed[k] else one_period(curves[k], orbit)
        out.append(curve)
        rings.append(closed[k])
        copies = curve @ np.swapaxes(images[:, :3, :3], 1, 2) + images[:, None, :3, 3]
        shown = np.concatenate([shown, copies.reshape(-1, 3)])
    return out, rings


def one_period(curve, orbit, *, gap=4.0, cosine=0.85):
    """A curve that runs on as its own image, cut to the stretch up to where that begins; others as they are."""
    way = directions(curve)
    for g in np.concatenate([orbit.generators, inverse(orbit.generators)]):
        start, lead = g[:3, :3] @ curve[0] + g[:3, 3], g[:3, :3] @ way[0]
        at = int(np.argmin(np.linalg.norm(curve - start, axis=1)))
        if at >= 3 and np.linalg.norm(curve[at] - start) < gap and lead @ way[at] > cosine:
            return curve[: at + 1]
    return curve


def agreed(count, least, run, few=False):
    """(n,) bool, samples that enough occurrences agree on: `least`, or half of that along a run that has `least`.

    Holes are in other places in each occurrence. Where several coincide fewer show the curve; that it goes on there
    is known from its being one curve. Of `few` occurrences each shows what the others miss: there a run that is
    mostly agreed on is taken as a whole.
    """
    low = count >= max(1, (least + 1) // 2)
    fresh = np.r_[True, (np.diff(run) != 0) | (np.diff(low.astype(np.int8)) != 0)]
    stretch = np.cumsum(fresh) - 1
    strong = np.bincount(stretch, count >= least) > 0
    keep = low & strong[stretch]
    if few:
        _, run = np.unique(run, return_inverse=True)
        keep |= (np.bincount(run, keep) >= MOSTLY * np.bincount(run))[run]
    return keep


def least_agreement(count, wrong, weight):
    """Fewest agreeing occurrences that leave at most `CHANCE_SHARE` of the length to chance."""
    top = int(count.max(initial=0))
    for least in range(1, top + 1):
        seen, chance = weight[count >= least].sum(), weight[wrong >= least].sum()
        if chance <= CHANCE_SHARE * seen:
            return least
    return max(1, top)


def consolidate_places(network, poses, region, transformation, free, *, epsilon, progress=None, rounds=3) -> Draft:
    """Draft of a thing at given places; what some places show beside the region widens it."""
    for _ in range(rounds):
        overlay = fold_poses(network, poses, region, free, reach=12.0)
        draft = consolidate(network, overlay, transformation, epsilon=epsilon, progress=progress)
        draft = replace(draft, orbital=np.zeros(len(poses), bool))
        if not draft.curves:
            break
        region = np.concatenate(draft.curves)
        poses = refined_poses(network, draft, free, radius=2 * epsilon)
    return draft


def refined_poses(network: CurveNetwork, draft: Draft, free, *, radius, together=None, rounds=3):
    """Poses moved so that the draft's curves lie on the samples that show them; ICP, across the curves only.

    together : (a,) int64, occurrences of the same number keep their places to each other; None moves each alone

    An occurrence that shows too little to hold it stays where it is.
    """
    points = np.concatenate(draft.curves)
    lines = np.concatenate([directions(c) for c in draft.curves])
    samples = np.flatnonzero(free)
    poses = draft.poses.copy()
    if not len(samples):
        return poses
    tree = cKDTree(network.points[samples])
    together = np.arange(len(poses)) if together is None else together
    for number in np.unique(together):
        mine = np.flatnonzero(together == number)
        for _ in range(rounds):
            # Samples are taken back into the template's frame, where all occurrences speak of one motion.
            moved = points @ np.swapaxes(poses[mine, :3, :3], 1, 2) + poses[mine, None, :3, 3]
            distance, near = tree.query(moved, distance_upper_bound=radius)
            hit = np.isfinite(distance)
            near = samples[np.where(hit, near, 0)]
            way = lines @ np.swapaxes(poses[mine, :3, :3], 1, 2)
            hit &= np.abs((network.tangents[near] * way).sum(-1)) > 0.8
            if hit.sum() < 30:
                break
            a, k = np.nonzero(hit)
            back = inverse(poses[mine])[a]
            offset = np.einsum("nij,nj->ni", back[:, :3, :3], network.points[near[a, k]]) + back[:, :3, 3] - points[k]
            offset -= lines[k] * (offset * lines[k]).sum(1)[:, None]
            target = points[k] + offset
            mean_a, mean_b = points[k].mean(0), target.mean(0)
            turn, _ = best_rotation(((target - mean_b).T @ (points[k] - mean_a) + 1e-3 * np.eye(3))[None])
            poses[mine] = poses[mine] @ motion(turn[0], mean_b - turn[0] @ mean_a)
    return poses
