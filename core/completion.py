# SPDX-License-Identifier: GPL-3.0-or-later
"""The completed network and what became of each input curve (sections 5.1 and 5.2)."""

from __future__ import annotations

import numpy as np

from .courses import Course
from .drafts import Draft, along, placed
from .geometry.polylines import directions
from .network.network import CurveNetwork
from .single import single_curves
from .values import CompletedCurve, Completion, InputClasses, Template, Transformation


def build_completion(
    network: CurveNetwork, model, drafts: list[Draft], courses: list[Course], input_count, parameters, seconds, *,
    tick=None,
) -> Completion:
    """Templates and strong curves in world space, and the class of every input curve."""
    templates, component = [], 0
    used = sorted({d.transformation for d in drafts})
    place = {k: i for i, k in enumerate(used)}
    for k, draft in enumerate(drafts):
        templates.append(_template(network, draft, k, place[draft.transformation], component))
        component += len(draft.curves)
    share, label, owner, in_course, explained = classify(network, drafts, courses, radius=1.25 * parameters.epsilon)
    recurs, alone = share >= 0.5, in_course >= 0.5
    single = single_curves(network, ~explained, parameters, tick=tick)
    for curve in single:
        alone[curve.members] = True
    kind = np.where(recurs, "template", np.where(alone, "strong", "noise"))
    inputs = InputClasses(
        np.full(input_count, "noise", dtype="<U8"), np.full(input_count, -1), np.full(input_count, -1)
    )
    inputs.kind[network.source] = kind
    transformation = np.array([place[d.transformation] for d in drafts] + [-1], np.int64)[owner]
    inputs.transformation[network.source] = np.where(recurs, transformation, -1)
    inputs.component[network.source] = np.where(recurs, label, -1)
    strong = tuple(CompletedCurve(network.to_world(c.points), c.closed, -1, c.support) for c in courses)
    strong += tuple(CompletedCurve(network.to_world(c.points), c.closed, -1, c.support) for c in single)
    transformations = tuple(_transformation(network, model, k, i, drafts) for k, i in place.items())
    return Completion(network.unit, transformations, tuple(templates), strong, inputs, seconds, {})


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
    share that lies along courses; and for each sample whether it lies along any of them.

    Returns (m,) float64, (m,) int64 and (m,) int64, -1 where nothing does, (m,) float64, and (n,) bool. Components are
    numbered through all drafts: a curve of a template and the same curve at all its occurrences are one component.
    """
    m = len(network)
    none = np.full(m, -1)
    if not drafts and not courses:
        return np.zeros(m), none, none, np.zeros(m), np.zeros(len(network.points), bool)
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
        return share, none, none, in_course, hit
    best = votes.argmax(axis=1)
    any_ = votes.max(axis=1) > 0
    draft_of = np.repeat(np.arange(len(drafts)), [len(d.curves) for d in drafts])
    return share, np.where(any_, best, -1), np.where(any_, draft_of[best], -1), in_course, hit
