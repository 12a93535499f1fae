# SPDX-License-Identifier: GPL-3.0-or-later
"""All occurrences together tell a generator, poses and curves better than each alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.polishing import fit_orbit, fit_to_samples, settled
from tests import naive
from tests.core import shapes

RADIUS = 2.5


def scene(rng, places, *, out=(0, 0, 0), noise=0.12):
    """A network of noisy copies of a thing, and its clean curves in the network's frame."""
    thing = [c + np.asarray(out, float) for c in shapes.ornament(rng, 4)]
    curves = [naive.moved(m, c) + noise * rng.normal(size=c.shape) for m in places for c in thing]
    net = shapes.network(curves, smoothing=1.5)
    return net, [shapes.to_frame(net, naive.resample(c, 1.0)) for c in thing]


# kind: steps, counts, whether it is closed, and where the thing is
ORBITS = {
    "translation": ([naive.rigid(shift=[42, 5, 0])], [7], False, [0, 0, 0]),
    "grid": ([naive.rigid(shift=[42, 0, 3]), naive.rigid(shift=[8, 40, 0])], [4, 2], False, [0, 0, 0]),
    "rotation": ([naive.about([0.1, 0.2, 1], 2 * np.pi / 7, [3, 4, 5])], [6], True, [60, 0, 0]),
    "screw": ([naive.about([0, 0, 1], np.radians(28), [0, -70, 0], along=14)], [8], False, [0, 0, 0]),
}


def planted(kind, rng):
    """A network with an orbit, the orbit, the keys of its cells and the clean curves."""
    steps, count, closed, out = ORBITS[kind]
    keys = np.stack(np.meshgrid(*[np.arange(c + 1) for c in count], indexing="ij"), -1).reshape(-1, len(count))
    places = []
    for key in keys:
        m = np.eye(4)
        for step, k in zip(steps, key):
            m = np.linalg.matrix_power(step, k) @ m
        places.append(m)
    net, curves = scene(rng, places, out=out)
    return net, shapes.orbit(net, kind, steps, count, closed=closed), keys, curves


def beside(rng, orbit):
    """The orbit with other generators of its kind, about 0.3 edge lengths a step off."""
    w, u = orbit.twists[:, :3].copy(), orbit.twists[:, 3:].copy()
    way = rng.normal(size=u.shape)
    u += 0.3 * way / np.linalg.norm(way, axis=1)[:, None]
    if orbit.kind in ("rotation", "screw"):
        angle = np.linalg.norm(w)
        w = w + 0.002 * rng.normal(size=w.shape)
        if orbit.kind == "rotation":
            w *= angle / np.linalg.norm(w)
            u -= w * (u @ w[0])[:, None] / angle**2
    return replace(orbit, twists=np.concatenate([w, u], axis=1))


def off_by(net, orbit, truth):
    """RMS edge lengths, over the network, by which a step of an orbit differs from the true one."""
    off = []
    for a, b in zip(orbit.generators, truth.generators):
        gap = naive.moved(a, net.points) - naive.moved(b, net.points)
        off.append(np.sqrt((gap**2).sum(axis=1).mean()))
    return max(off)


@pytest.mark.parametrize("kind", ORBITS)
@pytest.mark.parametrize("seed", range(3))
def test_generators_are_fitted_to_all_cells(kind, seed):
    rng = np.random.default_rng(seed)
    net, truth, keys, curves = planted(kind, rng)
    wrong = beside(rng, truth)
    draft = shapes.draft(curves, wrong.power(keys), keys=keys, closed=[False, True, False, False])
    kept = wrong.twists.copy(), draft.poses.copy(), [c.copy() for c in curves]
    orbit, fitted = fit_orbit(net, wrong, draft, np.arange(len(net.points)), radius=RADIUS)
    assert off_by(net, wrong, truth) > 0.15 and off_by(net, orbit, truth) < 0.02
    assert (orbit.kind, orbit.closed, orbit.support) == (kind, truth.closed, 1.0)
    assert np.array_equal(orbit.count, truth.count)
    w, u = orbit.twists[:, :3], orbit.twists[:, 3:]
    if kind in ("translation", "grid"):
        assert (w == 0).all()
    if kind == "rotation":
        assert np.linalg.norm(w) == pytest.approx(2 * np.pi / 7, abs=1e-12), "it still closes"
        assert abs(w[0] @ u[0]) < 1e-9, "and does not slide along its axis"
    assert np.allclose(fitted.poses, orbit.power(keys)) and np.array_equal(fitted.keys, keys)
    assert fitted.closed == draft.closed
    for a, b in zip(fitted.curves, curves):
        assert len(a) == len(b) and np.linalg.norm(a - b, axis=1).max() < 0.5, "curves move as a whole, and a little"
    assert np.array_equal(wrong.twists, kept[0]) and np.array_equal(draft.poses, kept[1])
    assert all(map(np.array_equal, curves, kept[2]))


