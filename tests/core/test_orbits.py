# SPDX-License-Identifier: GPL-3.0-or-later
"""Planted orbits of every kind are found with their true step, also with cells missing."""

from __future__ import annotations

import numpy as np
import pytest

from core.clustering import Clusters, chance_support
from core.orbits import Orbit, detect_orbits
from core.support import Screen
from tests import naive
from tests.core import shapes


def scene(rng, motions, *, noise=0.1, curves=4, size=12):
    """A thing at the given places, and a curve of its own."""
    thing = shapes.ornament(rng, curves, size=size)
    out = [naive.moved(m, c) for m in motions for c in thing]
    centre = np.concatenate(out).mean(axis=0)
    out.append(shapes.wiggle(rng, 60, bend=0.4) + centre + [5, 3, 40])
    return shapes.network([c + noise * rng.normal(size=c.shape) for c in out], smoothing=1.0)


def found_in(net, *motions):
    """The orbits when the clusters hold the given motions of the world, refined on the network."""
    screen = Screen(net, radius=2.0)
    frame = screen.refine(np.array([shapes.in_frame(net, m) for m in motions]), 4)
    support = screen.score(frame)
    order = np.argsort(-support, kind="stable")
    frame, support = frame[order], support[order]
    return detect_orbits(net, Clusters(frame, support, chance_support(screen, frame)), screen)


def powers(m, ks):
    return [np.linalg.matrix_power(m, k) for k in ks]


def same(net, got, m, *, at_most=1.0):
    """Whether a generator of the frame is a motion of the world or its inverse, in RMS edge lengths."""
    truth = shapes.in_frame(net, m)
    ways = truth, np.linalg.inv(truth)
    away = [np.linalg.norm(naive.moved(got, net.points) - naive.moved(w, net.points), axis=1) for w in ways]
    return min(np.sqrt((a**2).mean()) for a in away) < at_most


STEPS = {
    "translation": (naive.rigid(shift=[40, 6, 0]), range(6)),
    "rotation": (naive.about([0, 0, 1], np.radians(22), [0, -90, 0]), range(7)),
    "screw": (naive.about([0, 0, 1], np.radians(28), [0, -70, 0], along=14), range(9)),
}


@pytest.mark.parametrize("kind", STEPS)
@pytest.mark.parametrize("seen", [(1,), (2, 1, 3), (2,), (3, 2)], ids=str)
def test_a_row_has_the_true_step_though_a_multiple_is_handed_in(rng, kind, seen):
    step, cells = STEPS[kind]
    net = scene(rng, powers(step, cells))
    lead, *rest = found_in(net, *powers(step, seen))
    assert lead.kind == kind and not lead.closed and len(lead.twists) == 1
    assert same(net, lead.generators[0], step)
    assert lead.count[0] == len(cells) - 1
    assert not rest, "the multiples are part of it"


@pytest.mark.parametrize("kind", STEPS)
@pytest.mark.parametrize("missing", [(3,), (2, 7)], ids=str)
def test_missing_cells_do_not_hide_the_step(rng, kind, missing):
    step, _ = STEPS[kind]
    step = naive.about([0, 0, 1], np.radians(16), [0, -120, 0]) if kind == "rotation" else step
    net = scene(rng, powers(step, [k for k in range(10) if k not in missing]))
    lead = found_in(net, *powers(step, [2, 1]))[0]
    assert lead.kind == kind and same(net, lead.generators[0], step)
    assert not lead.closed and lead.count[0] == 9


@pytest.mark.parametrize("fold", [5, 6, 8, 12])
@pytest.mark.parametrize("seen", [1, 2])
def test_a_rotation_closes(rng, fold, seen):
    step = naive.about([0.1, 0.2, 1], 2 * np.pi / fold, [3, 4, 5])
    cells = powers(step, range(fold))
    net = scene(rng, [m @ naive.rigid(shift=[12 + 5 * fold, 0, 0]) for m in cells])
    lead = found_in(net, *powers(step, [seen]))[0]
    assert lead.kind == "rotation" and lead.closed and lead.count[0] == fold - 1
    assert same(net, lead.generators[0], step)
    assert np.allclose(np.linalg.matrix_power(lead.generators[0], fold), np.eye(4), atol=1e-6)
    assert lead.powers[:, 0].tolist() == list(range(1, fold))


