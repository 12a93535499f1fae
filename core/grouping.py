# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that are seen in the same cells belong together (section 5.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from .clustering import perturbed
from .drafts import Draft, explained_samples, placed, seen_points, seen_share
from .network.network import CurveNetwork

CHANCE_SEEN = 0.15
"""Share of a curve that clutter seems to show at a place where the curve does not occur."""


def group(network: CurveNetwork, draft: Draft, free, *, radius):
    """Split the curves of a draft into templates: curves that occur in the same cells belong together.

    Parameters
    ----------
    free : (n,) bool, samples that nothing explains yet
    radius : edge lengths, within which a sample shows a curve

    Returns
    -------
    drafts : list of Draft, the longest first; free : (n,) bool, without the samples that they explain

    Notes
    -----
    A sample is evidence once: what a group explains is taken away before the next one is looked for. A curve must be
    seen clearly better than beside its places: on a dense wall bits of other curves lie along any line.
    """
    out, places, rest = [], [], draft
    while rest.curves:
        evidence = seen_share(network, rest.curves, rest.poses, radius=radius, free=free)
        member, cells = _largest_group(evidence, rest.lengths, CHANCE_SEEN)
        left = np.setdiff1d(np.arange(len(rest.curves)), member)
        if len(cells) >= 2:
            one = replace(rest, evidence=evidence).part(member, cells)
            one = one.part(np.flatnonzero(_clear(network, one, free, radius)))
            if not one.curves:
                rest = rest.part(left)
                continue
            whole = next((k for k, known in enumerate(places) if _same_cells(known, cells)), None)
            if whole is None:
                places.append(cells)
                out.append(one)
            else:
                more = replace(rest, evidence=evidence).part(member, places[whole])
                more = more.part(np.flatnonzero(_clear(network, more, free, radius)))
                out[whole] = replace(
                    out[whole],
                    curves=out[whole].curves + more.curves,
                    closed=out[whole].closed + more.closed,
                    evidence=np.concatenate([out[whole].evidence, more.evidence], axis=1),
                )
            free = free & ~explained_samples(network, one, radius=radius, rivals=rest.part(left))
        rest = rest.part(left)
    return out, free


