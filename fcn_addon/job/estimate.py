# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run would work on, and about how long it takes."""

from __future__ import annotations

from dataclasses import dataclass

from ...core.matching.strong import strong_curves
from ...core.network.building import build_network
from ...core.network.edge_length import Estimate, estimate
from .. import rates


@dataclass(frozen=True)
class Summary:
    """Numbers about the chosen curves.

    samples : of all curves, an edge length apart
    strong : curves that take part in the matching
    seconds : a rough time for the run
    again : nothing is selected, these are the curves of the active result
    coarse : the edge length is an estimate from segments of very different lengths
    outline : where it is a fiftieth of a typical outline of a drawing, the size of that, scene units
    left_out : what of the chosen objects is not taken, in words
    """

    objects: int
    curves: int
    samples: int
    edge_length: float
    strong: int
    seconds: float
    again: bool = False
    coarse: bool = False
    outline: float | None = None
    left_out: str = ""


def summarise(curves, edge_length, parameters, objects=1, again=False) -> Summary:
    """Count what a run would work on; `edge_length` is estimated where it is None."""
    guess = Estimate(edge_length) if edge_length else estimate(curves)
    unit = guess.length
    network = build_network(curves, edge_length=unit, smoothing=parameters.smoothing)
    strong = strong_curves(network, l0=parameters.l0, strong_curvature=parameters.strong_curvature)
    seconds = sum(rates.completing(len(network.points)).values())
    coarse = guess.spread is not None
    return Summary(objects, len(curves), len(network.points), unit, len(strong), seconds, again, coarse, guess.outline)
