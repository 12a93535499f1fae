# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines as Wavefront OBJ."""

from __future__ import annotations

import io

import numpy as np


def write_obj(path, polylines, closed, groups=None):
    """Write polylines as `v` and `l` lines, with all digits; a closed one repeats its first index.

    Parameters
    ----------
    polylines : sequence of (k, 3) float64
    closed : sequence of bool
    groups : sequence of str or None, the object name of each; curves of one name must be consecutive
    """
    text, base, last = io.StringIO(), 1, None
    for i, (points, loop) in enumerate(zip(polylines, closed)):
        if groups is not None and groups[i] != last:
            last = groups[i]
            text.write(f"o {last}\n")
        for x, y, z in np.asarray(points, float).tolist():
            text.write(f"v {x:.17g} {y:.17g} {z:.17g}\n")
        index = list(range(base, base + len(points))) + ([base] if loop else [])
        text.write("l " + " ".join(map(str, index)) + "\n")
        base += len(points)
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text.getvalue())
