# SPDX-License-Identifier: GPL-3.0-or-later
"""What recurs in some cells of an orbit only has a power of the orbit's generator as its own."""

from __future__ import annotations

import numpy as np
import pytest

from core.sublattices import coarser, recurring_length, steps_of, sublattice
from core.support import Screen
from tests import naive
from tests.core import shapes

SHORTEST = 25.0


def powers(step, ks):
    return [np.linalg.matrix_power(step, k) for k in ks]


def scene(rng, step, every, some, *, out=(0, 0, 0), clutter=0, more=(), noise=0.1):
    """A thing in all cells and another one in some of them; True where a sample is not of the first thing."""
    first, second = (shapes.ornament(rng, 4) for _ in range(2))
    aside = naive.rigid(shift=[0, 0, 26])
    curves = [naive.moved(m, c + out) for m in powers(step, every) for c in first]
    known = len(curves)
    curves += [naive.moved(m @ aside, c + out) for m in powers(step, some) for c in second]
    low, high = np.concatenate(curves).min(axis=0), np.concatenate(curves).max(axis=0)
    curves += [shapes.wiggle(rng, 45, bend=0.3) + rng.uniform(low, high) for _ in range(clutter)]
    net = shapes.network([c + noise * rng.normal(size=c.shape) for c in [*curves, *more]], smoothing=1.0)
    return net, net.source[net.curve_of] >= known


def naive_recurring(net, motion, free, screen):
    """Length of the free samples that go to free samples along stretches and do not slip."""
    hit, to = naive.recurs(net.points, net.tangents, motion, net.points, net.tangents, radius=screen.radius)
    moves = [np.linalg.norm(naive.moved(motion, [p])[0] - p) > screen.still for p in net.points]
    long = naive.long_stretches(hit & moves & free & free[to], net.curve_of, [screen.least] * len(hit))
    return net.weights[np.array(long) & ~np.array(naive.slips(motion, net.points, net.tangents, 0.95))].sum()


@pytest.mark.parametrize("seed", range(2))
def test_the_length_that_recurs_is_that_of_the_loop(seed):
    rng = np.random.default_rng(seed)
    step = naive.rigid(shift=[40, 5, 0])
    net, _ = scene(rng, step, range(2), (0,), clutter=1, more=[shapes.line(70, [-15, 10, 30], [40, 5, 0])])
    screen = Screen(net, radius=2.0)
    motions = [shapes.in_frame(net, m) for m in (step, naive.rigid(shift=[11, 3, 2]))]
    for free in (np.ones(len(net.points), bool), np.arange(len(net.points)) % 90 < 60):
        got = recurring_length(screen, np.array(motions), free)
        expected = [naive_recurring(net, m, free, screen) for m in motions]
        assert np.allclose(got, expected, atol=0.06 * net.weights.sum()), "exact to half a voxel"
        assert got[0] > 3 * got[1]
    assert (recurring_length(screen, np.array(motions), ~np.ones(len(net.points), bool)) == 0).all()
    assert recurring_length(screen, np.zeros((0, 4, 4)), free).shape == (0,)


def test_both_ends_must_be_free(rng):
    step = naive.rigid(shift=[40, 5, 0])
    net, _ = scene(rng, step, (0, 1), ())
    screen, there = Screen(net, radius=2.0), shapes.in_frame(net, step)[None]
    mine = net.source[net.curve_of] < 4
    whole = recurring_length(screen, there, np.ones(len(net.points), bool))[0]
    assert whole > 0.7 * net.weights[mine].sum()
    assert recurring_length(screen, there, mine)[0] < 0.05 * whole
    assert recurring_length(screen, there, ~mine)[0] < 0.05 * whole