def test_a_rotation_with_a_gap_still_closes_and_an_arc_does_not(rng):
    step = naive.about([0, 0, 1], np.radians(36), [0, 0, 0])
    out = naive.rigid(shift=[60, 0, 0])
    ring = scene(rng, [m @ out for m in powers(step, [0, 1, 2, 3, 5, 6, 7, 8, 9])])
    lead = found_in(ring, step)[0]
    assert (lead.kind, lead.closed, lead.count[0]) == ("rotation", True, 9)
    step = naive.about([0, 0, 1], np.radians(24), [0, 0, 0])
    arc = scene(rng, [m @ out for m in powers(step, range(6))])
    lead = found_in(arc, step)[0]
    assert (lead.kind, lead.closed, lead.count[0]) == ("rotation", False, 5)


@pytest.mark.parametrize("seed", [0, 5])
def test_a_ring_of_broken_roundels_closes_though_they_turn_in_their_places(seed):
    rng = np.random.default_rng(seed)
    arcs = []
    for angle in 2 * np.pi * np.arange(8) / 8:
        for radius in (8.0, 4.5):
            c = shapes.circle(radius, (50 * np.cos(angle), 50 * np.sin(angle), 0))
            c = np.roll(c, rng.integers(len(c)), axis=0)[: int(0.4 * len(c))]
            arcs.append(c + 0.8 * rng.normal(size=c.shape) * [1, 1, 0.3])
    net = shapes.network(arcs, smoothing=1.0)
    off = [naive.about([0, 0, 1], np.radians(angle), [0.8, -0.5, 0]) for angle in (43.1, 86.4, 129.5)]
    lead = found_in(net, *off)[0]
    assert (lead.kind, lead.closed, lead.count[0]) == ("rotation", True, 7)


def test_an_arc_beyond_half_a_turn_counts_every_motion_once(rng):
    step = naive.about([0, 0, 1], np.radians(38), [0, 0, 0])
    net = scene(rng, [m @ naive.rigid(shift=[60, 0, 0]) for m in powers(step, range(7))])
    lead = found_in(net, step)[0]
    assert (lead.kind, lead.closed, lead.count[0]) == ("rotation", False, 6)
    upto_half = Screen(net, radius=2.0).score(lead.power(np.arange(1, 5)[:, None]))
    assert lead.support == pytest.approx(2 * upto_half.sum())


@pytest.mark.parametrize("second", [(0, 50, 0), (20, 45, 0), (-14, 38, 12)], ids=str)
@pytest.mark.parametrize("missing", [(), ((1, 1),), ((0, 2), (3, 1))], ids=str)
def test_a_grid_has_both_steps(rng, second, missing):
    first, second = np.array([42.0, 0, 0]), np.array(second, float)
    cells = [(i, j) for i in range(5) for j in range(3) if (i, j) not in missing]
    net = scene(rng, [naive.rigid(shift=i * first + j * second) for i, j in cells])
    seen = [naive.rigid(shift=v) for v in (first, second, first + second, 2 * first)]
    lead = found_in(net, *seen)[0]
    assert lead.kind == "grid" and lead.twists.shape == (2, 6)
    # any basis of the lattice will do
    basis = np.array([shapes.in_frame(net, naive.rigid(shift=v))[:3, 3] for v in (first, second)])
    whole = lead.twists[:, 3:] @ np.linalg.pinv(basis)
    assert np.abs(whole - np.round(whole)).max() < 0.03
    assert abs(np.linalg.det(np.round(whole))) == 1
    assert sorted(lead.count) == [2, 4]


@pytest.mark.parametrize("seen", [((2, 0), (0, 1)), ((1, 0), (1, 2)), ((1, 1), (2, 1))], ids=str)
def test_a_grid_of_multiples_falls_back_to_the_steps(rng, seen):
    first, second = np.array([42.0, 0, 0]), np.array([0, 47.0, 0])
    net = scene(rng, [naive.rigid(shift=i * first + j * second) for i in range(5) for j in range(4)])
    lead = found_in(net, *[naive.rigid(shift=i * first + j * second) for i, j in seen])[0]
    basis = np.array([shapes.in_frame(net, naive.rigid(shift=v))[:3, 3] for v in (first, second)])
    whole = lead.twists[:, 3:] @ np.linalg.pinv(basis)
    assert lead.kind == "grid" and np.abs(whole - np.round(whole)).max() < 0.03
    assert abs(np.linalg.det(np.round(whole))) == 1


def test_a_single_motion_stays_single(rng):
    m = naive.about([0.3, 1, 0.2], 1.9, [50, 0, 0], along=20)
    net = scene(rng, [np.eye(4), m])
    (lead,) = found_in(net, m)
    assert lead.kind == "single" and lead.count[0] == 1 and same(net, lead.generators[0], m)


