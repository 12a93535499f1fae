# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method: a noisy feature curve network in, a completed one out."""

from __future__ import annotations

import os
import time
from dataclasses import replace

import numpy as np

from .clustering import cluster_votes
from .completion import build_completion
from .errors import InputError
from .matching.blast import feature_blast
from .matching.strong import strong_curves
from .matching.voting import vote
from .network.building import build_network
from .network.edge_length import estimate_edge_length
from .orbits import detect_orbits
from .parameters import Parameters
from .remainder import further_orbits
from .selection import select_model
from .support import Screen
from .templates import extract_templates
from .threads import single_threaded
from .values import Completion, Curves


def complete(curves: Curves, *, edge_length=None, parameters: Parameters | None = None, progress=None) -> Completion:
    """Find what recurs in a feature curve network, and complete the network by it.

    Parameters
    ----------
    curves : scene units, any pose; never modified
    edge_length : scene units; None estimates it from the curves
    progress : called as progress(stage, fraction) with the stages blast, voting, clustering, orbits, selection
        and completion; may raise Cancelled, which is passed on

    Raises
    ------
    InputError : names the value and the remedy
    """
    with single_threaded():
        return _complete(curves, edge_length, (parameters or Parameters()).validate(), progress)


def _complete(curves, edge_length, p, progress):
    threads = p.threads or os.cpu_count() or 1
    if edge_length is None:
        edge_length = estimate_edge_length(curves)
    seconds, clock = {}, _Clock(progress)
    network = build_network(curves, edge_length=edge_length, smoothing=p.smoothing)
    strong = strong_curves(network, l0=p.l0, strong_curvature=p.strong_curvature)
    longest = network.lengths.max()
    if not longest > p.l0:
        raise InputError(
            f"no curve is strong: none is longer than l0 = {p.l0:g} edge lengths, the longest has {longest:.1f}; "
            f"try l0 = {max(4, int(0.5 * longest))}, or check the edge length {edge_length:g}"
        )
    with clock.stage("blast", seconds):
        matches = feature_blast(
            network, strong, l0=p.l0, s=p.s, t=p.t, delta_l=p.delta_l, block=p.block, threads=threads,
            progress=clock.progress,
        )  # fmt: skip
    with clock.stage("voting", seconds):
        votes = vote(network, matches, bin_translation=p.bin_translation, bin_rotation=p.bin_rotation)
    found, point_pairs = len(matches), matches.point_pairs
    del matches  # By far the largest value of all stages.
    with clock.stage("clustering", seconds):
        screen = Screen(network, radius=p.epsilon, threads=threads, tick=clock.tick)
        clusters = cluster_votes(
            network, votes, screen, cluster_translation=p.cluster_translation, cluster_rotation=p.cluster_rotation,
            progress=clock.progress,
        )  # fmt: skip
    with clock.stage("orbits", seconds):
        orbits = detect_orbits(network, clusters, screen, progress=clock.progress)
    with clock.stage("selection", seconds):
        how = {"l0": p.l0, "t": p.t, "bayes_ratio": p.bayes_ratio, "progress": clock.progress}
        model = select_model(network, orbits, screen, **how)
        more = further_orbits(network, model, votes, screen, p)
        if more:
            model = select_model(network, model.orbits + more, screen, **how)
    with clock.stage("completion", seconds):
        drafts, courses, orbits = extract_templates(
            network, model, votes, clusters, screen, p, progress=clock.progress
        )  # fmt: skip
        model = replace(model, orbits=orbits)
        completion = build_completion(network, model, drafts, courses, len(curves), p, seconds)
    counts = np.diff(network.offsets)
    completion.work.update(
        strong_curves=len(strong), strong_samples=int(counts[strong].sum()), point_pairs=point_pairs,
        matches=found, transformations=len(clusters),
    )  # fmt: skip
    return completion


class _Clock:
    """Times the stages and reports the beginning and end of each."""

    def __init__(self, progress):
        self._report, self._last = progress or (lambda stage, fraction: None), ("blast", 0.0)

    def progress(self, stage, fraction):
        self._last = (stage, fraction)
        self._report(stage, fraction)

    def tick(self):
        """Report where things stand once more, so that the run can be stopped between two steps."""
        self._report(*self._last)

    def stage(self, name, seconds):
        return _Stage(self, name, seconds)


class _Stage:
    def __init__(self, clock, name, seconds):
        self.clock, self.name, self.seconds = clock, name, seconds

    def __enter__(self):
        self.clock.progress(self.name, 0.0)
        self.began = time.perf_counter()

    def __exit__(self, kind, value, trace):
        self.seconds[self.name] = time.perf_counter() - self.began
        if kind is None:
            self.clock.progress(self.name, 1.0)