def _clear(network, draft, free, radius):
    """(c,) bool, curves of a group that are seen clearly better at its occurrences than beside them."""
    places = draft.poses[:: max(1, len(draft.poses) // BESIDE)]
    spread = np.concatenate(draft.curves).std(axis=0) + 1e-9
    chance = seen_share(network, draft.curves, perturbed(places, spread), radius=radius, free=free).mean(axis=0)
    typical = np.average(draft.evidence.mean(axis=0), weights=draft.lengths)
    return draft.evidence.mean(axis=0) >= chance + CLEAR * np.maximum(typical - chance, 0)


CLEAR, BESIDE = 0.55, 24
"""Where between chance and what is typical a curve must lie, and places beside which chance is looked at."""


def _same_cells(known, cells, *, least=0.75):
    """Whether a curve that is seen in `cells` belongs to what is seen in the known ones: holes hide it in the rest."""
    return len(np.intersect1d(known, cells)) >= least * len(np.union1d(known, cells))


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
        # A hole hides a curve here and there, not in most of the cells.
        now &= np.median(evidence[cells], axis=0) > chance
        now[np.argmax(length)] = True
        member = now
    return np.flatnonzero(member), np.flatnonzero(cells)


def _least_share(level):
    """Share of what a full cell shows that makes a cell an occurrence: the more is seen, the more is asked for."""
    return float(np.clip(level - 0.3, 0.35, 0.55))


APART, FEWEST, LARGEST, STRETCH = 0.25, 3, 10, 8
"""Share of their cells that groups of two kinds have in common at most, fewest cells of a kind, how many of the groups
may be kinds (those that show most), and points of a curve along which a kind of cells must show it, or not show it."""


def kinds_of_cells(network: CurveNetwork, draft: Draft, groups, *, radius):
    """(n,) int64, for each sample the kind of cells that it lies in; None where cells need not be told apart.

    Two wings of a building may have the same step, but other windows, or windows that are not on one lattice. Laid over
    each other, a sill of the one then continues a sill of the other, and the two are drafted as one curve. That there
    are two kinds of cells is known from all that differs; a curve of which one kind shows only a part is a mixture.

    Parameters
    ----------
    draft : all curves that the cells agree on; groups : list of Draft, those that are seen in the same cells
    radius : edge lengths, within which a sample shows a curve
    """
    large = sorted((one for one in groups if len(one.poses) >= FEWEST), key=_shown_length)[-LARGEST:]
    kinds = _kinds([(set(map(tuple, one.keys)), one) for one in reversed(large)])
    if len(kinds) < 2:
        return None
    mixed, shared = _mixed_and_shared(network, draft, [cells for cells, _ in kinds], radius)
    if draft.lengths[mixed].sum() <= draft.lengths[shared].sum():
        return None
    points = [placed(one)[0] for _, one in kinds]
    near = cKDTree(np.concatenate(points)).query(network.points, workers=-1)[1]
    return np.repeat(np.arange(len(kinds)), [len(p) for p in points])[near]


def _kinds(groups):
    """Of groups (cells, draft), those that have next to no cells in common and show most together."""
    if not groups:
        return []
    (cells, _one), rest = groups[0], groups[1:]
    apart = [g for g in rest if len(cells & g[0]) <= APART * min(len(cells), len(g[0]))]
    with_it, without = [groups[0], *_kinds(apart)], _kinds(rest) if len(apart) < len(rest) else []
    return max(with_it, without, key=lambda kinds: sum(_shown_length(one) for _, one in kinds))


def _shown_length(draft):
    return draft.lengths.sum() * len(draft.poses)


def _mixed_and_shared(network, draft, kinds, radius):
    """(c,) bool, curves of which a kind of cells shows a part and another one the rest; those that two show whole."""
    keys = list(map(tuple, draft.keys))
    seen = seen_points(network, draft.curves, draft.poses, radius=radius)
    share = np.stack([seen[[a for a, key in enumerate(keys) if key in kind]].mean(axis=0) for kind in kinds])
    size = np.array([len(c) for c in draft.curves])
    first = np.cumsum(size) - size
    typical = np.median(np.maximum.reduceat(share.max(axis=0), first))
    shown, hidden = share > 0.4 * typical, share < 0.15 * typical
    elsewhere = hidden & (shown.sum(axis=0) > 0)
    much, gone, rest = (np.add.reduceat(x, first, axis=1, dtype=int) for x in (shown, hidden, elsewhere))
    mixed = ((much >= STRETCH) & (rest >= STRETCH)).any(axis=0)
    return mixed, ((much >= 0.5 * size) & (gone < STRETCH)).sum(axis=0) >= 2


UNSEEN, CLEARLY, BY_CHANCE, RAREST = 0.1, 0.6, 0.003, 0.02
"""Share of a curve below which a cell does not show it and above which it surely does; the probability below which it
is no chance that holes hide several curves of one cell, and the least one that a hole hides a curve."""


def at_their_borders(network: CurveNetwork, whole: Draft, one: Draft, free, *, radius):
    """A group whose curves end where each is seen last, as one group for each set of cells: list of Draft.

    A row of seven columns has six arches. In the last cell the arches are not hidden by holes, they are not there; and
    the first column may stand in a cell beyond that shows nothing else.

    Parameters
    ----------
    whole : the draft with all cells of the orbit, which is not closed; one : the group
    free : (n,) bool, samples that may show the group
    """
    cells = np.arange(len(one.poses))
    keys = {tuple(key): a for a, key in enumerate(one.keys)}
    has = np.ones(one.evidence.shape, bool)
    hidden = max(RAREST, float((one.evidence <= UNSEEN).mean()))
    for a in cells:
        if any(_beyond(one.keys[a], keys)):
            missing = (one.evidence[a] <= UNSEEN) & (one.lengths >= STRETCH)
            if hidden ** missing.sum() < BY_CHANCE and not missing.all():
                has[a, missing] = False
    outside = [b for b, key in enumerate(whole.keys) if tuple(key) not in keys and any(_neighbours(key, keys))]
    more = whole.part([], outside)
    if outside:
        seen = seen_share(network, one.curves, more.poses, radius=radius, free=free)
        sure = seen >= CLEARLY
        sure &= ((sure @ one.lengths >= TOGETHER) & (sure.sum(axis=1) >= 2))[:, None]
        one = replace(
            one,
            poses=np.concatenate([one.poses, more.poses]),
            keys=np.concatenate([one.keys, more.keys]),
            orbital=np.concatenate([one.orbital, more.orbital]),
            evidence=np.concatenate([one.evidence, seen]),
        )
        has = np.concatenate([has, sure])
    sets, which = np.unique(has, axis=1, return_inverse=True)
    parts = [(np.flatnonzero(which.ravel() == k), np.flatnonzero(sets[:, k])) for k in range(sets.shape[1])]
    parts = [one.part(curves, at) for curves, at in parts if len(at) >= 2]
    return sorted(parts, key=lambda part: -part.lengths.sum())


TOGETHER = 25.0
"""Length of the curves that make a cell an occurrence of them, edge lengths."""


def _neighbours(key, keys):
    """For each axis and direction: whether the next cell there is one of the known ones."""
    for axis in range(len(key)):
        for side in (-1, 1):
            next_ = list(key)
            next_[axis] += side
            yield tuple(next_) in keys


def _beyond(key, keys):
    """For each axis and direction: whether nothing known lies further on in it."""
    for axis in range(len(key)):
        row = [k[axis] for k in keys if all(k[x] == key[x] for x in range(len(key)) if x != axis)]
        yield key[axis] == min(row) and len(row) > 1
        yield key[axis] == max(row) and len(row) > 1
