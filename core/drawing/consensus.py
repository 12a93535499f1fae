# SPDX-License-Identifier: GPL-3.0-or-later
"""Candidate curves: where enough poses of an overlay agree, one clean line (section 5.2)."""

from __future__ import annotations

import numpy as np

from ..consolidation.averaging import condense
from ..consolidation.consolidation import fit_curves
from ..consolidation.tracing import trace_curves
from .overlay import Overlay, agreement, decoys

CHANCE_SHARE = 0.1
"""Largest share of the agreeing samples that chance may explain."""

TRACED = 16
"""Bound on the work: poses that curves are traced on. Evidence is then taken from all of them."""

FEW, MOSTLY = 5, 0.5
"""Poses up to which a curve is also taken from a single one, and the share of it that must be agreed on."""


def candidate_curves(overlay: Overlay, *, epsilon, chance=CHANCE_SHARE, tick=None):
    """Clean curves on which the poses of an overlay agree: list of (k, 3) float64, list of bool (closed).

    A sample is kept when enough other poses show it: as many as leave only `CHANCE_SHARE` to chance, which is what is
    left when the poses are moved against each other.
    """
    shown = np.bincount(overlay.cell, overlay.weights, minlength=overlay.cells)
    best = np.sort(np.argsort(-shown, kind="stable")[:TRACED])
    overlay = overlay.of_cells(best[shown[best] > 0])
    if overlay.cells < 2:
        return [], []
    count, mean = agreement(overlay, radius=1.25 * epsilon)
    wrong, _ = agreement(overlay, radius=1.25 * epsilon, moved=_scattered(overlay))
    keep = agreed(
        count, least_agreement(count, wrong, overlay.weights, chance), overlay.run,
        few=_well_shown(overlay.cell, overlay.weights * (count > 0)) <= FEW,
    )  # fmt: skip
    if not keep.any():
        return [], []
    weight, run = overlay.weights[keep], overlay.run[keep]
    points, lines = condense(mean[keep], overlay.tangents[keep], weight, radius=epsilon, tick=tick)
    paths = trace_curves(points, lines, tick=tick)
    trails = (mean, overlay.tangents, overlay.run)
    return fit_curves(paths, mean[keep], lines, weight, run, trails=trails, tick=tick)


def _scattered(overlay):
    """Places (n, 3) of the samples when each pose is moved by a decoy of its own."""
    way = decoys(overlay.points, overlay.cells)[overlay.cell]
    return np.einsum("nij,nj->ni", way[:, :3, :3], overlay.points) + way[:, :3, 3]


def _well_shown(cell, weight):
    """Number of poses that show at least a quarter of what the fullest one does."""
    shown = np.bincount(cell, weight)
    return int((shown >= 0.25 * shown.max()).sum())


def agreed(count, least, run, few=False):
    """(n,) bool, samples that enough poses agree on: `least`, or half of that along a run that has `least`.

    Holes are in other places in each pose. Where several coincide fewer show the curve; that it goes on there is
    known from its being one curve. Of `few` poses each shows what the others miss: there a run that is mostly agreed
    on is taken as a whole.
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


def least_agreement(count, wrong, weight, share=CHANCE_SHARE):
    """Fewest agreeing poses that leave at most a share of the length to chance."""
    top = int(count.max(initial=0))
    for least in range(1, top + 1):
        seen, chance = weight[count >= least].sum(), weight[wrong >= least].sum()
        if chance <= share * seen:
            return least
    return max(1, top)
