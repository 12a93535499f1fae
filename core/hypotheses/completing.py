# SPDX-License-Identifier: GPL-3.0-or-later
"""Empty cells: where an orbit has a cell and no pose was found, what the network shows there is asked once more."""

from __future__ import annotations

import numpy as np

from ..evidence.alignment import align
from ..evidence.field import Field
from .growth import CAREFUL, ORBIT_POSE, PROMINENT, SAME_POSE, accepted, prominence
from .hypothesis import Hypothesis, explained
from .significance import evident


def with_empty_cells(field: Field, thing: Hypothesis, orbit, others) -> Hypothesis:
    """The thing with the empty cells of its orbit that show it.

    orbit : with `empty_poses()`; others : things (list) whose samples are explained already
    """
    poses = orbit.empty_poses()
    if not len(poses):
        return thing
    # What stands beside the orbit may stand in the way of its cells: it is asked again after them.
    base, beside = thing.at(np.flatnonzero(orbit.fits)), thing.poses[~orbit.fits]
    owned = explained(field, base)
    for other in others:
        if other is not thing:
            owned |= explained(field, other)
    moved = align(field, poses, thing.probe, radii=(4.0, 2.5, 2.0))
    gap = np.linalg.norm(thing.embedded(moved) - thing.embedded(poses), axis=1)
    moved = moved[gap < SAME_POSE]
    moved = moved[prominence(field, thing, moved, owned) >= PROMINENT]
    full = accepted(field, base, moved, np.full(len(moved), ORBIT_POSE), owned)
    if len(full) == len(base):
        return thing
    full = accepted(field, full, beside, np.full(len(beside), CAREFUL[0]), owned | explained(field, full))
    return evident(field, full)
