# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the origin of a scene lies in the world: kept on results, and on scenes by this program and by BlenderGIS."""

from __future__ import annotations

import numpy as np

SHIFT = "fcn_shift"  # of a scene and of a result's collection: what is added to its coordinates, double precision
STEP = "fcn_step"  # of a result far from the origin of its scene: the step of single precision there
CRS = "crs x", "crs y"  # of a scene of BlenderGIS: the same, along two axes


def of(owner) -> np.ndarray:
    """(3,) float64, the shift of a scene or a collection, zero where it has none."""
    kept = owner.get(SHIFT)
    if kept is not None and len(kept) == 3:
        return np.array(kept, float)
    given = [owner.get(name, 0.0) for name in CRS]
    if all(isinstance(value, int | float) and np.isfinite(value) for value in given):
        return np.array([*given, 0.0], float)
    return np.zeros(3)


def keep(owner, shift):
    """Store a shift on a scene or a collection, nothing where it is zero."""
    if np.any(shift):
        owner[SHIFT] = [float(value) for value in shift]


def words(shift) -> str:
    """A shift for people: "450,000, 5,411,000, 0"; empty where it is zero."""
    return ", ".join(f"{value:,.10g}" for value in shift) if np.any(shift) else ""
