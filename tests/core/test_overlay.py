# SPDX-License-Identifier: GPL-3.0-or-later
"""Occurrences are brought into one cell, cut where little is cut, and agree where they show the same."""

from __future__ import annotations

import numpy as np
import pytest

from core.orbits import Orbit
from core.overlay import agreement, best_cut, cell_coordinates, chance_shifts, fold_orbit
from tests import naive
from tests.core import shapes

STEP = np.array([45.0, 4, 0])


def row(rng, count=4, *, noise=0.1, curves=4):
    """A row of things and its orbit in the network's frame."""
    thing = [c + [0, 0, 0] for c in shapes.ornament(rng, curves)]
    placed = [c + k * STEP + noise * rng.normal(size=c.shape) for k in range(count) for c in thing]
    net = shapes.network(placed, smoothing=1.0)
    u = shapes.in_frame(net, naive.rigid(shift=STEP))[:3, 3]
    return net, Orbit("translation", np.r_[0, 0, 0, u][None], np.array([count - 1]), False, 1.0)


def folded(net, orbit):
    samples = np.arange(len(net.points))
    return fold_orbit(net, orbit, samples, net.weights)


def test_a_row_is_folded_into_one_cell(rng):
    net, orbit = row(rng)
    overlay = folded(net, orbit)
    assert len(overlay.poses) == 4
    assert np.array_equal(np.sort(overlay.sample[overlay.inner]), np.arange(len(net.points))), "each sample once"
    for p, cell, sample in zip(overlay.points, overlay.cell, overlay.sample):
        assert np.allclose(naive.moved(overlay.poses[cell], [p])[0], net.points[sample])
    # each thing is whole in its cell
    cells = {int(c): set() for c in range(4)}
    for cell, sample in zip(overlay.cell[overlay.inner], overlay.sample[overlay.inner]):
        cells[int(cell)].add(int(net.source[net.curve_of[sample]]) // 4)
    assert sorted(map(tuple, cells.values())) == [(0,), (1,), (2,), (3,)]
    steps = np.diff(overlay.keys[:, 0])
    assert (steps == 1).all()
    assert np.array_equal(np.sort(np.unique(overlay.run)), np.unique(overlay.run))


@pytest.mark.parametrize("kind", ["grid", "rotation", "screw"])
def test_cell_coordinates_are_the_powers(rng, kind):
    twists = {
        "grid": np.array([[0, 0, 0, 30.0, 5, 0], [0, 0, 0, 8, 25, 3]]),
        "rotation": np.array([[0, 0, 2 * np.pi / 9, 0, 0, 0]]),
        "screw": np.array([[0, 0, 0.5, 0, 0, 12.0]]),
    }[kind]
    closed = kind == "rotation"
    orbit = Orbit(kind, twists, np.array([8] * len(twists)), closed, 1.0)
    thing = np.array([30.0, 4, 2]) + rng.normal(size=(40, 3))
    powers = orbit.powers[:, :] if kind == "grid" else np.arange(5)[:, None]
    points = np.concatenate([naive.moved(m, thing) for m in orbit.power(powers)])
    u, reach = cell_coordinates(orbit, points, 5.0)
    assert u.shape == reach.shape == (len(points), len(twists)) and (reach <= 0.3).all() and (reach > 0).all()
    u = u.reshape(len(powers), len(thing), -1)
    base = u - powers[:, None, :]
    turns = np.round((base - base[:1]) / 9) * 9 if closed else 0
    assert np.allclose(base - turns, base[:1], atol=1e-6), "one step along the orbit is one more in its coordinate"


def test_the_cut_goes_where_least_is_cut():
    # curves that cover 0.0 to 0.7 of every cell, and one that runs on over the border
    t = np.linspace(0, 0.7, 141)
    u = np.concatenate([t + k for k in range(4)] + [np.linspace(0, 4, 801)])[:, None]
    follows = np.ones(len(u) - 1, bool)
    follows[[140, 281, 422, 563]] = False
    (cut,) = best_cut(u, np.ones(len(u)), follows)
    assert 0.72 <= cut % 1 <= 0.98
    # a curve along the border is not cut by it, though it is there
    beside = np.full((400, 1), 0.85)
    u = np.concatenate([u[:564], beside])
    follows = np.concatenate([follows[:563], [False], np.ones(399, bool)])
    (cut,) = best_cut(u, np.ones(len(u)), follows)
    assert 0.7 <= cut % 1 <= 1.0


def test_of_two_gaps_the_one_that_leaves_whole_cells():
    # two things a step, and as many of the one as of the other
    for first in (0.1, 0.6):
        parts = [np.linspace(first + k / 2, first + k / 2 + 0.3, 61) for k in range(8)]
        u = np.concatenate(parts)[:, None]
        follows = np.ones(len(u) - 1, bool)
        follows[60::61] = False
        (cut,) = best_cut(u, np.ones(len(u)), follows)
        assert (first - cut) % 1 < 0.25, "just before the first thing"


def naive_agreement(overlay, radius, cosine, stretch):
    """Other cells that show a sample within the radius along a stretch, one sample and one cell at a time."""
    n, cells = len(overlay.points), len(overlay.poses)
    hit = np.zeros((cells, n), bool)
    for b in range(cells):
        other = np.flatnonzero(overlay.cell == b)
        for i in np.flatnonzero(overlay.cell != b):
            gaps = np.linalg.norm(overlay.points[other] - overlay.points[i], axis=1)
            # of the two nearest one must run the same way
            for j in other[np.argsort(gaps, kind="stable")[:2]]:
                near = np.linalg.norm(overlay.points[j] - overlay.points[i]) < radius
                if near and abs(np.dot(overlay.tangents[i], overlay.tangents[j])) > cosine:
                    hit[b, i] = True
    least = [stretch] * n
    return sum(np.array(naive.long_stretches(row, overlay.run, least), int) for row in hit)


def test_agreement_is_that_of_the_loop(rng):
    net, orbit = row(rng, 3)
    overlay = folded(net, orbit)
    kept = overlay.points.copy()
    count, mean = agreement(overlay, radius=2.0, cosine=0.8, stretch=8)
    expected = naive_agreement(overlay, 2.0, 0.8, 8)
    assert np.array_equal(count, expected) and np.array_equal(kept, overlay.points)
    assert np.median(count[overlay.inner]) == 2
    # the mean lies between the occurrences
    alone = count == 0
    assert np.allclose(mean[alone], overlay.points[alone])
    assert np.linalg.norm(mean - overlay.points, axis=1).max() < 2.0


def test_the_mean_of_occurrences_is_nearer_to_the_truth(rng):
    clean = np.random.default_rng(7)
    thing = shapes.ornament(clean, 3)
    placed = [c + k * STEP + 0.5 * rng.normal(size=c.shape) for k in range(6) for c in thing]
    net = shapes.network(placed, smoothing=1.0)
    u = shapes.in_frame(net, naive.rigid(shift=STEP))[:3, 3]
    overlay = folded(net, Orbit("translation", np.r_[0, 0, 0, u][None], np.array([5]), False, 1.0))
    count, mean = agreement(overlay, radius=2.5)
    # the first cell is where the truth lies, whichever cell that is
    first = overlay.keys[overlay.cell[np.flatnonzero(net.source[net.curve_of[overlay.sample]] < 3)[0]], 0]
    back = net.rotation.T
    truth = [(c + first * 0 - net.centre) @ back.T for c in thing]
    own = np.flatnonzero((count >= 3) & (overlay.keys[overlay.cell, 0] == first) & overlay.inner)
    shift = net.points[overlay.sample[own[0]]] - overlay.points[own[0]]

    def away(points):
        return np.mean([min(naive.distance_to_polyline(p + shift, c) for c in truth) for p in points[own]])

    assert away(mean) < 0.75 * away(overlay.points)


def test_chance_agrees_less_than_truth(rng):
    net, orbit = row(rng, 5)
    overlay = folded(net, orbit)
    shifts = chance_shifts(overlay)
    size = np.linalg.norm(shifts, axis=1)
    assert shifts.shape == (5, 3) and size.min() >= 7 and size.max() <= 13
    assert np.array_equal(shifts, chance_shifts(overlay))
    wrong, _ = agreement(overlay, radius=2.5, shifts=shifts)
    count, _ = agreement(overlay, radius=2.5)
    assert wrong.mean() < 0.3 * count.mean()


def test_one_cell_alone_agrees_with_nothing(rng):
    net, orbit = row(rng, 1)
    overlay = folded(net, orbit)
    count, mean = agreement(overlay, radius=2.5)
    assert (count[overlay.inner] == 0).all()
