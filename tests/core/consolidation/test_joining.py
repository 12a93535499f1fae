# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces that continue each other are joined, others are not."""

from __future__ import annotations

import numpy as np
import pytest

from core.consolidation.joining import join_paths, linked_paths, split_at_corners
from tests import naive
from tests.core import shapes


def pieces(curve, cuts, gap):
    """Pieces of a curve between cuts, `gap` samples lost at each."""
    out, start = [], 0
    for c in [*cuts, len(curve) + gap]:
        out.append(curve[start : c - gap])
        start = c
    return out


@pytest.mark.parametrize("seed", range(5))
def test_pieces_of_one_curve_become_one(seed):
    rng = np.random.default_rng(seed)
    curve = shapes.circle(40)[:150] if seed % 2 else shapes.line(150, way=rng.normal(size=3))
    parts = pieces(curve, [40, 70, 110], gap=4)
    order = rng.permutation(len(parts))
    parts = [parts[i][::-1] if rng.random() < 0.5 else parts[i] for i in order]
    kept = [p.copy() for p in parts]
    ((line, closed),) = join_paths(parts)
    assert not closed and len(line) == sum(map(len, parts))
    assert all(np.array_equal(p, q) for p, q in zip(parts, kept))
    line = line if np.allclose(line[0], curve[0]) else line[::-1]
    assert np.allclose(line[[0, -1]], curve[[0, -1]])
    assert naive.length(line) == pytest.approx(naive.length(curve), rel=0.01)


@pytest.mark.parametrize("gap, joined", [(5.5, True), (6.5, False)])
def test_the_gap_is_bounded(gap, joined):
    one, two = shapes.line(30), shapes.line(30, [29 + gap, 0, 0])
    assert (len(join_paths([one, two], gap=6.0)) == 1) == joined


@pytest.mark.parametrize("angle, joined", [(0, True), (25, True), (45, False), (90, False), (180, False)])
def test_the_angle_is_bounded(angle, joined):
    a = np.radians(angle)
    one = shapes.line(30, way=[-1, 0, 0])
    two = shapes.line(30, [3 * np.cos(a / 2), 3 * np.sin(a / 2), 0], [np.cos(a), np.sin(a), 0])
    assert (len(join_paths([one, two], angle=35.0)) == 1) == joined


def test_parallel_neighbours_stay_apart():
    one, two = shapes.line(30), shapes.line(30, [31, 4, 0])
    assert len(join_paths([one, two])) == 2, "their gap leads across"
    assert len(join_paths([one, one + [0, 3, 0]])) == 2, "their ends point the same way"


def test_the_smoother_of_two_goes_on_and_an_end_is_joined_once():
    bar, other = shapes.line(30), shapes.line(30, [32, 0, 0])
    branch = shapes.line(30, [31.5, 1.0, 0], [np.cos(0.4), np.sin(0.4), 0])
    lines = [line for line, _ in join_paths([branch, bar, other])]
    assert sorted(map(len, lines)) == [30, 60]
    whole = max(lines, key=len)
    assert np.abs(whole[:, 1]).max() < 1e-9


def test_a_path_closes_when_its_own_ends_fit():
    ring = shapes.circle(15)
    ((line, closed),) = join_paths([ring[3:]])
    assert closed and len(line) == len(ring) - 3
    ((line, closed),) = join_paths([ring[:40], ring[43:92]]) if len(ring) > 92 else join_paths([ring[:40], ring[43:-2]])
    assert closed
    ((line, closed),) = join_paths([ring[: len(ring) // 2]])
    assert not closed
    # a short hook does not close over a gap as long as itself
    ((line, closed),) = join_paths([shapes.circle(1.2, n=8)[:6]])
    assert not closed


def test_of_nothing_comes_nothing():
    assert join_paths([]) == [] and linked_paths([]) == []
    ((line, closed),) = join_paths([shapes.line(2)])
    assert len(line) == 2 and not closed


def test_chains_are_the_components_of_their_joints(rng):
    """Which pieces came together, against relabelling, on rows of pieces on parallel lines."""
    parts, edges, home = [], [], []
    for row in range(6):
        x = 0.0
        for k in range(int(rng.integers(1, 6))):
            gap = float(rng.choice([2.0, 4.0, 12.0]))
            if k and gap < 6:
                edges.append((len(parts) - 1, len(parts)))
            x += gap if k else 0.0
            parts.append(shapes.line(20, [x, 10 * row, 0]))
            home.append(row)
            x += 19
    order = rng.permutation(len(parts))
    joined = join_paths([parts[i] if rng.random() < 0.5 else parts[i][::-1] for i in order])
    got = set()
    for line, closed in joined:
        assert not closed
        got.add(frozenset(i for i, p in enumerate(parts) if (np.abs(line - p[10]).max(axis=1) < 1e-9).any()))
    assert got == naive.components(len(parts), edges)


def test_what_the_input_tells_of_ends_comes_before_how_they_look():
    """At a right angle curves pass; straight on none does, though many come to both ends."""
    a, b, c = shapes.line(20), shapes.line(20, [21, 1, 0], [0, 1, 0]), shapes.line(20, [22, 0, 0])
    passed, parted = np.zeros((6, 6), int), np.zeros((6, 6), bool)
    assert sorted(m for _, _, m in linked_paths([a, b, c])) == [[0, 2], [1]]
    passed[1, 2] = passed[2, 1] = 2
    assert sorted(sorted(m) for _, _, m in linked_paths([a, b, c], passed=passed)) == [[0, 1], [2]]
    passed[1, 2] = passed[2, 1] = 1
    assert sorted(m for _, _, m in linked_paths([a, b, c], passed=passed)) == [[0, 2], [1]], "one may be noise"
    parted[1, 4] = parted[4, 1] = True
    assert sorted(m for _, _, m in linked_paths([a, b, c], parted=parted)) == [[0], [1], [2]]
    forced = np.array([[1, 2]])
    assert sorted(sorted(m) for _, _, m in linked_paths([a, b, c], forced=forced)) == [[0, 1], [2]]


@pytest.mark.parametrize("angle, parts", [(0, 1), (40, 1), (75, 2), (90, 2), (120, 2)])
def test_lines_are_cut_at_corners(angle, parts):
    a = np.radians(angle)
    line = np.concatenate([shapes.line(20, way=[-1, 0, 0])[::-1], shapes.line(20, way=[np.cos(a), np.sin(a), 0])[1:]])
    got = split_at_corners(line)
    assert len(got) == parts
    assert np.allclose(np.concatenate([got[0], *[p[1:] for p in got[1:]]]), line)
    if parts == 2:
        assert len(got[0]) == 20


def test_smooth_curves_are_not_cut():
    assert len(split_at_corners(shapes.circle(8))) == 1
    assert len(split_at_corners(shapes.line(3))) == 1
    square = np.concatenate(
        [shapes.line(15), shapes.line(15, [14, 1, 0], [0, 1, 0]), shapes.line(15, [13, 15, 0], [-1, 0, 0])]
    )
    assert len(split_at_corners(square)) == 3