def test_cells_that_do_not_show_a_curve_have_no_say(rng):
    """A row of which one thing stands elsewhere: where the evidence says so it does not draw the others over."""
    step = naive.rigid(shift=[42, 5, 0])
    places = [np.linalg.matrix_power(step, k) for k in range(5)]
    net, curves = scene(rng, [*places[:4], places[4] @ naive.rigid(shift=[0, 1.0, 0.5])])
    truth = shapes.orbit(net, "translation", [step], [4])
    off = []
    for last in (0.0, 1.0):
        evidence = np.ones((5, 4))
        evidence[4] = last
        draft = shapes.draft(curves, truth.power(np.arange(5)[:, None]), evidence=evidence)
        off.append(off_by(net, fit_orbit(net, truth, draft, np.arange(len(net.points)), radius=RADIUS)[0], truth))
    assert off[0] < 0.02 and off[1] > 2 * off[0]


def test_an_orbit_that_nothing_shows_stays_as_it_is(rng):
    net, truth, keys, curves = planted("translation", rng)
    every = np.arange(len(net.points))
    draft = shapes.draft(curves, truth.power(keys), keys=keys)
    far = replace(truth, twists=truth.twists + [0, 0, 0, 0, 0, 60])
    cases = {
        "no curves": (truth, shapes.draft([], truth.power(keys), keys=keys), every),
        "no samples": (truth, draft, every[:0]),
        "no evidence": (truth, replace(draft, evidence=0 * draft.evidence), every),
        "nothing there": (far, shapes.draft([c + [0, 0, 60] for c in curves], far.power(keys), keys=keys), every),
    }
    for name, (orbit, one, samples) in cases.items():
        got, after = fit_orbit(net, orbit, one, samples, radius=RADIUS)
        assert np.allclose(got.twists, orbit.twists, atol=1e-12), name
        assert np.allclose(after.poses, one.poses), name
        assert all(map(np.allclose, after.curves, one.curves)), name


def test_one_occurrence_fits_its_own_place(rng):
    net, truth, keys, curves = planted("translation", rng)
    draft = shapes.draft([c + [0.3, 0.4, 0] for c in curves], truth.power([[0]]), keys=[[0]])
    orbit, fitted = fit_orbit(net, truth, draft, np.arange(len(net.points)), radius=RADIUS)
    assert np.allclose(orbit.twists, truth.twists, atol=1e-6), "one cell says nothing of the step"
    assert np.mean([np.linalg.norm(a - b, axis=1).mean() for a, b in zip(fitted.curves, curves)]) < 0.15


def away(draft, curves, places):
    """(a,) mean distance of a draft's curves at each occurrence from the true curves at the true places."""
    out = []
    for pose, place in zip(draft.poses, places):
        truth = [naive.moved(place, c) for c in curves]
        gaps = [naive.distance_to_polyline(p, truth[c]) for c, line in enumerate(draft.curves)
                for p in naive.moved(pose, line)]  # fmt: skip
        out.append(np.mean(gaps))
    return np.array(out)


