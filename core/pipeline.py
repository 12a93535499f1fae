# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method (Figure 2): a noisy feature curve network in, a completed one out."""

from __future__ import annotations

import os

import numpy as np

from .completion import build_completion
from .drawing import draw
from .errors import InputError
from .evidence.field import Field
from .hypotheses.completing import with_empty_cells_of_all
from .hypotheses.finding import find_things
from .hypotheses.seeding import find_seeds
from .matching.blast import feature_blast
from .matching.strong import strong_curves
from .model.selection import select_model
from .network.building import build_network, faithful_smoothing
from .network.edge_length import estimate_edge_length
from .parameters import Parameters
from .stages import Clock
from .threads import single_threaded
from .transformations.description import describe
from .values import Completion, Curves


def complete(curves: Curves, *, edge_length=None, parameters: Parameters | None = None, progress=None) -> Completion:
    """Find what recurs in a feature curve network, and complete the network by it.

    Parameters
    ----------
    curves : scene units, any pose; never modified
    edge_length : scene units; None estimates it from the curves
    progress : called as progress(stage, fraction) with the names in `core.stages.STAGES`; may raise Cancelled, which is
        passed on

    Raises
    ------
    InputError : names the value and the remedy
    """
    with single_threaded():
        return _complete(curves, edge_length, (parameters or Parameters()).validate(), Clock(progress))


def _complete(curves, edge_length, p, clock):
    if edge_length is None:
        edge_length = estimate_edge_length(curves)
    network = build_network(curves, edge_length=edge_length, smoothing=p.smoothing)
    with clock.stage("blast"):
        matches, work = _matches(network, p, clock)
    with clock.stage("seeding"):
        field = Field(network, radius=p.epsilon, tick=clock.tick)
        seeds, left_out = find_seeds(field, matches, epsilon=p.epsilon, tick=clock.tick)
        del matches  # By far the largest value of all stages.
    with clock.stage("growth"):
        things = find_things(field, seeds, significance=p.significance, tick=clock.tick)
    with clock.stage("orbits"):
        things = with_empty_cells_of_all(field, things, clock.tick)
    with clock.stage("selection"):
        model = select_model(field, things, l0=p.l0, t=p.t, bayes_ratio=p.bayes_ratio, tick=clock.tick)
        orbits = [describe(thing) for thing in model.things]
    with clock.stage("completion"):
        faithful = faithful_smoothing(curves, edge_length=edge_length, most=p.smoothing)
        network = build_network(curves, edge_length=edge_length, smoothing=faithful)
        drafts = draw(network, model.things, p, orbits=orbits, tick=clock.tick)
        completion = build_completion(network, model, orbits, drafts, len(curves), p, tick=clock.tick)
    completion.seconds.update(clock.seconds)
    completion.work.update(work, seeds=len(seeds), matches_left_out=left_out, transformations=len(things))
    return completion


def _matches(network, p, clock):
    """Matches of Feature BLAST at both lengths (list), and the counts of its work (dict)."""
    strong = strong_curves(network, l0=p.l0, strong_curvature=p.strong_curvature)
    longest = network.lengths.max()
    if not longest > p.l0:
        shorter = f"l0 = {max(4, int(0.5 * longest))}, or " if longest > 4 else ""
        raise InputError(
            f"no curve is strong: none is longer than l0 = {p.l0:g} edge lengths, the longest has {longest:.1f}; "
            f"try {shorter}an edge length of {0.5 * network.unit * longest / p.l0:.2g} instead of {network.unit:.3g}"
        )
    found = []
    lengths = [p.l0, min(p.l0, p.short_l0)]
    for k, l0 in enumerate(dict.fromkeys(lengths)):
        report = lambda stage, f, k=k: clock.progress(stage, 0.3 * k + (0.3 + 0.4 * k) * f)  # noqa: E731
        found.append(
            feature_blast(
                network, strong_curves(network, l0=l0, strong_curvature=p.strong_curvature), l0=l0, s=p.s, t=p.t,
                delta_l=p.delta_l, block=p.block, threads=p.threads or os.cpu_count() or 1, progress=report,
            )
        )  # fmt: skip
    work = {
        "strong_curves": len(strong), "strong_samples": int(np.diff(network.offsets)[strong].sum()),
        "point_pairs": sum(m.point_pairs for m in found), "matches": sum(map(len, found)),
    }  # fmt: skip
    return found, work