def test_two_rows_of_different_things_are_two_orbits(rng):
    one, two = naive.rigid(shift=[40, 0, 0]), naive.rigid(shift=[0, 0, 57])
    first, second = shapes.ornament(rng, 4), shapes.ornament(rng, 4)
    curves = [naive.moved(m, c) for m in powers(one, range(5)) for c in first]
    curves += [naive.moved(m, c) + [-80, 60, 0] for m in powers(two, range(4)) for c in second]
    net = shapes.network(curves)
    orbits = found_in(net, one, two, *powers(one, [2]), *powers(two, [2]))
    assert [o.kind for o in orbits] == ["translation"] * 2
    assert same(net, orbits[0].generators[0], one) and same(net, orbits[1].generators[0], two)
    assert orbits[0].support >= orbits[1].support


def test_a_motion_must_explain_something_new(rng):
    """A row of pairs: what leads from the one to the other of a pair explains nothing that the row does not.

    Where such a pair stands beside the row as well, it does.
    """
    step, twin = naive.rigid(shift=[60, 5, 0]), naive.rigid(naive.turn([0, 0, 1], 1.2), [4, 45, 3])
    pairs = [m @ k for m in powers(step, range(5)) for k in (np.eye(4), twin)]
    aside = naive.rigid(shift=[30, -170, 60])
    net = scene(rng, pairs)
    lead, *rest = found_in(net, step, twin, *powers(step, [2]))
    assert lead.kind == "translation" and same(net, lead.generators[0], step) and not rest
    other = shapes.ornament(rng, 4)
    curves = [net.to_world(net.curve(k)) for k in range(len(net))]
    curves += [naive.moved(m @ aside, c) for m in (np.eye(4), twin) for c in other]
    net = shapes.network(curves)
    lead, *rest = found_in(net, step, twin, *powers(step, [2]))
    assert lead.kind == "translation" and same(net, lead.generators[0], step)
    assert [o.kind for o in rest] == ["single"] and same(net, rest[0].generators[0], twin)


def test_nothing_comes_of_nothing(rng):
    net = scene(rng, [np.eye(4)])
    screen = Screen(net, radius=2.0)
    assert detect_orbits(net, Clusters(np.zeros((0, 4, 4)), np.zeros(0), 0.0), screen) == []
    random = np.array([shapes.random_motion(rng) for _ in range(20)])
    chance = chance_support(screen, random)
    assert detect_orbits(net, Clusters(random, screen.score(random), chance), screen) == []


def test_powers_of_an_orbit():
    grid = Orbit("grid", np.array([[0, 0, 0, 2.0, 0, 0], [0, 0, 0, 1.0, 3, 0]]), np.array([2, 1]), False, 1.0)
    assert len(grid.powers) == 5 * 3 - 1 and not (grid.powers == 0).all(axis=1).any()
    for k, m in zip(grid.powers, grid.power(grid.powers)):
        assert np.allclose(m, naive.rigid(shift=k[0] * np.array([2.0, 0, 0]) + k[1] * np.array([1.0, 3, 0])))
    turn = Orbit("rotation", np.array([[0, 0, np.pi / 3, 0, 0, 0]]), np.array([5]), True, 1.0)
    for k, m in zip(turn.powers[:, 0], turn.power(turn.powers)):
        assert np.allclose(m[:3, :3], naive.turn([0, 0, 1], k * np.pi / 3))


@pytest.mark.parametrize("seed", range(4))
def test_what_chances_to_recur_both_ways_makes_no_grid(seed):
    """A row of seven, and things of which each is there twice: one step up and some steps along the row, or none."""
    rng = np.random.default_rng(seed)
    step, up = np.array([42.0, 0, 0]), np.array([0, 55.0, 0])
    thing = shapes.ornament(rng, 4)
    curves = [c + i * step for i in range(7) for c in thing]
    for j in (0, 0, 0, 1, -1, 0, 2, -2, 1):
        for c in shapes.ornament(rng, 2):
            at = c + [rng.uniform(0, 200), 10, 40.0]
            curves += [at, at + up + j * step]
    net = shapes.network(curves)
    orbits = found_in(net, *[naive.rigid(shift=v) for v in (step, 2 * step, *(up + j * step for j in range(-2, 3)))])
    assert orbits[0].kind == "translation" and same(net, orbits[0].generators[0], naive.rigid(shift=step))
    assert {o.kind for o in orbits[1:]} == {"single"}
