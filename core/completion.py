# SPDX-License-Identifier: GPL-3.0-or-later
"""The completed network and what became of each input curve (sections 5.1 and 5.2)."""

from __future__ import annotations

import numpy as np

from .drafts import Draft, along, placed
from .geometry.motions import embed, inverse
from .network.network import CurveNetwork
from .single import single_curves
from .values import CompletedCurve, Completion, InputClasses, Template, Transformation


def build_completion(
    network: CurveNetwork, model, orbits, drafts: list[Draft], input_count, parameters, *, tick=None
) -> Completion:
    """Templates and strong curves in world space, and the class of every input curve.

    orbits : list of Orbit, the description of each thing of the model; drafts of things with the same generators belong
        to one transformation
    """
    templates, component = [], 0
    same = _same_transformation(network, orbits)
    used = sorted({same[d.transformation] for d in drafts})
    place = {k: used.index(same[k]) for k in range(len(orbits)) if same[k] in used}
    for k, draft in enumerate(drafts):
        templates.append(_template(network, draft, k, place[draft.transformation], component))
        component += len(draft.curves)
    share, label, owner, explained = classify(network, drafts, radius=1.25 * parameters.epsilon)
    recurs, alone = share >= 0.5, np.zeros(len(network), bool)
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
    strong = tuple(CompletedCurve(network.to_world(c.points), c.closed, -1, c.support) for c in single)
    members = {k: [m for m in range(len(orbits)) if same[m] == k] for k in used}
    transformations = tuple(_transformation(network, model, orbits[k], i, members[k]) for i, k in enumerate(used))
    return Completion(network.unit, transformations, tuple(templates), strong, inputs, {}, {})


SAME_GENERATORS = 3.0
"""RMS edge lengths on the whole network within which two generators are one (tolerance)."""


def _same_transformation(network, orbits):
    """For each orbit the first one with the same generators: windows and sills of one grid are one transformation."""
    spread = np.sqrt((network.weights @ network.points**2) / network.weights.sum())
    vectors = [embed(orbit.generators, spread) for orbit in orbits]
    back = [embed(inverse(orbit.generators), spread) for orbit in orbits]
    same = []
    for k, orbit in enumerate(orbits):
        alike = (
            j for j in range(k)
            if orbit.kind != "single" and orbits[j].kind == orbit.kind and orbits[j].closed == orbit.closed
            and all(
                min(np.linalg.norm(v - w, axis=1).min() for w in (vectors[j], back[j])) < SAME_GENERATORS
                for v in vectors[k]
            )
        )  # fmt: skip
        first = next(alike, k)
        same.append(first if first == k else same[first])
    return same


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


def _transformation(network, model, orbit, number, members):
    """World value of an orbit; `members` are the things of the model that it describes."""
    return Transformation(
        number, orbit.kind, network.motion_to_world(orbit.generators), orbit.extent,
        float(model.log_bayes_factor[members].sum()), float(model.support[members].sum() / network.weights.sum()),
        float(min(model.things[m].expected for m in members)),
    )  # fmt: skip


def classify(network: CurveNetwork, drafts, *, radius):
    """For each curve the share that lies along templates, and the component and draft along which most of it lies; and
    for each sample whether it lies along any.

    Returns (m,) float64, (m,) int64 and (m,) int64, -1 where nothing does, and (n,) bool. Components are numbered
    through all drafts: a curve of a template and the same curve at all its occurrences are one component.
    """
    m = len(network)
    none = np.full(m, -1)
    if not drafts:
        return np.zeros(m), none, none, np.zeros(len(network.points), bool)
    points, tangents, component, first = [], [], [], 0
    for draft in drafts:
        p, t, _, c = placed(draft)
        points.append(p)
        tangents.append(t)
        component.append(c + first)
        first += len(draft.curves)
    component = np.concatenate(component)
    hit, near, _ = along(network, np.concatenate(points), np.concatenate(tangents), radius)
    votes = np.zeros((m, first))
    np.add.at(votes, (network.curve_of[hit], component[near[hit]]), 1.0)
    share = votes.sum(axis=1) / np.diff(network.offsets)
    best, any_ = votes.argmax(axis=1), votes.max(axis=1) > 0
    draft_of = np.repeat(np.arange(len(drafts)), [len(d.curves) for d in drafts])
    return share, np.where(any_, best, -1), np.where(any_, draft_of[best], -1), hit
