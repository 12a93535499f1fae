# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates that are rigid copies of each other, or that hold copies within themselves, become one (section 5.2)."""

from __future__ import annotations

from collections import Counter
from itertools import combinations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .congruence import congruent_parts, find_alike
from .drafts import Draft, explained_length, placed, seen_share
from .figures import one_of_figures
from .geometry.motions import inverse
from .grouping import group
from .network.network import CurveNetwork
from .occurrences import share_place
from .polishing import settled


def unite(network: CurveNetwork, drafts: list[Draft], free, parameters, *, threads=1, tick=None) -> list[Draft]:
    """Drafts in which curves that are rigid copies of each other are one template with the occurrences of all.

    free : (n,) bool, samples that may show them; tick : called between steps, so that the run can be stopped

    A template of two pairs of things becomes one pair first, and then one thing.
    """
    for _ in range(4):
        united = _united(network, drafts, free, parameters, threads, tick or (lambda: None))
        if united is drafts:
            break
        drafts = united
    return drafts


def _united(network, drafts, free, parameters, threads, tick):
    """The drafts after one round, or just the given ones where nothing is a copy of anything."""
    p, epsilon = parameters, parameters.epsilon
    radius = 1.25 * epsilon
    items = [(d, c) for d, draft in enumerate(drafts) for c in range(len(draft.curves))]
    if len(items) < 2:
        return drafts
    home = _homes(drafts)
    lines = [drafts[d].curves[c] @ home[d][:3, :3].T + home[d][:3, 3] for d, c in items]
    surface = (None, None)
    if network.normals is not None:
        nearest = cKDTree(network.points).query(np.concatenate(lines))[1]
        surface = network.normals[nearest], None if network.kind is None else network.kind[nearest]
    alike = find_alike(
        lines, surface, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, epsilon=epsilon, threads=threads,
        tick=tick,
    )  # fmt: skip
    together = _together(drafts)
    groups = congruent_parts(alike, [together[d] for d, _ in items], l0=p.l0)
    united = []
    for places in groups:
        used = [items[k] for _, members in places for k in members]
        tick()
        draft = _whole(network, drafts, home, items, lines, places, free, epsilon, tick)
        tick()
        new, _ = group(network, draft, free, radius=radius)
        # What was explained by the parts must be explained by the whole.
        before = [drafts[d].part([c for e, c in used if e == d]) for d in sorted({d for d, _ in used})]
        if explained_length(network, new, radius=radius) >= 0.97 * explained_length(network, before, radius=radius):
            united += new
    if not united:
        united = one_of_figures(network, drafts, alike.motions, free, epsilon, tick)
    if not united:
        return drafts
    return united + [left for draft in drafts if (left := _uncovered(draft, united, radius)) is not None]


SHARED = 0.6
"""Share of the cells of the rarer one in which drafts of one orbit must stand together to be parts of one thing."""


def _cells(draft):
    """The cells of its orbit that a draft is in: key -> occurrence."""
    return {tuple(key): a for a, key in enumerate(draft.keys.tolist()) if draft.orbital[a]}


def _together(drafts):
    """(d,) int64, the same for drafts that stand together in the cells of one orbit."""
    cells = [set(_cells(draft)) for draft in drafts]
    one = np.eye(len(drafts), dtype=bool)
    for a, b in combinations(range(len(drafts)), 2):
        if drafts[a].transformation == drafts[b].transformation:
            one[a, b] = len(cells[a] & cells[b]) >= SHARED * max(min(len(cells[a]), len(cells[b])), 1)
    return connected_components(coo_matrix(one), directed=False)[1]


def _homes(drafts):
    """(4, 4) for each draft, the occurrence at which it is looked at: the same cell for drafts of one orbit, if it can.

    What stands together in a cell may be in several drafts, by the cells in which each was seen.
    """
    cells = [_cells(draft) for draft in drafts]
    home = []
    for draft, own in zip(drafts, cells):
        shown = Counter()
        for other, theirs in zip(drafts, cells):
            if other.transformation == draft.transformation:
                shown.update({key: other.lengths.sum() for key in theirs})
        best = max(own, key=lambda key: (round(shown[key]), [-k for k in key]), default=None)
        home.append(draft.poses[own[best] if own else 0])
    return home


