# SPDX-License-Identifier: GPL-3.0-or-later
"""Empty cells: where an orbit has a cell and no pose was found, what the network shows there is asked once more."""

from __future__ import annotations

import numpy as np

from ..evidence.alignment import align
from ..evidence.field import Field
from .growth import ORBIT_POSE, PROMINENT, SAME_POSE, accepted, prominence
from .hypothesis import Hypothesis, explained
from .significance import evident


def with_empty_cells(field: Field, thing: Hypothesis, orbit, others) -> Hypothesis:
    """The thing with the empty cells of its orbit that show it.

    orbit : with `empty_poses()`; others : things (list) whose samples are explained already
    """
    poses = orbit.empty_poses()
    if not len(poses):
        return thing
    owned = np.zeros(len(field), bool)
    for other in others:
        owned |= explained(field, other)
    moved = align(field, poses, thing.probe, radii=(4.0, 2.5, 2.0))
    gap = np.linalg.norm(thing.embedded(moved) - thing.embedded(poses), axis=1)
    moved = moved[gap < SAME_POSE]
    moved = moved[prominence(field, thing, moved, owned) >= PROMINENT]
    if not len(moved):
        return thing
    return evident(field, accepted(field, thing, moved, np.full(len(moved), ORBIT_POSE), owned))