@pytest.mark.parametrize("stride", [2, 3])
@pytest.mark.parametrize("seed", range(2))
def test_a_thing_in_every_other_cell_of_a_row(seed, stride):
    rng = np.random.default_rng(seed)
    step = naive.rigid(shift=[34, 5, 0])
    net, free = scene(rng, step, range(7), range(0, 7, stride), clutter=4)
    orbit = shapes.orbit(net, "translation", [step], [6])
    kept = orbit.twists.copy(), free.copy()
    finer = sublattice(orbit, Screen(net, radius=2.0), free, shortest=SHORTEST)
    assert finer.kind == "translation" and not finer.closed
    assert np.allclose(finer.twists, stride * orbit.twists) and finer.count.tolist() == [6 // stride]
    assert finer.support > SHORTEST
    assert np.array_equal(orbit.twists, kept[0]) and np.array_equal(free, kept[1])


@pytest.mark.parametrize("fold, some", [(6, (0, 3)), (6, (0, 2, 4)), (6, (1, 3, 5)), (8, (1, 5)), (8, (0, 2, 4, 6))])
def test_a_thing_on_some_sides_of_a_closed_rotation(rng, fold, some):
    step = naive.about([0.1, 0.2, 1], 2 * np.pi / fold, [3, 4, 5])
    net, free = scene(rng, step, range(fold), some, out=[60, 0, 0], clutter=3)
    orbit = shapes.orbit(net, "rotation", [step], [fold - 1], closed=True)
    finer = sublattice(orbit, Screen(net, radius=2.0), free, shortest=SHORTEST)
    assert finer.kind == "rotation" and finer.closed
    assert finer.count.tolist() == [len(some) - 1]
    assert np.allclose(finer.twists, fold // len(some) * orbit.twists)
    assert np.allclose(np.linalg.matrix_power(finer.generators[0], len(some)), np.eye(4), atol=1e-6)


def test_a_thing_on_every_other_step_of_a_screw(rng):
    step = naive.about([0, 0, 1], np.radians(28), [0, -70, 0], along=14)
    net, free = scene(rng, step, range(9), range(0, 9, 2))
    orbit = shapes.orbit(net, "screw", [step], [8])
    finer = sublattice(orbit, Screen(net, radius=2.0), free, shortest=SHORTEST)
    assert finer.kind == "screw" and finer.count.tolist() == [4] and np.allclose(finer.twists, 2 * orbit.twists)


CELLS = [(i, j) for i in range(5) for j in range(4)]


@pytest.mark.parametrize(
    "some, index",
    [([c for c in CELLS if c[0] % 2 == 0], 2), ([c for c in CELLS if sum(c) % 2 == 0], 2), (CELLS[::8], None)],
    ids=["columns", "chequers", "one row"],
)
def test_a_thing_in_some_cells_of_a_grid(rng, some, index):
    first, second = np.array([34.0, 0, 0]), np.array([6, 33.0, 0])
    thing = shapes.ornament(rng, 4)
    curves = [c + i * first + j * second + 0.1 * rng.normal(size=c.shape) for i, j in some for c in thing]
    net = shapes.network(curves, smoothing=1.0)
    orbit = shapes.orbit(net, "grid", [naive.rigid(shift=first), naive.rigid(shift=second)], [4, 3])
    finer = sublattice(orbit, Screen(net, radius=2.0), np.ones(len(net.points), bool), shortest=SHORTEST)
    if index is None:
        # what stands in one row only recurs along it
        assert finer.kind == "translation" and finer.count.tolist() == [2]
        assert np.allclose(finer.twists, 2 * orbit.twists[:1])
        return
    assert finer.kind == "grid"
    whole = finer.twists[:, 3:] @ np.linalg.pinv(orbit.twists[:, 3:])
    assert np.allclose(whole, np.round(whole)) and abs(round(np.linalg.det(whole))) == index
    # its powers lead from cells that show the thing to others that do
    places = {tuple(np.subtract(c, some[0])) for c in some}
    reach = {tuple(k) for a in range(-6, 7) for b in range(-6, 7) for k in [np.round(a * whole[0] + b * whole[1])]}
    assert places <= reach


def test_what_recurs_at_every_step_has_no_finer_orbit(rng):
    step = naive.rigid(shift=[34, 5, 0])
    net, _ = scene(rng, step, range(6), ())
    orbit = shapes.orbit(net, "translation", [step], [5])
    every = np.ones(len(net.points), bool)
    assert sublattice(orbit, Screen(net, radius=2.0), every, shortest=SHORTEST) is None


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["translation", "rotation"])
def test_clutter_has_no_orbit(seed, kind):
    rng = np.random.default_rng(seed)
    closed = kind == "rotation"
    step = naive.about([0, 0, 1], np.pi / 3, [0, 0, 0]) if closed else naive.rigid(shift=[34, 5, 0])
    net, free = scene(rng, step, range(6), (), out=[55, 0, 0] if closed else [0, 0, 0], clutter=14)
    orbit = shapes.orbit(net, kind, [step], [5], closed=closed)
    assert sublattice(orbit, Screen(net, radius=2.0), free, shortest=SHORTEST) is None


def test_too_little_and_nothing_free(rng):
    step = naive.rigid(shift=[34, 5, 0])
    net, free = scene(rng, step, range(7), range(0, 7, 2))
    orbit, screen = shapes.orbit(net, "translation", [step], [6]), Screen(net, radius=2.0)
    finer = sublattice(orbit, screen, free, shortest=SHORTEST)
    assert sublattice(orbit, screen, free, shortest=finer.support) is not None
    assert sublattice(orbit, screen, free, shortest=finer.support + 0.1) is None
    assert sublattice(orbit, screen, np.zeros(len(free), bool), shortest=SHORTEST) is None
    once = free & (net.source[net.curve_of] < 32)  # the first of four
    assert once.any() and sublattice(orbit, screen, once, shortest=SHORTEST) is None


@pytest.mark.parametrize("noise", [0.0, 0.3])
@pytest.mark.parametrize("fold, stride", [(6, 3), (6, 2), (8, 4), (12, 6), (6, 1)])
def test_regions_know_their_steps(rng, fold, stride, noise):
    step = naive.about([0.1, 0.2, 1], 2 * np.pi / fold, [3, 4, 5])
    clutter = 0 if noise == 0 else 6
    net, other = scene(rng, step, range(fold), range(0, fold, stride), out=[60, 0, 0], noise=noise, clutter=clutter)
    # Each curve has a hole somewhere, and one in eight is not there at all.
    curves = [net.to_world(net.curve(i)) for i in np.argsort(net.source)]
    holes = rng.integers(8, 30, size=len(curves))
    parts = [part for k, (c, h) in enumerate(zip(curves, holes)) if k % 8 != 5 for part in (c[:h], c[h + 6 :])]
    net = shapes.network(parts, smoothing=1.0)
    thing = np.repeat([k // 4 >= fold for k in range(len(curves)) if k % 8 != 5], 2)[net.source]
    sure = np.repeat([k < 4 * (fold + fold // stride) for k in range(len(curves)) if k % 8 != 5], 2)[net.source]
    orbit = shapes.orbit(net, "rotation", [step], [fold - 1], closed=True)
    steps = steps_of(orbit, Screen(net, radius=2.0))
    expected = np.where(thing, stride, 1)[net.curve_of]
    right = (steps == expected)[sure[net.curve_of]]
    assert right.mean() > 0.9
    assert np.array_equal(steps, steps_of(orbit, Screen(net, radius=2.0)))


def test_what_slips_belongs_to_the_whole(rng):
    step = naive.about([0, 0, 1], np.pi / 3, [0, 0, 0])
    ring = shapes.circle(50, [0, 0, 26])
    net, _ = scene(rng, step, range(6), (0, 3), out=[60, 0, 0], more=[ring])
    orbit = shapes.orbit(net, "rotation", [step], [5], closed=True)
    steps = steps_of(orbit, Screen(net, radius=2.0))
    assert (steps[net.source[net.curve_of] == net.source.max()] == 1).mean() > 0.95


def test_only_closed_rotations_are_asked(rng):
    step = naive.rigid(shift=[34, 5, 0])
    net, _ = scene(rng, step, range(7), range(0, 7, 2))
    assert (steps_of(shapes.orbit(net, "translation", [step], [6]), Screen(net, radius=2.0)) == 1).all()
    arc = naive.about([0, 0, 1], np.pi / 6, [0, 0, 0])
    net, _ = scene(rng, arc, range(5), (0, 2), out=[60, 0, 0])
    assert (steps_of(shapes.orbit(net, "rotation", [arc], [4]), Screen(net, radius=2.0)) == 1).all()


def test_the_coarser_orbit_closes_too(rng):
    step = naive.about([0, 0, 1], np.pi / 6, [0, 0, 0])
    net, _ = scene(rng, step, range(12), ())
    orbit = shapes.orbit(net, "rotation", [step], [11], closed=True)
    third = coarser(orbit, 4, 7.0)
    assert third.closed and third.count.tolist() == [2] and third.support == 7.0
    assert np.allclose(third.generators, np.linalg.matrix_power(orbit.generators[0], 4))
