# SPDX-License-Identifier: GPL-3.0-or-later
"""What is too coarse of an input: the coordinates of a scan."""

from __future__ import annotations

import numpy as np

SHARE = 0.1
"""Of the edge length: what is rounded coarser bends the surface more than the noise of scanners does."""
SAMPLE = 100_000  # points that are looked at
FULL = 0.5
"""Share of the steps between the least and the greatest coordinate that points lie on. Rounding fills nearly all of
them, as a surface has many points for each; few are filled where the steps are only what a pattern happens to have."""


def rounding_step(points, triangles, edge_length):
    """The step to which coordinates (n, 3) are rounded, scene units, where it is above `SHARE` of the edge length.

    None where they are fine. A grid of heights is no rounded scan: its edges lead from one step to the next.
    """
    points = np.asarray(points, float)
    every, corners = points[:: max(1, len(points) // SAMPLE)], points[triangles[:SAMPLE]]
    found = 0.0
    for axis in range(3):
        step = _step(every[:, axis])
        along = np.abs(corners[..., axis] - np.roll(corners[..., axis], 1, axis=1)).max(initial=0.0)
        is_grid = along < 1.5 * step and 0.5 * edge_length < step < 1.5 * edge_length
        if not is_grid or _is_single_precision(every[:, axis], step):
            found = max(found, step)
    return found if found > SHARE * edge_length else None


def _step(values) -> float:
    """The step on which all values lie, 0 where there is none."""
    places = np.unique(values)
    apart = np.diff(places) > 1e-9 * np.abs(places).max(initial=0.0)  # 0.1 + 0.2 is not quite 0.3
    places = places[np.r_[True, apart]] if len(places) else places
    if len(places) < 4:
        return 0.0
    step = float(np.diff(places).min())
    steps = (places - places[0]) / step
    if len(places) < FULL * steps[-1] or (np.abs(steps - np.round(steps)) > 1e-3).any():
        return 0.0
    return step


def _is_single_precision(values, step) -> bool:
    """Whether a step is that of single precision at the greatest value."""
    spacing = float(np.spacing(np.float32(np.abs(values).max())))
    return bool(np.array_equal(values, values.astype(np.float32))) and step in (spacing, 0.5 * spacing)
