# SPDX-License-Identifier: GPL-3.0-or-later
"""Leading seeds: the best of each place, looked at more widely.

What is small fits at many wrong places, and a thing often repeats within itself. Which motion carries all that is
around is seen from afar only.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from ..evidence.alignment import align
from ..evidence.field import Field
from ..evidence.lines import lines_once
from .seeding import Places, Seeds, best_of_places, budget, region_scores

LOOKED = 500, 1
"""Seeds that are looked at: in all, and at least at each place; counts that bound the work."""

AROUND, WIDE = 45.0, 70.0
"""Edge lengths about the stretch within which samples align a seed, and within which they score it."""

POINTS = 240
"""Points that stand for such a neighbourhood; count that bounds the work."""


def leading(field: Field, seeds: Seeds, *, tick=lambda: None) -> Seeds:
    """The leading seeds, one direction of each, aligned and scored on their wide neighbourhood, best first."""
    forth, score = seeds.take(np.arange(0, len(seeds), 2)), seeds.score[0::2] + seeds.score[1::2]
    order = np.argsort(-score, kind="stable")
    places = Places(field, ())
    order = order[best_of_places(places, forth.source[order], forth.target[order], budget(LOOKED, len(places)))]
    lead, parts = forth.take(order), []
    for i in range(0, len(lead), 50):
        tick()
        part = lead.take(slice(i, i + 50))
        region = _around(field, part.stretch, WIDE)
        sample, gap = (x[:, : int((region[1] <= AROUND).sum(axis=1).max())] for x in region[:2])
        probe = field.probe(np.maximum(sample, 0))
        probe = replace(probe, points=probe.points + np.where(gap > AROUND, 1e6, 0.0)[..., None])
        motions = align(field, part.motions, probe, radii=(1.75 * field.radius, field.radius))
        parts.append(_scored(field, replace(part, motions=motions), region))
    if not parts:
        return lead
    out = Seeds(*(np.concatenate(x) for x in zip(*(vars(p).values() for p in parts))))
    return out.take(np.argsort(-out.score, kind="stable"))


def scored_widely(field: Field, seeds: Seeds, taken=None) -> Seeds:
    """The seeds with their score on their wide neighbourhood; samples that are taken (n,) bool tell nothing."""
    return _scored(field, seeds, _around(field, seeds.stretch, WIDE), taken)


def _scored(field, seeds, region, taken=None):
    middle, (samples, _, length) = field.points[seeds.source], region
    telling = np.zeros(samples.shape)
    for row, out, one in zip(samples, telling, length):
        there = row >= 0
        out[there] = lines_once(field.points[row[there]], field.tangents[row[there]], np.ones(there.sum(), bool), one)
    score, extent = region_scores(field, seeds.motions, *region, middle, taken=taken, telling=telling)
    return replace(seeds, score=score, extent=extent)


def _around(field, stretch, radius):
    """Samples (k, POINTS) int64 within a radius of stretches (k, s), nearest first and -1 where fewer are, how far
    they are from the stretch (infinite there), and edge lengths of curve that each stands for (k,)."""
    # The ends and the middle of a stretch have all that is around it.
    lists = field.tree.query_ball_point(field.points[stretch[:, :: max(1, stretch.shape[1] // 4)]], radius)
    table, gaps = np.full((len(stretch), POINTS), -1), np.full((len(stretch), POINTS), np.inf)
    length = np.ones(len(stretch))
    for i, row in enumerate(lists):
        found = np.unique(np.concatenate([np.asarray(x, np.int64) for x in row]))
        if len(found) > POINTS:
            length[i] = len(found) / POINTS
            found = found[(np.arange(POINTS) + 0.5).astype(int) * len(found) // POINTS]
        gap = cKDTree(field.points[stretch[i]]).query(field.points[found])[0]
        order = np.argsort(gap, kind="stable")
        table[i, : len(found)], gaps[i, : len(found)] = found[order], gap[order]
    return table, gaps, length
