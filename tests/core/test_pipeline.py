# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method on a small planted row: what is found, what it may not depend on, progress and stopping."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import groupby

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.errors import Cancelled, InputError
from core.parameters import Parameters
from core.pipeline import complete
from core.report import report
from core.values import Curves
from tests import naive
from tests.core import shapes

H, CELLS = 0.05, 5
STAGES = ["blast", "seeding", "growth", "orbits", "selection", "completion"]
STEP = naive.rigid(shift=[2.1, 0.3, 0])


def planted(seed=3, *, noise=0.15, cells=CELLS):
    """Things in a row, each with a curve missing or cut, a long curve of its own and some clutter.

    Returns the curves, the true curves of one thing and the indices of the long curve and of the clutter.
    """
    rng = np.random.default_rng(seed)
    thing = [H * c for c in shapes.ornament(rng, 4, size=16, count=60)]
    curves = []
    for k in range(cells):
        m = np.linalg.matrix_power(STEP, k)
        for i, c in enumerate(thing):
            if k == 2 and i == 1:
                continue
            c = naive.moved(m, c) + noise * H * rng.normal(size=c.shape)
            curves += [c[:35], c[38:]] if (k + i) % 4 == 0 else [c]
    curves = [c[::-1] if rng.random() < 0.5 else c for c in curves]
    long = len(curves)
    curves.append(H * shapes.wiggle(rng, 130, bend=0.25) + [0, 0, 2.5])
    curves += [H * shapes.wiggle(rng, 12, bend=0.9) + rng.uniform(-1, 8, size=3) * [1, 0.3, 0.1] for _ in range(5)]
    return curves, thing, long


@pytest.fixture(scope="module")
def scene():
    return planted()


@pytest.fixture(scope="module")
def small():
    """The curves of a shorter row: enough to go through all stages."""
    return planted(cells=3)[0]


@pytest.fixture(scope="module")
def told():
    """(stage, fraction, seconds) of all progress while `completion` was made."""
    return []


@pytest.fixture(scope="module")
def completion(scene, told):
    def progress(stage, fraction):
        told.append((stage, fraction, time.perf_counter()))

    return complete(Curves.from_list(scene[0]), edge_length=H, progress=progress)


def placed(completion):
    """All points of all templates at all occurrences, world space, in a canonical order."""
    return [naive.moved(m, c.points) for t in completion.templates for c in t.curves for m in t.occurrences]


def test_the_row_is_found(completion, scene):
    curves, thing, long = scene
    (t,) = completion.transformations
    assert t.kind == "translation" and t.generators.shape == (1, 4, 4)
    step = t.generators[0] if t.generators[0, 0, 3] > 0 else np.linalg.inv(t.generators[0])
    assert np.abs(step - STEP).max() < 0.5 * H
    assert t.extent.tolist() == [[0, CELLS - 1]] and t.log_bayes_factor > np.log(10) and 0.5 < t.support < 1
    assert max(len(x.occurrences) for x in completion.templates) == CELLS
    assert completion.inputs.kind[long] == "strong" and (completion.inputs.kind[long + 1 :] == "noise").all()
    row = completion.inputs.kind[:long]
    lengths = np.array([naive.length(c) / H for c in curves[:long]])
    assert (row[lengths > 10] == "template").mean() > 0.9


def test_the_missing_curve_is_completed(completion, scene):
    curves, thing, _ = scene
    shown = cKDTree(np.concatenate(placed(completion)))
    truth = np.concatenate([naive.moved(np.linalg.matrix_power(STEP, k), c) for k in range(CELLS) for c in thing])
    assert (shown.query(truth)[0] < 2 * H).mean() > 0.93
    missing = naive.moved(np.linalg.matrix_power(STEP, 2), thing[1])
    assert cKDTree(np.concatenate(curves)).query(missing)[0].mean() > 1.5 * H, "it really is missing"
    assert (shown.query(missing)[0] < 2 * H).mean() > 0.8
    # and nothing is invented: what is shown lies on the truth
    assert (cKDTree(truth).query(shown.data)[0] < 2 * H).mean() > 0.97


