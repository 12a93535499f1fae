# SPDX-License-Identifier: GPL-3.0-or-later
"""The edge length of the mesh that curves came from, estimated from the curves."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from ..geometry.polylines import segments
from ..values import Curves

CROSSING = np.pi * np.sqrt(3) / 12
"""Mean length of a random chord of an equilateral triangle of edge 1 (pi x area / perimeter)."""


def estimate_edge_length(curves: Curves, *, crossings: bool = False) -> float:
    """Edge length of the mesh that the curves came from, in scene units.

    Curves along mesh edges show it as their median segment. Crest lines cut through triangles
    (`crossings`): a random chord of an equilateral triangle is `CROSSING` of its edge long.
    """
    _, steps = segments(curves)
    steps = steps[steps > 0]
    if not len(steps):
        raise InputError("no curve has a length: give curves of at least two different points")
    return float(np.mean(steps) / CROSSING if crossings else np.median(steps))
