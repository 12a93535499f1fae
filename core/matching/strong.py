# SPDX-License-Identifier: GPL-3.0-or-later
"""Which curves carry strong evidence: for matching (section 4.1.1)."""

from __future__ import annotations

import numpy as np

from ..network.network import CurveNetwork


def mean_strength(network: CurveNetwork) -> float:
    """C, the average curvature along all curves, 1 / edge length; NaN where the input has none."""
    known = np.isfinite(network.strength)
    if not known.any():
        return float("nan")
    return float(np.average(network.strength[known], weights=np.maximum(network.lengths[known], 1e-12)))


def strong_curves(network: CurveNetwork, *, l0, strong_curvature):
    """(k,) int64, curves of strong evidence: longer than l0, or of high average curvature.

    A curve that is shorter than l0 holds no stretch of that length for Feature BLAST, however strong it is; like all
    curves it takes part in the later stages.
    """
    with np.errstate(invalid="ignore"):
        curved = network.strength > strong_curvature * mean_strength(network)
    return np.flatnonzero((network.lengths > l0) | curved)