def test_the_report_agrees_with_the_result(completion, scene):
    document = report(completion, Curves.from_list(scene[0]), version="0", parameters=Parameters())
    assert document["input"]["curves"] == len(scene[0]) == len(document["inputs"])
    count = sum(len(t.curves) * len(t.occurrences) for t in completion.templates) + len(completion.strong)
    assert len(document["curves"]) == count
    assert list(completion.seconds) == STAGES and all(s >= 0 for s in completion.seconds.values())
    work = completion.work
    assert work["strong_curves"] > 5 and work["point_pairs"] > 0 and work["matches"] > 0
    assert work["transformations"] >= 1
    components = [c.component for t in completion.templates for c in t.curves]
    assert components == list(range(len(components)))
    assert all(c.component == -1 for c in completion.strong)
    template = completion.inputs.kind == "template"
    assert set(completion.inputs.component[template]) <= set(components)
    assert (completion.inputs.component[~template] == -1).all()
    assert (completion.inputs.transformation[~template] == -1).all()
    assert (completion.inputs.transformation[template] == 0).all()
    for t in completion.templates:
        assert t.evidence.shape == (len(t.occurrences), len(t.curves))
        assert (t.evidence >= 0).all() and (t.evidence <= 1).all()
        assert all(0 <= c.support <= 1 and len(c.points) >= 2 for c in t.curves)
        r = t.occurrences[:, :3, :3]
        assert np.allclose(r @ np.swapaxes(r, 1, 2), np.eye(3)) and np.allclose(np.linalg.det(r), 1)


@pytest.mark.parametrize("change", ["pose", "scale", "order", "direction", "far"])
def test_the_result_changes_by_rounding_only(completion, scene, change):
    curves, _, long = scene
    rng = np.random.default_rng(8)
    m, size, order = np.eye(4), 1.0, np.arange(len(curves))
    if change == "pose":
        m = shapes.random_motion(rng)
    if change == "far":
        m = naive.rigid(shift=[1e5, -1e5, 1e5])
    if change == "scale":
        size = 0.0317
    if change == "order":
        order = rng.permutation(len(curves))
    other = [size * naive.moved(m, curves[i]) for i in order]
    if change == "direction":
        other = [c[::-1] if rng.random() < 0.5 else c for c in other]
    got = complete(Curves.from_list(other), edge_length=size * H)
    assert np.array_equal(got.inputs.kind, completion.inputs.kind[order])
    assert np.array_equal(got.inputs.component, completion.inputs.component[order])
    assert [len(t.occurrences) for t in got.templates] == [len(t.occurrences) for t in completion.templates]
    assert len(placed(got)) == len(placed(completion))
    for a, b in zip(placed(completion), placed(got)):
        assert len(a) == len(b)
        assert np.abs(size * naive.moved(m, a) - b).max() < 1e-6 * size * H
    for a, b in zip(completion.strong, got.strong):
        assert np.abs(size * naive.moved(m, a.points) - b.points).max() < 1e-6 * size * H
    for a, b in zip(completion.transformations, got.transformations):
        assert a.kind == b.kind and np.array_equal(a.extent, b.extent)
        assert a.support == pytest.approx(b.support, abs=1e-6)
        assert a.log_bayes_factor == pytest.approx(b.log_bayes_factor, rel=1e-4)


def test_threads_and_blocks_do_not_change_the_result(completion, scene):
    got = complete(Curves.from_list(scene[0]), edge_length=H, parameters=Parameters(threads=3, block=1 << 14))
    assert all(np.array_equal(a, b) for a, b in zip(placed(got), placed(completion)))
    assert np.array_equal(got.inputs.component, completion.inputs.component)
    assert got.work == completion.work


def test_the_input_is_not_modified(small):
    curves = Curves.from_list(small, strength=[np.linspace(0, 1, len(c)) for c in small])
    for array in (curves.points, curves.offsets, curves.closed, curves.strength, curves.source):
        array.flags.writeable = False
    complete(curves, edge_length=H)


def test_progress_tells_the_stages_in_order(completion, told):
    assert [stage for stage, _ in groupby(told, key=lambda x: x[0])] == STAGES
    for stage in STAGES:
        shares = [f for s, f, _ in told if s == stage]
        assert shares[0] == 0 and shares[-1] == 1 and min(shares) >= 0 and max(shares) <= 1
        assert shares == sorted(shares), stage


