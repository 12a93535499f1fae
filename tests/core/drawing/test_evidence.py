# SPDX-License-Identifier: GPL-3.0-or-later
"""The log odds against plain loops, and the stretches that they cut out."""

from __future__ import annotations

import numpy as np
import pytest

from core.drawing.evidence import APART, kept_stretches, log_odds, point_scores, seen_by, sightings
from core.drawing.overlay import Overlay, agreement


def naive_scores(seen, p, q):
    """Nats of each point: a loop over poses and points, the first sighting of a point counted by half."""
    apart = min(APART, len(seen[0]))
    out = []
    for j in range(len(seen[0])):
        hits = sum(1 for row in seen if row[j])
        evidence = (hits - 0.5 * (hits > 0)) * np.log(p / q) + (len(seen) - hits) * np.log((1 - p) / (1 - q))
        out.append(evidence / apart)
    return out


@pytest.mark.parametrize(("cells", "points"), [(1, 1), (2, 7), (5, 40), (9, 3)])
def test_scores_are_those_of_the_loop(rng, cells, points):
    seen = rng.random((cells, points)) < 0.6
    assert np.allclose(point_scores(seen, 0.7, 0.1), naive_scores(seen, 0.7, 0.1))


def test_one_sighting_is_no_evidence():
    seen = np.zeros((3, 20), bool)
    seen[0] = True
    assert point_scores(seen, 0.7, 0.1).sum() < 0


def test_a_short_curve_is_one_observation_in_each_pose():
    assert log_odds(np.ones((4, 6), bool), 0.7, 0.1).sum() == pytest.approx(4 * np.log(7))
    assert log_odds(np.ones((4, 24), bool), 0.7, 0.1).sum() == pytest.approx(8 * np.log(7))


def naive_cut(score, least):
    """Points left when the worst stretch is cut out as long as one has less than -least."""
    spans = [(0, len(score))]
    keep = [True] * len(score)
    while spans:
        a, b = spans.pop()
        worst = min(((sum(score[i:j]), i, j) for i in range(a, b) for j in range(i + 1, b + 1)), default=None)
        if worst is None or worst[0] >= -least:
            continue
        _, i, j = worst
        for k in range(i, j):
            keep[k] = False
        spans += [(a, i), (j, b)]
    return [k for k in range(len(score)) if keep[k]]


def test_cut_stretches_are_those_of_the_loop(rng):
    for _ in range(30):
        score = np.round(rng.normal(size=24), 3)
        parts = kept_stretches(score, False, 2.0, 1)
        assert sorted(np.concatenate([*parts, []]).astype(int).tolist()) == naive_cut(score.tolist(), 2.0)
        assert all((np.diff(part) == 1).all() for part in parts)


def test_a_ring_stays_whole_or_is_opened_once():
    score = np.ones(30)
    assert [part.tolist() for part in kept_stretches(score, True, 3.0, 8)] == [list(range(30))]
    score[[28, 29, 0, 1]] = -2
    (part,) = kept_stretches(score, True, 3.0, 1)
    assert part.tolist() == list(range(2, 28))


def test_a_short_gap_stays_inside_but_is_cut_at_an_end():
    score = np.ones(40)
    score[20:24] = -2
    assert len(kept_stretches(score, False, 3.0, 8)[0]) == 40
    score[36:] = -2
    (part,) = kept_stretches(score, False, 3.0, 8)
    assert part.tolist() == list(range(36))


def overlay_of(rng, cells, count):
    """Samples of three poses along one line, in runs of 10, with gaps."""
    x = np.arange(count, dtype=float)
    points = np.concatenate([np.c_[x, 0 * x, 0 * x] + 0.4 * rng.normal(size=(count, 3)) for _ in range(cells)])
    cell = np.repeat(np.arange(cells), count)
    keep = rng.random(len(points)) < 0.8
    run = (np.tile(np.arange(count) // 10, cells) + 100 * cell)[keep]
    tangents = np.tile([1.0, 0, 0], (keep.sum(), 1))
    index = np.arange(keep.sum())
    return Overlay(points[keep], tangents, np.ones(keep.sum()), cell[keep], index, run, cells)


def test_sightings_are_those_of_the_loop(rng):
    overlay = overlay_of(rng, 3, 30)
    curves = [np.c_[np.arange(12.0), np.full(12, 0.3), np.zeros(12)], np.c_[np.zeros(9), np.arange(9.0), np.zeros(9)]]
    found = sightings(curves, overlay, radius=2.5)
    ways = [np.tile([1.0, 0, 0], (12, 1)), np.tile([0, 1.0, 0], (9, 1))]
    line, way = np.concatenate(curves), np.concatenate(ways)
    expected = {
        (j, i)
        for j in range(len(line))
        for i in range(len(overlay.points))
        if np.linalg.norm(line[j] - overlay.points[i]) <= 2.5 and abs(way[j] @ overlay.tangents[i]) > 0.75
    }
    assert set(zip(found.point.tolist(), found.item.tolist())) == expected
    seen = seen_by(found, overlay)
    assert all(seen[overlay.cell[i], j] for j, i in expected)
    assert seen.sum() == len({(overlay.cell[i], j) for j, i in expected})


def test_agreement_counts_the_other_poses_that_show_a_run(rng):
    overlay = overlay_of(rng, 4, 30)
    count, mean = agreement(overlay, radius=2.5, stretch=1)
    for i in range(len(count)):
        near = np.linalg.norm(overlay.points - overlay.points[i], axis=1) < 2.5
        assert count[i] == len(set(overlay.cell[near].tolist()) - {overlay.cell[i]})
    off = np.linalg.norm(overlay.points[:, 1:], axis=1), np.linalg.norm(mean[:, 1:], axis=1)
    assert off[1].mean() < 0.7 * off[0].mean()
