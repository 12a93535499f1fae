# SPDX-License-Identifier: GPL-3.0-or-later
"""What a motion explains, sample by sample."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.support import NeighbourField, Screen, in_long_stretches, long_stretches, slips
from tests import naive
from tests.core import shapes


@pytest.mark.parametrize("flat", [False, True])
def test_the_field_gives_the_nearest_sample_to_half_a_voxel(rng, flat):
    points = rng.uniform(-20, 20, size=(150, 3)) * ([1, 1, 0] if flat else 1)
    field = NeighbourField(points, 3.0)
    places = np.concatenate([points[:40] + rng.normal(size=(40, 3)), rng.uniform(-30, 30, size=(300, 3))])
    # Coordinates are cut off at the voxel, so that only places within the field's box may be asked.
    at = np.floor((places - field.low) / field.voxel).astype(np.int32)
    near = field.look_up(*at.T)
    slack = np.sqrt(3) * field.voxel
    for place, got in zip(places, near):
        _, truth = naive.nearest(points, place)
        if got >= 0:
            assert np.linalg.norm(points[got] - place) <= truth + slack
        else:
            assert truth > 3.0 - slack
        if truth <= 3.0 - slack:
            assert got >= 0
    assert (near >= 0).sum() > 40 and (near < 0).sum() > 40


def test_the_field_holds_its_memory_and_has_nothing_outside(rng):
    points = rng.uniform(-100, 100, size=(50, 3))
    field = NeighbourField(points, 2.0, most=1 << 12)
    assert field.table.size <= 1 << 12
    out = np.array([[-1, 0, 0], [0, -5, 0], [10**5, 0, 0], [0, 0, 10**6]], np.int32)
    assert (field.look_up(*out.T) == -1).all()


@settings(max_examples=80, deadline=None)
@given(st.data())
def test_long_stretches_are_those_of_the_loop(data):
    n = data.draw(st.integers(1, 40))
    rows = data.draw(st.integers(1, 3))
    hit = np.array([data.draw(st.lists(st.booleans(), min_size=n, max_size=n)) for _ in range(rows)])
    hit |= np.array(data.draw(st.lists(st.booleans(), min_size=n, max_size=n)))
    breaks = data.draw(st.lists(st.booleans(), min_size=n, max_size=n))
    run_of = np.cumsum(breaks)
    least = np.array(data.draw(st.lists(st.integers(1, 8), min_size=n, max_size=n)))
    got = long_stretches(hit, run_of, least)
    for row, out in zip(hit, got):
        assert out.tolist() == naive.long_stretches(row, run_of, least)
    row, sample = np.nonzero(hit)
    assert np.array_equal(in_long_stretches(row, sample, run_of, least), got[row, sample])
    assert np.array_equal(in_long_stretches(row, sample, run_of, 3), long_stretches(hit, run_of, 3)[row, sample])
    one = long_stretches(hit, run_of, 3)
    assert one[0].tolist() == naive.long_stretches(hit[0], run_of, [3] * n)


def test_the_stretch_is_inclusive():
    hit = np.array([[1, 1, 1, 0, 1, 1, 1, 1]], bool)
    run = np.array([0, 0, 0, 0, 0, 0, 0, 1])
    assert long_stretches(hit, run, 3).tolist() == [[True] * 3 + [False] + [True] * 3 + [False]]
    assert not long_stretches(hit, run, 4).any()


def test_curves_along_the_motion_slip():
    line = shapes.network([shapes.line(30)])
    ring = shapes.network([shapes.circle(12)], closed=[True])
    a = np.linspace(0, 4 * np.pi, 120)
    helix = np.c_[8 * np.cos(a), 8 * np.sin(a), 1.5 * a]
    points = {"line": (line.points, line.tangents), "ring": (ring.points, ring.tangents)}
    points["helix"] = helix, np.gradient(helix, axis=0) / np.linalg.norm(np.gradient(helix, axis=0), axis=1)[:, None]
    way = line.tangents[0]
    axis = np.cross(ring.points[0], ring.points[5])
    across = np.cross(way, [0.3, 0.5, 0.8])
    z, zero = [0, 0, 1], [0, 0, 0]
    # each time first a motion along the curve, then others
    cases = {
        "line": [naive.rigid(shift=13 * way), naive.rigid(shift=13 * across), naive.about(axis, 1, [5, 5, 5])],
        "ring": [naive.about(axis, 0.7, zero), naive.rigid(shift=9 * axis), naive.about(axis, 0.7, 3 * ring.points[0])],
        "helix": [naive.about(z, 1.2, zero, along=1.8), naive.about(z, 1.2, zero, along=-9), naive.rigid(shift=z)],
    }
    for name, motions in cases.items():
        p, lines = points[name]
        row = np.repeat(np.arange(3), len(p))
        flags = slips(np.array(motions), row, np.tile(p, (3, 1)), np.tile(lines, (3, 1))).reshape(3, -1)
        assert flags[0].mean() > 0.95, name
        assert flags[1:].mean() < 0.3, name
        for m, row in zip(motions, flags):
            assert (row == naive.slips(m, p, lines, 0.95)).mean() > 0.98


def scene(rng):
    """Two things alike and a long straight line."""
    there = naive.rigid(naive.turn([0, 1, 0], 0.3), [50, 0, 5])
    thing = shapes.ornament(rng, 4)
    curves = thing + [naive.moved(there, c) for c in thing] + [shapes.line(90, [-20, -20, 0])]
    net = shapes.network(curves)
    return net, shapes.in_frame(net, there)


def naive_score(net, m, screen):
    """Length of the samples that go to within the radius of a sample with the same tangent, along stretches."""
    hit = []
    for p, line in zip(net.points, net.tangents):
        q = naive.moved(m, [p])[0]
        k, gap = naive.nearest(net.points, q)
        same = abs(np.dot(m[:3, :3] @ line, net.tangents[k])) > screen.cosine
        hit.append(gap <= screen.radius and same and np.linalg.norm(q - p) > screen.still)
    long = naive.long_stretches(hit, net.curve_of, [screen.least] * len(hit))
    return net.weights[np.array(long) & ~np.array(naive.slips(m, net.points, net.tangents, 0.95))].sum()


def test_the_score_is_that_of_the_loop(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    motions = [truth, np.linalg.inv(truth)]
    motions += [naive.rigid(shift=rng.normal(size=3) * 8) for _ in range(4)]
    got = screen.score(np.array(motions))
    expected = np.array([naive_score(net, m, screen) for m in motions])
    # the table is exact to half a voxel: what lies at the radius may go either way
    assert np.allclose(got, expected, atol=0.08 * net.weights.sum())
    assert np.allclose(got[:2], expected[:2], rtol=0.1) and got[0] > 0.25 * net.weights.sum()
    assert got[2:].max() < 0.5 * got[0]


def test_the_score_does_not_depend_on_chunks_and_threads(rng):
    net, truth = scene(rng)
    motions = np.array([truth @ naive.rigid(shift=rng.normal(size=3)) for _ in range(30)])
    first = Screen(net, radius=2.0).score(motions)
    for threads in (1, 3):
        for chunk in (1, 7):
            assert np.array_equal(Screen(net, radius=2.0, threads=threads).score(motions, chunk=chunk), first)
    assert Screen(net, radius=2.0).score(np.zeros((0, 4, 4))).shape == (0,)


def test_what_hardly_moves_does_not_recur(rng):
    net, _ = scene(rng)
    screen = Screen(net, radius=2.0, still=4.0)
    nudges = np.array([np.eye(4), naive.rigid(shift=[0.5, 0, 0]), naive.rigid(shift=[0, 1.5, 0])])
    assert (screen.score(nudges) == 0).all()
    near, hit = Screen(net, radius=2.0, still=1.0).nearest(nudges)
    assert not hit[:2].any() and hit[2].mean() > 0.5
    gaps = np.linalg.norm(net.points[near[2]] - net.points - [0, 1.5, 0], axis=1)
    assert gaps[hit[2]].max() < 2.0 + np.sqrt(3)


def test_refinement_leads_to_the_motion(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    nudges = [naive.about(rng.normal(size=3), np.radians(1.5), [0, 0, 0], along=0.5) for _ in range(5)]
    before = truth @ np.array(nudges)
    kept = before.copy()
    after = screen.refine(before, 5)
    assert np.array_equal(before, kept)
    there = naive.moved(truth, net.points)
    recurs = np.array([naive.nearest(net.points, p)[1] < 0.6 for p in there])
    for pair in zip(before, after):
        error = [np.linalg.norm(naive.moved(m, net.points) - there, axis=1)[recurs].mean() for m in pair]
        assert error[1] < 0.6 and error[1] < error[0]


def test_what_is_known_beside_it_does_not_count_again(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    alone = screen.score(truth[None])
    assert screen.score(truth[None], beside=truth[None])[0] == 0
    other = shapes.random_motion(rng)[None]
    assert 0.6 * alone[0] < screen.score(truth[None], beside=other)[0] <= alone[0]


def test_true_motions_stand_out_and_slips_do_not(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    line = net.tangents[net.curve_of == 0].mean(axis=0)
    along = naive.rigid(shift=20 * line)
    prominence = screen.prominence(np.array([truth, along]))
    assert prominence[0] > 0.6 * screen.score(truth[None])[0]
    assert prominence[1] <= 0.1 * prominence[0]


# ---- other sources, weights and what holds a motion


def pattern(points, tangents, run):
    """Samples that are moved onto a network without being one."""
    return SimpleNamespace(
        points=points, tangents=tangents, weights=np.ones(len(points)), curve_of=run, normals=None, kind=None
    )


def test_samples_of_another_source_are_moved_onto_the_network(rng):
    net, truth = scene(rng)
    thing = np.isin(net.source[net.curve_of], range(4))
    back = shapes.random_motion(rng)
    own = pattern(naive.moved(back, net.points[thing]), net.tangents[thing] @ back[:3, :3].T, net.curve_of[thing])
    screen = Screen(net, own, radius=2.0, still=None)
    there = np.linalg.inv(back)
    motions = np.array([there, truth @ there, shapes.random_motion(rng)])
    got = screen.score(motions)
    assert got[:2].min() > 0.8 * thing.sum() and got[2] < 0.2 * thing.sum()
    for m in motions[:2]:
        _, sample, target = screen.hits(m[None])
        away = np.linalg.norm(naive.moved(m, own.points[sample]) - net.points[target], axis=1)
        assert len(sample) > 0.8 * thing.sum() and away.max() < 2.0 + np.sqrt(3)
    near, hit = screen.nearest(motions)
    assert near.shape == hit.shape == (3, thing.sum())


def test_samples_may_stay_where_they_are_if_it_is_said_so(rng):
    net, _ = scene(rng)
    stays, n = np.eye(4)[None], len(net.points)
    row, sample, target = Screen(net, radius=2.0, still=None).hits(stays)
    # where curves cross, the sample of another one may be taken for the nearest
    assert len(sample) > 0.97 * n and (sample == target).mean() > 0.6
    assert Screen(net, radius=2.0, still=None).supported(stays).mean() > 0.95
    assert len(Screen(net, radius=2.0, still=4.0).hits(stays)[1]) == 0


def test_what_is_supported_by_any_motion_is_that_of_the_loop(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    line = net.tangents[net.curve_of == 0].mean(axis=0)
    motions = np.array([truth, np.linalg.inv(truth), naive.rigid(shift=20 * line)])
    expected = np.zeros(len(net.points), bool)
    for m in motions:
        hit, _ = naive.recurs(net.points, net.tangents, m, net.points, net.tangents, radius=2.0)
        moves = [np.linalg.norm(naive.moved(m, [p])[0] - p) > 4 for p in net.points]
        expected |= naive.long_stretches(hit & moves, net.curve_of, [screen.least] * len(hit))
    got = screen.supported(motions)
    assert (got == expected).mean() > 0.95, "exact to half a voxel"
    one_by_one = [screen.supported(m[None]) for m in motions]
    assert np.array_equal(got, np.any(one_by_one, axis=0))
    assert one_by_one[2][net.curve_of == 0].mean() > 0.6, "what slips is explained as well"
    assert not screen.supported(motions[:0]).any() and screen.supported(motions[:0]).shape == (len(net.points),)


@pytest.mark.parametrize("count, supported", [(8, False), (14, True)])
def test_short_stretches_support_nothing(count, supported):
    net = shapes.network([shapes.line(60), shapes.line(count, [25, 30, 0]), shapes.line(9, [0, 0, 40], [0, 1, 0])])
    up = shapes.in_frame(net, naive.rigid(shift=[0, 30, 0]))
    screen = Screen(net, radius=1.0, stretch=12.0)
    # of the long line those below the short one and, by the radius, one or two more at either end
    assert count <= len(screen.hits(up[None])[1]) <= count + 3
    assert screen.supported(up[None]).any() == supported


def test_samples_count_by_the_weight_that_is_given(rng):
    net, truth = scene(rng)
    screen, n = Screen(net, radius=2.0), len(net.points)
    motions = np.array([truth, np.linalg.inv(truth), shapes.random_motion(rng)])
    whole = screen.score(motions)
    assert np.allclose(screen.score(motions, weight=screen.weight), whole)
    assert (screen.score(motions, weight=np.zeros(n)) == 0).all()
    first = np.where(rng.random(n) < 0.5, screen.weight, 0)
    parts = screen.score(motions, weight=first), screen.score(motions, weight=screen.weight - first)
    assert np.allclose(sum(parts), whole) and (parts[0][:2] > 0).all() and (parts[1][:2] > 0).all()
    one = np.zeros(n)
    i, k, _ = screen.hits(truth[None])
    one[k[len(k) // 2]] = 7.0
    assert screen.score(motions[:1], weight=one)[0] in (0, 7.0)
    assert np.array_equal(screen.score(motions), whole), "the network's own weights stay"


def test_what_holds_a_motion_is_that_of_the_loop(rng):
    net, truth = scene(rng)
    screen = Screen(net, radius=2.0)
    line = net.tangents[net.curve_of == 0].mean(axis=0)
    motions = np.array([truth, naive.rigid(shift=20 * line), shapes.random_motion(rng)])
    got = screen.held(motions)
    for m, held in zip(motions, got):
        i, k, j = screen.hits(m[None])
        flags = np.zeros(len(net.points), bool)
        flags[k] = True
        long = naive.long_stretches(flags, net.curve_of, [screen.least] * len(flags))
        total = np.zeros((3, 3))
        for sample, target in zip(k, j):
            if long[sample]:
                way = net.tangents[target]
                total += net.weights[sample] * (np.eye(3) - np.outer(way, way))
        assert held == pytest.approx(np.linalg.eigvalsh(total)[0], abs=1e-4)
    assert got[0] > 20 and got[1] < 0.05 * got[0], "a slip along a straight line is held by nothing"
    assert screen.held(motions[:0]).shape == (0,)
