# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that are seen in the same cells belong together (section 5.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .clustering import perturbed
from .drafts import Draft, explained_samples, seen_share
from .network import CurveNetwork

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
