# SPDX-License-Identifier: GPL-3.0-or-later
"""Empty cells: where an orbit has a cell and no pose was found, what the network shows there is asked once more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..evidence.alignment import align
from ..evidence.field import Field
from .growth import CAREFUL, ORBIT_POSE, SAME_POSE, accepted
from .hypothesis import Hypothesis, explained
from .significance import EXPECTED, SELECTED, evidence_for, evident

FREE = 0.5
"""Share of what a cell shows that nothing else may explain."""


def with_empty_cells(field: Field, thing: Hypothesis, orbit, taken) -> Hypothesis:
    """The thing with the empty cells of its orbit that show it.

    orbit : with `empty_poses()`; taken : (n,) bool, samples that other things explain

    Notes
    -----
    The cells are asked with all that is about the thing, as evidence for its poses is. Those that are sure come first:
    they sharpen what is asked of the others.
    """
    poses = orbit.empty_poses()
    if not len(poses):
        return thing
    # What stands beside the orbit may stand in the way of its cells: it is asked again after them.
    base, beside = thing.at(np.flatnonzero(orbit.fits)), thing.poses[~orbit.fits]
    full = base
    for least in (SELECTED, EXPECTED):
        moved = align(field, poses, full.probe, radii=(4.0, 2.5, 2.0))
        near = field.targets(moved, full.probe)
        free = (near >= 0) & ~(taken | explained(field, full))[near]
        fits = np.linalg.norm(full.embedded(moved) - full.embedded(poses), axis=1) < SAME_POSE
        fits &= free.sum(axis=1) > FREE * (near >= 0).sum(axis=1)
        moved, asked = moved[fits], np.flatnonzero(fits)
        if not len(moved):
            continue
        worth = evidence_for(field, full, moved).of_each()
        good = worth > least
        full = replace(
            full, poses=np.concatenate([full.poses, moved[good]]), scores=np.append(full.scores, worth[good]),
            cost=np.append(full.cost, np.full(good.sum(), ORBIT_POSE)),
        )  # fmt: skip
        poses = np.delete(poses, asked[good], axis=0)
    if len(full) == len(base):
        return thing
    owned = taken | explained(field, full)
    return evident(field, accepted(field, full, beside, np.full(len(beside), CAREFUL[0]), owned))


def with_empty_cells_of_all(field: Field, things, tick=lambda: None):
    """Things (list), each with the empty cells of its orbit that show it and that no other thing explains."""
    out = []
    for thing in things:
        taken = np.zeros(len(field), bool)
        for other in things:
            if other is not thing:
                taken |= explained(field, other)
        out.append(with_empty_cells(field, thing, thing.orbit, taken))
        tick()
    return out
