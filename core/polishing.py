# SPDX-License-Identifier: GPL-3.0-or-later
"""The last word of the samples: generators and clean curves fitted to all occurrences at once.

A generator that is wrong by a tenth of an edge length is wrong by a whole one ten cells on, and what is averaged then
is blurred. Each occurrence tells across its curves only; together they tell the generator well.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from .consolidation.averaging import settle
from .drafting import refined_poses
from .drafts import Draft, seen_share
from .geometry.motions import exponential, inverse
from .geometry.polylines import directions
from .network.network import CurveNetwork
from .orbits import Orbit

SHOWN, ROUNDS, SCALE, WEAK = 0.3, 4, 0.7, 0.02
"""Share of a curve that an occurrence must show to have a say, steps of Gauss and Newton, the distance (edge lengths)
from which on a sample counts less (Geman and McClure), and the relative singular value below which the samples say
too little of a combination of parameters to change it."""


def fit_orbit(network: CurveNetwork, orbit: Orbit, draft: Draft, samples, *, radius, tick=None) -> tuple[Orbit, Draft]:
    """Generators of an orbit fitted to all occurrences of a draft's curves together.

    Parameters
    ----------
    draft : with occurrences at powers of the orbit, its keys
    samples : (k,) int64, samples of the network that take part
    radius : edge lengths within which a sample shows a curve

    Returns
    -------
    orbit : of the same kind, count and closure; draft : with its occurrences at the powers of it

    Notes
    -----
    Gauss and Newton's method on the distances across the curves, over the generators and one motion of all curves.
    """
    if not draft.curves or not len(samples):
        return orbit, draft
    points, tangents, cell = _shown_points(draft)
    if not len(points):
        return orbit, draft
    tree = cKDTree(network.points[samples])
    twists, base = orbit.twists.copy(), np.eye(4)
    reach = radius
    for _ in range(ROUNDS):
        if tick:
            tick()
        poses = exponential(draft.keys @ twists) @ base
        r, t = poses[cell, :3, :3], poses[cell, :3, 3]
        at, way = np.einsum("nij,nj->ni", r, points) + t, np.einsum("nij,nj->ni", r, tangents)
        distance, near = tree.query(at, distance_upper_bound=reach, workers=-1)
        hit = np.isfinite(distance)
        near = samples[np.where(hit, near, 0)]
        hit &= np.abs((network.tangents[near] * way).sum(1)) > 0.8
        if hit.sum() < 60:
            break
        use = np.flatnonzero(hit)
        gap = network.points[near[use]] - at[use]
        across = np.eye(3) - way[use][:, :, None] * way[use][:, None, :]
        gap = np.einsum("nij,nj->ni", across, gap)
        weight = 1 / (1 + (gap**2).sum(1) / SCALE**2)
        step = _step(orbit, twists, base, draft.keys[cell[use]], points[use], at[use], across, gap, weight)
        twists = _moved_twists(orbit, twists, step[: twists.size])
        base = exponential(step[None, twists.size :])[0] @ base
        reach = max(1.0, 0.7 * reach)
    moved = exponential(draft.keys @ twists) @ base
    way = np.einsum("nij,nj->ni", (moved - draft.poses)[cell, :3, :3], points) + (moved - draft.poses)[cell, :3, 3]
    if np.quantile(np.linalg.norm(way, axis=1), 0.9) > 2 * radius:
        return orbit, draft
    orbit = replace(orbit, twists=twists)
    curves = [c @ base[:3, :3].T + base[:3, 3] for c in draft.curves]
    return orbit, replace(draft, curves=curves, poses=orbit.power(draft.keys))


def _shown_points(draft: Draft):
    """Points and tangents (n, 3) of the curves for each occurrence that shows them, and the occurrence (n,)."""
    parts = [
        (c, directions(c), np.full(len(c), a))
        for i, c in enumerate(draft.curves)
        for a in np.flatnonzero(draft.evidence[:, i] > SHOWN)
    ]
    return tuple(np.concatenate(x) for x in zip(*parts)) if parts else (np.zeros((0, 3)),) * 2 + (np.zeros(0, int),)


def _step(orbit, twists, base, keys, points, at, across, gap, weight, small=1e-5):
    """Change (g 6 + 6,) of the twists and of the motion of all curves that reduces the gaps most."""
    columns = []
    for p in range(twists.size + 6):
        change = np.zeros(twists.size + 6)
        change[p] = small
        moved = exponential(keys @ _moved_twists(orbit, twists, change[: twists.size]))
        moved = moved @ (exponential(change[None, twists.size :])[0] @ base)
        way = np.einsum("nij,nj->ni", moved[:, :3, :3], points) + moved[:, :3, 3] - at
        columns.append(np.einsum("nij,nj->ni", across, way / small) * np.sqrt(weight)[:, None])
    jacobian = np.stack(columns, axis=-1).reshape(-1, twists.size + 6)
    scale = np.maximum(np.linalg.norm(jacobian, axis=0), 1e-9)
    step = np.linalg.lstsq(jacobian / scale, (gap * np.sqrt(weight)[:, None]).ravel(), rcond=WEAK)[0]
    return step / scale


def _moved_twists(orbit, twists, change):
    """Twists of an orbit's kind nearest to the changed ones: no turn, no slide or a fixed angle where it has none."""
    new = twists + change.reshape(twists.shape)
    if orbit.kind in ("translation", "grid"):
        new[:, :3] = 0
        return new
    if orbit.closed:
        new[:, :3] *= np.linalg.norm(twists[:, :3]) / np.linalg.norm(new[:, :3])
    if orbit.kind == "rotation":
        axis = new[:, :3] / np.linalg.norm(new[:, :3])
        new[:, 3:] -= axis * (axis * new[:, 3:]).sum(axis=1, keepdims=True)
    return new


