# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run would work on, and about how long it takes."""

from __future__ import annotations

from dataclasses import dataclass

from ...core.matching.strong import strong_curves
from ...core.network.building import build_network
from ...core.network.edge_length import estimate_edge_length


@dataclass(frozen=True)
class Summary:
    """Numbers about the chosen curves.

    samples : of all curves, an edge length apart
    strong : curves that take part in the matching
    seconds : a rough time for the run
    again : nothing is selected, these are the curves of the active result
    """

    objects: int
    curves: int
    samples: int
    edge_length: float
    strong: int
    seconds: float
    again: bool = False


def summarise(curves, edge_length, parameters, objects=1, again=False) -> Summary:
    """Count what a run would work on; `edge_length` is estimated where it is None."""
    unit = edge_length or estimate_edge_length(curves)
    network = build_network(curves, edge_length=unit, smoothing=parameters.smoothing)
    strong = strong_curves(network, l0=parameters.l0, strong_curvature=parameters.strong_curvature)
    seconds = rough_seconds(len(network.points), float(network.lengths[strong].sum()))
    return Summary(objects, len(curves), len(network.points), unit, len(strong), seconds, again)


def rough_seconds(samples, strong) -> float:
    """A rough time for a run with so many samples, and so many on strong curves: fitted to runs on two cores."""
    return 1.0 + 1.8e-3 * samples + 3.0e-8 * strong**2
