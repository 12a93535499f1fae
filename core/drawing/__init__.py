# SPDX-License-Identifier: GPL-3.0-or-later
"""From things and the poses at which they are seen to clean curves (section 5.2).

`draw` is the entry. `overlay` lays what surrounds the poses over each other, `consensus` makes candidate curves where
the poses agree, `evidence` scores them by log odds, `choosing` decides which belong to the thing and at which poses,
`sliding` leaves out what runs on through all poses, `fitting` fits poses and curves to the samples, `thing` puts these
together.
"""

from __future__ import annotations

import numpy as np

from ..drafts import Draft, along, explained_samples, seen_share
from ..geometry.motions import apply
from ..network.network import CurveNetwork
from .thing import Drawer, Drawing


def draw(network: CurveNetwork, things, parameters, *, orbits=None, tick=None) -> list[Draft]:
    """Clean curves of things.

    Parameters
    ----------
    things : objects with `points` (m, 3) and `tangents` (m, 3), a part of the thing in a frame of its own, and `poses`
        (k, 4, 4), rigid, frame to network, det +1 or -1, all in edge lengths; the surest first
    parameters : Parameters
    orbits : the Orbit of each thing (list), or None: its poses then stand each for itself
    tick : called now and then; may raise Cancelled, which is passed on

    Returns
    -------
    list of Draft, in the order of the things. A draft is what is seen at the same poses: a thing whose curves are at
    different sets of its poses gives a draft for each. `transformation` is the index of the thing.
    """
    radius = 1.25 * parameters.epsilon
    cores = [_core(network, thing, radius) for thing in things]
    free = np.ones(len(network.points), bool)
    out = []
    for k, thing in enumerate(things):
        if len(thing.poses) < 2 or not len(thing.points):
            continue
        mine = free.copy()
        for later in cores[k + 1 :]:
            # All things claim their cores before any is drawn.
            mine &= ~later | cores[k]
        predicted = None if orbits is None or orbits[k].kind == "single" else orbits[k].fits
        drawing = Drawer(network, mine, parameters, tick).draw(
            np.asarray(thing.points), np.asarray(thing.poses), predicted
        )
        if drawing is None:
            continue
        for draft in _drafts(network, drawing, k, mine, radius):
            out.append(draft)
            free &= ~explained_samples(network, draft, radius=radius)
    return out


def _core(network, thing, radius):
    """(n,) bool, samples that show what is known of a thing at its poses."""
    poses = np.asarray(thing.poses)
    points = apply(poses, np.asarray(thing.points)).reshape(-1, 3)
    tangents = (np.asarray(thing.tangents) @ np.swapaxes(poses[:, :3, :3], 1, 2)).reshape(-1, 3)
    return along(network, points, tangents, radius)[0]


def _drafts(network, drawing: Drawing, number, free, radius) -> list[Draft]:
    """A draft for each set of poses, the largest first."""
    chosen = drawing.chosen
    sets, which = np.unique(chosen.sets, axis=0, return_inverse=True)
    out = []
    for k, mine in enumerate(sets):
        use = np.flatnonzero(which.ravel() == k)
        curves, closed = [chosen.curves[i] for i in use], [chosen.closed[i] for i in use]
        poses = drawing.poses[mine]
        evidence = seen_share(network, curves, poses, radius=radius, free=free)
        keys = drawing.kept[mine][:, None]
        out.append(Draft(curves, closed, poses, keys, evidence, number, np.zeros(len(poses), bool)))
    return sorted(out, key=lambda d: -d.lengths.sum() * len(d.poses))