def scattered(rng, count=4):
    """Things at irregular places, the places and nudged ones in the network's frame."""
    places = [np.eye(4)] + [naive.rigid(naive.turn(rng.normal(size=3), 1 + k), [60 * k, 15 * (-1) ** k, 5])
                            for k in range(1, count)]  # fmt: skip
    net, curves = scene(rng, places)
    true = np.array([shapes.in_frame(net, m) for m in places])
    middle = np.concatenate(curves).mean(axis=0)
    nudges = [naive.about(rng.normal(size=3), np.radians(3), middle, along=0.9) for _ in places]
    return net, curves, true, np.array([m @ n for m, n in zip(true, nudges)])


@pytest.mark.parametrize("seed", range(3))
def test_poses_and_curves_settle_on_what_shows_them(seed):
    rng = np.random.default_rng(seed)
    net, curves, true, off = scattered(rng)
    blurred = [c + 0.3 * rng.normal(size=(1, 3)) for c in curves]
    draft = shapes.draft(blurred, off, orbital=False, evidence=np.full((4, 4), 0.5))
    free = np.ones(len(net.points), bool)
    after = settled(net, draft, free, radius=RADIUS)
    before, now = away(draft, curves, true), away(after, curves, true)
    assert (now < 0.5 * before).all() and now.max() < 0.25
    assert np.allclose(
        after.evidence, naive.seen_share(net.points, net.tangents, after.curves, after.poses, radius=RADIUS)
    )
    assert (after.evidence > 0.9).all()


def test_cells_of_an_orbit_stay_and_others_move(rng):
    net, curves, true, off = scattered(rng)
    free = np.ones(len(net.points), bool)
    orbital = np.array([True, True, False, False])
    draft = replace(shapes.draft(curves, off), orbital=orbital)
    after = settled(net, draft, free, radius=RADIUS)
    assert np.array_equal(after.poses[:2], off[:2]) and not np.allclose(after.poses[2:], off[2:])
    whole = shapes.draft(curves, off)
    assert settled(net, whole, free, radius=RADIUS) is whole, "of cells alone nothing is to be moved"
    # unless it is said what moves together
    after = settled(net, whole, free, radius=RADIUS, together=np.array([0, 0, 1, 1]))
    for a, b in ((0, 1), (2, 3)):
        assert np.allclose(after.poses[b] @ np.linalg.inv(after.poses[a]), off[b] @ np.linalg.inv(off[a]))


def test_only_free_samples_have_a_say(rng):
    net, curves, true, off = scattered(rng)
    mine = np.isin(net.source[net.curve_of], np.arange(4))  # the first thing
    draft = shapes.draft(curves, off, orbital=False)
    after = settled(net, draft, ~mine, radius=RADIUS)
    assert np.allclose(after.poses[0], off[0]) and (after.evidence[0] < 0.3).all()
    assert (after.evidence[1:] > 0.6).all()
    nothing = settled(net, draft, np.zeros(len(net.points), bool), radius=RADIUS)
    assert np.array_equal(nothing.poses, off) and (nothing.evidence == 0).all()
    assert all(map(np.array_equal, nothing.curves, curves))


def test_curves_are_the_mean_of_what_shows_them(rng):
    net, curves, true, _ = scattered(rng, 6)
    wave = 0.8 * np.sin(np.arange(200) / 6)[:, None] * np.array([0.3, 0.8, 0.5])
    bent = [c + wave[: len(c)] for c in curves]
    draft = shapes.draft(bent, true, orbital=False, closed=[False] * 4)
    after = fit_to_samples(net, draft, np.arange(len(net.points)), radius=RADIUS)
    assert away(after, curves, true).mean() < 0.3 * away(draft, curves, true).mean()
    assert np.array_equal(after.poses, true) and after.closed == draft.closed
    for line in after.curves:
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        assert steps.mean() == pytest.approx(1, abs=0.05) and steps.max() < 1.2
    hidden = replace(draft, evidence=np.full((6, 4), 0.3))
    assert fit_to_samples(net, hidden, np.arange(len(net.points)), radius=RADIUS) is hidden
    assert fit_to_samples(net, draft, np.zeros(0, int), radius=RADIUS) is draft
    far = replace(draft, poses=true + naive.rigid(shift=[0, 0, 900]) - np.eye(4))
    assert fit_to_samples(net, far, np.arange(len(net.points)), radius=RADIUS) is far