def settled(network: CurveNetwork, draft: Draft, free, *, radius, together=None, rounds=2, tick=None) -> Draft:
    """A draft whose poses, and then its curves, are fitted to the free samples (n,) bool.

    together : (a,) int64, occurrences of the same number move as one; None leaves the cells of an orbit where they
        are and moves each of the others alone
    """
    if together is None and draft.orbital.all():
        return draft
    for _ in range(rounds):
        poses = refined_poses(network, draft, free, radius=radius, together=together)
        if together is None:
            poses = np.where(draft.orbital[:, None, None], draft.poses, poses)
        draft = replace(draft, poses=poses)
        draft = fit_to_samples(network, draft, np.flatnonzero(free), radius=radius, tick=tick)
    return replace(draft, evidence=seen_share(network, draft.curves, draft.poses, radius=radius, free=free))


def fit_to_samples(network: CurveNetwork, draft: Draft, samples, *, radius, tick=None) -> Draft:
    """A draft whose curves are the mean of all samples that show them, taken back from their occurrences."""
    points, tangents, cell = _shown_points(draft)
    if not len(points):
        return draft
    pose = draft.poses[cell]
    at = np.einsum("nij,nj->ni", pose[:, :3, :3], points) + pose[:, :3, 3]
    way = np.einsum("nij,nj->ni", pose[:, :3, :3], tangents)
    distance, near = cKDTree(at).query(network.points[samples], k=4, distance_upper_bound=radius, workers=-1)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    found &= np.abs((way[near] * network.tangents[samples][:, None]).sum(-1)) > 0.7
    use = np.flatnonzero(found.any(axis=1))
    if not len(use):
        return draft
    home = cell[near[use, found[use].argmax(axis=1)]]
    use = samples[use]
    back = inverse(draft.poses[home])
    folded = np.einsum("nij,nj->ni", back[:, :3, :3], network.points[use]) + back[:, :3, 3]
    lines = np.einsum("nij,nj->ni", back[:, :3, :3], network.tangents[use])
    _, run = np.unique(home * len(network) + network.curve_of[use], return_inverse=True)
    weight = network.weights[use]
    return replace(draft, curves=settle(draft.curves, draft.closed, folded, lines, weight, run.ravel(), tick=tick))