@pytest.mark.parametrize("stage", STAGES)
def test_a_stop_is_prompt(small, stage):
    asked = []

    def progress(now, fraction):
        if now == stage:
            asked.append(time.perf_counter())
            raise Cancelled

    with pytest.raises(Cancelled):
        complete(Curves.from_list(small), edge_length=H, progress=progress)
    assert time.perf_counter() - asked[0] < 0.5 and len(asked) == 1


def test_progress_is_told_often_enough_to_stop(completion, told):
    # half a second on an idle machine; the tests may share theirs
    assert np.diff([when for *_, when in told]).max() < 2.0


def test_no_strong_curve_says_so_and_suggests_l0():
    curves = Curves.from_list([shapes.line(15), shapes.line(18, [0, 5, 0])])
    with pytest.raises(InputError, match=r"no curve is strong.*l0 = 25.*the longest has 17\.0; try l0 = 8"):
        complete(curves, edge_length=1.0)
    with pytest.raises(InputError, match=r"l0 = 500"):
        complete(curves, edge_length=1.0, parameters=Parameters(l0=500.0))
    # what is suggested works
    assert complete(curves, edge_length=1.0, parameters=Parameters(l0=8.0)).inputs.kind.shape == (2,)


def test_bad_parameters_are_refused_before_anything_runs(scene):
    told = []
    with pytest.raises(InputError, match="l0 is"):
        complete(
            Curves.from_list(scene[0]), parameters=replace(Parameters(), l0=-1.0), progress=lambda *a: told.append(a)
        )
    assert told == []


def degenerate(rng):
    one = shapes.wiggle(rng, 100, bend=0.3)
    return {
        "all curves identical": [one] * 5,
        "a single curve": [one],
        "a single straight line": [shapes.line(80)],
        "straight lines": [shapes.line(60, [0, 7 * k, 0]) for k in range(6)],
        "a circle": [np.r_[shapes.circle(20), shapes.circle(20)[:1]]],
        "a single curve just longer than l0": [shapes.line(27)],
        "doubled vertices": [np.repeat(one, 3, axis=0), one + [30, 0, 0]],
        "lonely points": [one, one[:1], one[:1] + 5, one + [0, 40, 0]],
        "mirrored": [one, one * [1, 1, -1]],
    }


@pytest.mark.parametrize("name", degenerate(np.random.default_rng(0)))
def test_degenerate_networks_end_with_a_result(rng, name):
    curves = degenerate(rng)[name]
    got = complete(Curves.from_list(curves), edge_length=1.0)
    assert got.inputs.kind.shape == (len(curves),) and set(got.inputs.kind) <= {"template", "strong", "noise"}
    for p in [*placed(got), *(c.points for c in got.strong)]:
        assert np.isfinite(p).all()
    if name == "all curves identical":
        # what lies on itself does not recur: occurrences are apart
        for t in got.templates:
            p = np.concatenate([c.points for c in t.curves])
            there = [naive.moved(m, p) for m in t.occurrences]
            for k, a in enumerate(there):
                assert all(np.linalg.norm(a - b, axis=1).mean() > 3 for b in there[:k])
    if name == "a single curve":
        assert got.inputs.kind.tolist() == ["strong"] and not got.templates


@pytest.mark.parametrize("seed", range(4))
def test_a_curve_and_its_copy_are_two_occurrences(seed):
    one = shapes.wiggle(np.random.default_rng(seed), 100, bend=0.3)
    m = naive.about([1, 2, 3], 1.0, [30, 0, 0], along=20)
    got = complete(Curves.from_list([one, naive.moved(m, one)]), edge_length=1.0)
    assert [(len(t.curves), len(t.occurrences)) for t in got.templates] == [(1, 2)]
    assert naive.length(got.templates[0].curves[0].points) > 85


def test_a_closed_ring_stays_closed(rng):
    ring = shapes.circle(20)
    got = complete(Curves.from_list([ring, shapes.wiggle(rng, 100) + 90], [True, False]), edge_length=1.0)
    assert sorted(c.closed for c in got.strong) == [False, True]
