# SPDX-License-Identifier: GPL-3.0-or-later
"""The completed network and what became of each input curve (sections 5.1 and 5.2)."""

from __future__ import annotations

import numpy as np

from .consolidation.joining import linked_paths
from .courses import Course
from .drafts import Draft, along, placed
from .geometry.polylines import directions, resample_polyline, steady_polyline
from .matching.strong import keeps_alone
from .network.network import CurveNetwork
from .values import CompletedCurve, Completion, InputClasses, Template, Transformation


def build_completion(
    network: CurveNetwork, model, drafts: list[Draft], courses: list[Course], input_count, parameters, seconds
) -> Completion:
    """Templates and strong curves in world space, and the class of every input curve."""
    templates, component = [], 0
    used = sorted({d.transformation for d in drafts})
    place = {k: i for i, k in enumerate(used)}
    for k, draft in enumerate(drafts):
        templates.append(_template(network, draft, k, place[draft.transformation], component))
        component += len(draft.curves)
    share, label, owner, in_course = classify(network, drafts, courses, radius=1.25 * parameters.epsilon)
    alone = keeps_alone(
        network, l0=parameters.l0, keep_length=parameters.keep_length, keep_curvature=parameters.keep_curvature
    )
    recurs, passing = share >= 0.5, in_course >= 0.5
    single = single_curves(network, ~recurs & ~passing, alone, parameters)
    alone = passing.copy()
    for _, _, members in single:
        alone[members] = True
    kind = np.where(recurs, "template", np.where(alone, "strong", "noise"))
    inputs = InputClasses(
        np.full(input_count, "noise", dtype="<U8"), np.full(input_count, -1), np.full(input_count, -1)
    )
    inputs.kind[network.source] = kind
    transformation = np.array([place[d.transformation] for d in drafts] + [-1], np.int64)[owner]
    inputs.transformation[network.source] = np.where(recurs, transformation, -1)
    inputs.component[network.source] = np.where(recurs, label, -1)
    strong = tuple(CompletedCurve(network.to_world(c.points), c.closed, -1, c.support) for c in courses)
    strong += tuple(
        CompletedCurve(network.to_world(steady_polyline(line, closed)), closed, -1, float(shown))
        for line, closed, shown in (_over_gaps(network, *chain) for chain in single)
    )
    transformations = tuple(_transformation(network, model, k, i, drafts) for k, i in place.items())
    return Completion(network.unit, transformations, tuple(templates), strong, inputs, seconds, {})


def single_curves(network: CurveNetwork, left, alone, parameters):
    """Curves that do not recur and are kept (section 5.1), pieces that continue each other as one.

    left : (m,) bool, curves that nothing explains; alone : (m,) bool, curves that are kept for themselves

    Returns
    -------
    list of (points (k, 3), closed, list of int, the curves it is made of)
    """
    closed = [(network.curve(i), True, [int(i)]) for i in np.flatnonzero(left & alone & network.closed)]
    pieces = np.flatnonzero(left & ~network.closed & (network.lengths >= SHORT * parameters.l0))
    chains = linked_paths(
        [network.curve(i) for i in pieces], gap=parameters.link_gap, angle=LINK_ANGLE, most=LINK_BEND, arm=LINK_ARM
    )
    chains = [(line, ring, pieces[members].tolist()) for line, ring, members in chains]
    short = np.flatnonzero(left & ~network.closed & (network.lengths < SHORT * parameters.l0) & alone)
    chains += [(network.curve(i), False, [int(i)]) for i in short]
    return closed + [
        chain
        for chain in chains
        if alone[chain[2]].any() or network.lengths[chain[2]].sum() > parameters.keep_length * parameters.l0
    ]


SHORT, LINK_ARM, LINK_ANGLE, LINK_BEND = 0.6, 25, 35.0, 1.0
"""Shortest piece, in multiples of l0, that is linked with others, samples of its end that say how it goes on, largest
angle (degrees), and largest distance of the two ends from a common parabola (edge lengths, RMS)."""


def _over_gaps(network, points, closed, members):
    """A chain with samples also in its gaps, and the share of it that was there before."""
    line = resample_polyline(points, 1.0, closed)
    return line, bool(closed), min(1.0, network.lengths[members].sum() / max(len(line) - 1, 1))


def _template(network, draft, number, transformation, component):
    """World value of a draft: template space has the axes of the world at the first occurrence."""
    points = np.concatenate(draft.curves)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    turn = network.rotation @ draft.poses[0, :3, :3]
    occurrences = np.tile(np.eye(4), (len(draft.poses), 1, 1))
    occurrences[:, :3, :3] = network.rotation @ draft.poses[:, :3, :3] @ turn.T
    occurrences[:, :3, 3] = network.to_world(draft.poses[:, :3, :3] @ centre + draft.poses[:, :3, 3])
    curves = tuple(
        CompletedCurve((c - centre) * network.unit @ turn.T, bool(ring), component + i, float(seen))
        for i, (c, ring, seen) in enumerate(zip(draft.curves, draft.closed, draft.evidence.mean(axis=0)))
    )
    return Template(number, transformation, curves, occurrences, draft.evidence)


def _transformation(network, model, k, number, drafts):
    orbit = model.orbits[k]
    seen = [d.keys[d.orbital] for d in drafts if d.transformation == k and d.orbital.any()]
    high = np.ptp(np.concatenate(seen), axis=0) if seen else orbit.count
    extent = np.stack([np.zeros(len(orbit.twists), np.int64), high], axis=1)
    return Transformation(
        number, orbit.kind, network.motion_to_world(orbit.generators), extent,
        float(model.log_bayes_factor[k]), float(model.support[k] / network.weights.sum()),
    )  # fmt: skip


def classify(network: CurveNetwork, drafts, courses=(), *, radius):
    """For each curve: the share that lies along templates, the component and draft along which most lies, and the
    share that lies along courses.

    Returns (m,) float64, (m,) int64 and (m,) int64, -1 where nothing does, and (m,) float64. Components are numbered
    through all drafts: a curve of a template and the same curve at all its occurrences are one component.
    """
    m = len(network)
    none = np.full(m, -1)
    if not drafts and not courses:
        return np.zeros(m), none, none, np.zeros(m)
    points, tangents, component = [], [], []
    first = 0
    for draft in drafts:
        p, t, _, c = placed(draft)
        points.append(p)
        tangents.append(t)
        component.append(c + first)
        first += len(draft.curves)
    for course in courses:
        points.append(course.points)
        tangents.append(directions(course.points))
        component.append(np.full(len(course.points), first))
    component = np.concatenate(component)
    hit, near, _ = along(network, np.concatenate(points), np.concatenate(tangents), radius)
    curve, label = network.curve_of[hit], component[near[hit]]
    votes = np.zeros((m, first + 1))
    np.add.at(votes, (curve, label), 1.0)
    size = np.diff(network.offsets)
    in_course = votes[:, first] / size
    votes = votes[:, :first]
    share = votes.sum(axis=1) / size
    if not first:
        return share, none, none, in_course
    best = votes.argmax(axis=1)
    any_ = votes.max(axis=1) > 0
    draft_of = np.repeat(np.arange(len(drafts)), [len(d.curves) for d in drafts])
    return share, np.where(any_, best, -1), np.where(any_, draft_of[best], -1), in_course