def _whole(network, drafts, home, items, lines, places, free, epsilon, tick):
    """One draft of what is at several places: the longest version of its curves, with the occurrences of all."""
    place, members = max(places, key=lambda entry: sum(len(lines[k]) for k in entry[1]))
    back = inverse(place)
    curves = [lines[k] @ back[:3, :3].T + back[:3, 3] for k in members]
    closed = [drafts[d].closed[c] for d, c in (items[k] for k in members)]
    for k, back in _beside(items, lines, places, radius=1.25 * epsilon):
        curve = lines[k] @ back[:3, :3].T + back[:3, 3]
        if not len(curves) or (cKDTree(np.concatenate(curves)).query(curve)[0] < 1.25 * epsilon).mean() < TWICE:
            curves.append(curve)
            closed.append(drafts[items[k][0]].closed[items[k][1]])
    # What is at one place may be from several drafts; each knows occurrences of it.
    known = [(place, d) for place, members in places for d in sorted({items[k][0] for k in members})]
    sources = [drafts[d] for _, d in known]
    most = max(sources, key=lambda source: len(source.poses))
    poses = [drafts[d].poses @ inverse(home[d]) @ place for place, d in known]
    cells = [
        (source.keys, source.orbital)
        if source.transformation == most.transformation
        else (np.zeros((len(source.poses), most.keys.shape[1]), np.int64), np.zeros(len(source.poses), bool))
        for source in sources
    ]
    keys, orbital = (np.concatenate(x) for x in zip(*cells))
    # Cells of one place move together: all of them tell where that place is. Others stand alone.
    together = np.repeat(np.arange(len(known)), [len(p) for p in poses])
    together = np.where(orbital, together, len(known) + np.arange(len(together)))
    poses = np.concatenate(poses)
    evidence = seen_share(network, curves, poses, radius=1.25 * epsilon, free=free)
    draft = Draft(curves, closed, poses, keys, evidence, most.transformation, orbital)
    kept = _one_a_place(draft)
    draft = draft.part(cells=kept)
    return settled(network, draft, free, radius=1.25 * epsilon, together=together[kept], tick=tick)


TWICE, BESIDE = 0.5, 0.5
"""Share of a curve that others must show for it to be there already, and how far from a thing a curve may be to be a
part of it, the median of its distances in multiples of the thing's size."""


def _beside(items, lines, places, *, radius):
    """Curves that are parts of one place only, longest first, each with the motion back to the common frame.

    Holes may hide a curve from the cells of one draft and not from those of another. Whether the other places show it
    is asked afterwards; here it only has to stand beside curves of its own draft that are at a place.
    """
    used = {k for _, members in places for k in members}
    found = []
    for k in sorted(set(range(len(items))) - used, key=lambda k: (-len(lines[k]), k)):
        gaps = []
        for n, (_, members) in enumerate(places):
            own = [m for m in members if items[m][0] == items[k][0]]
            if own:
                points = np.concatenate([lines[m] for m in own])
                gap = np.median(cKDTree(points).query(lines[k])[0])
                gaps.append((gap / max(np.linalg.norm(points.std(axis=0)), radius), n))
        if gaps and min(gaps)[0] < BESIDE:
            found.append((k, inverse(places[min(gaps)[1]][0])))
    return found


def _one_a_place(draft):
    """The occurrences (k,) without those that lie where another one does, which shows the curves better."""
    region = np.concatenate(draft.curves)
    share = draft.evidence @ draft.lengths
    kept = []
    for k in np.argsort(-share, kind="stable"):
        if not share_place(region, draft.poses[k : k + 1], draft.poses[kept])[0]:
            kept.append(int(k))
    return np.array(sorted(kept))


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
    return draft.part(keep)
