# SPDX-License-Identifier: GPL-3.0-or-later
"""The measures on cases whose answer is known, and against loops that share no code with them."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks import measures, quality
from benchmarks.scenes import Scene, load_scene, make_scene, save_scene

H = 0.02
REFERENCE = Path(__file__).parents[3] / "shared/evaluate"


def straight(x0, x1, y, *, z=0.0):
    n = int(round((x1 - x0) / H)) + 1
    return np.c_[np.linspace(x0, x1, n), np.full(n, y), np.full(n, z)]


def row_of_two():
    """Two instances of one line, the second seen by half; one single line; one clutter curve far away."""
    truth = [straight(0, 1, 0), straight(0, 1, 2), straight(0, 3, 4)]
    truth_labels = np.array([[0, 0, 0], [0, 0, 1], [1, -1, -1]])
    curves = [truth[0], straight(0, 0.5, 2), truth[2], straight(0, 1, 9)]
    labels = np.array([[0, 0, 0], [0, 0, 1], [1, -1, -1], [2, -1, -1]])
    return Scene(curves, labels, truth, truth_labels)


def loop_sampled(polylines, step):
    """Walk along each polyline, one step at a time."""
    out = []
    for p in polylines:
        if len(p) == 0:
            continue
        walked = 0.0
        out.append(p[0])
        target = step
        for a, b in zip(p[:-1], p[1:]):
            d = np.linalg.norm(b - a)
            while d > 0 and walked + d >= target - 1e-12:
                out.append(a + (target - walked) / d * (b - a))
                target += step
            walked += d
    return np.array(out).reshape(-1, 3)


def test_samples_agree_with_a_walk_along_the_curves():
    rng = np.random.default_rng(0)
    lines = [rng.normal(size=(n, 3)) for n in (2, 7, 1, 40, 0, 3)]
    lines.append(np.repeat(lines[0][:1], 4, axis=0))
    lines.append(np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0.0]]))
    points, of = measures.sampled(lines, 0.13)
    assert np.allclose(points, loop_sampled(lines, 0.13), atol=1e-9)
    assert np.array_equal(np.unique(of), [0, 1, 2, 3, 5, 6, 7])


def test_samples_of_nothing():
    points, of = measures.sampled([], 0.1)
    assert points.shape == (0, 3) and len(of) == 0


def test_the_truth_as_output_is_perfect():
    scene = row_of_two()
    inputs = [{"kind": k, "component": c} for k, c in (("template", 1), ("template", 1), ("strong", None),
                                                       ("noise", None))]  # fmt: skip
    r = measures.measure(scene, scene.truth, inputs)
    assert r["out_F"] == r["out_F@h"] == 1.0
    assert (r["completed"], r["clutter_left"]) == (1.0, 0.0)
    assert (r["instances"], r["instances_90"]) == (2, 2)
    assert r["rms_out/h"] == pytest.approx(0, abs=1e-9)
    assert (r["rep_recall"], r["rep_prec"], r["noise_removed"]) == (1.0, 1.0, 1.0)
    assert (r["comp_P"], r["comp_R"], r["comp_F"], r["comp_share"]) == (1.0, 1.0, 1.0, 1.0)


def test_the_input_as_output_completes_nothing_and_keeps_the_clutter():
    scene = row_of_two()
    r = measures.measure(scene, scene.curves)
    # of two lines of 101 samples, the stretch from 0.55 to 1 of the second is farther than two edges from what is seen
    assert r["missing_share"] == pytest.approx(46 / 202, abs=0.006)
    assert (r["completed"], r["clutter_left"]) == (0.0, 1.0)
    assert (r["instances"], r["instances_90"]) == (2, 1)
    assert r["out_P"] == r["in_P"] == pytest.approx((101 + 51 + 301) / (101 + 51 + 301 + 101), abs=2e-3)
    assert "comp_F" not in r


def test_half_of_what_is_missing():
    scene = row_of_two()
    output = [scene.curves[0], scene.curves[1], straight(0.5, 0.78, 2), scene.curves[2]]
    r = measures.measure(scene, output)
    assert r["completed"] == pytest.approx(28 / 46, abs=0.012)  # of 0.55 to 1, what ends two edges after 0.78


@pytest.mark.parametrize(("offset", "inside"), [(0.039, True), (0.041, False)])
def test_the_bound_is_two_edges(offset, inside):
    scene = row_of_two()
    r = measures.measure(scene, [c + [0, 0, offset] for c in scene.truth])
    assert (r["out_P"] == 1.0) == inside and (r["out_P"] == 0.0) == (not inside)
    assert r["out_P@h"] == 0.0
    if inside:
        assert r["rms_out/h"] == pytest.approx(offset / H)
    else:
        assert np.isnan(r["rms_out/h"])


def test_an_empty_output():
    r = measures.measure(row_of_two(), [])
    assert (r["out_P"], r["out_R"], r["out_F"], r["completed"], r["instances_90"]) == (1.0, 0.0, 0.0, 0.0, 0)


def test_pairs_are_counted_by_weight():
    # found {a, b}, {c}; true {a}, {b, c}: together (a, b) weighs 2 * 3, belonging (b, c) weighs 3 * 5
    assert measures.pair_counting([0, 0, 1], [0, 1, 1], [2, 3, 5]) == (0.0, 0.0)
    assert measures.pair_counting([0, 0, 0], [0, 1, 1], [2, 3, 5]) == pytest.approx((15 / (6 + 10 + 15), 1.0))
    assert measures.pair_counting([0, 1, 2], [0, 1, 1], [2, 3, 5]) == (1.0, 0.0)


def test_pairs_agree_with_a_double_loop():
    rng = np.random.default_rng(4)
    a, b, w = rng.integers(0, 4, 40), rng.integers(0, 5, 40), rng.integers(1, 9, 40)
    together = belong = both = 0
    for i in range(40):
        for j in range(i):
            weight = w[i] * w[j]
            together += weight * (a[i] == a[j])
            belong += weight * (b[i] == b[j])
            both += weight * (a[i] == a[j] and b[i] == b[j])
    assert measures.pair_counting(a.astype(str), b, w) == pytest.approx((both / together, both / belong))


def test_classes_that_do_not_fit_the_input_are_said():
    assert "inputs_mismatch" in measures.measure(row_of_two(), [], [{"kind": "noise", "component": None}])


def test_goals_are_inclusive():
    just = {"out_F": 0.95, "completed": 0.9, "clutter_left": 0.05, "rms_ratio": 0.6, "instances_share": 0.9,
            "comp_F": 0.9}  # fmt: skip
    assert quality.missed(just, "medium") == [] == quality.missed(just, "light")
    assert quality.missed({**just, "clutter_left": 0.0501}, "medium") == ["clutter_left"]
    assert quality.missed({**just, "out_F": float("nan")}, "hard") == ["out_F"]
    assert quality.missed({}, "clean") == ["out_F"]


def test_the_level_is_read_from_the_name():
    assert quality.level_of("gothic-grid-hard-7") == "hard"
    assert quality.level_of("two-grids-clean-1") == "clean"
    assert quality.level_of("scan") == "medium"


def test_closed_curves_lose_their_repeated_point():
    angle = np.linspace(0, 2 * np.pi, 50)
    loop = np.c_[np.cos(angle), np.sin(angle), np.zeros(50)]
    loop[-1] = loop[0]
    curves = quality.curves_of(Scene([loop, straight(0, 1, 0)], None, None, None))
    assert curves.closed.tolist() == [True, False]
    assert np.diff(curves.offsets).tolist() == [49, 51]


def test_a_report_is_measured_from_the_command_line(tmp_path, capsys):
    scene = make_scene("subgrid", "medium", 1)
    save_scene(scene, tmp_path / "subgrid-medium-1")
    labels = [("template", int(k)) if c == 0 else (("strong", "noise")[c - 1], None) for c, k, _ in scene.labels]
    document = {
        "curves": [{"points": c.tolist()} for c in scene.truth],
        "inputs": [{"kind": kind, "component": component} for kind, component in labels],
        "seconds": {}, "work": {},
    }  # fmt: skip
    report = tmp_path / "report.json"
    report.write_text(json.dumps(document))
    command = [str(tmp_path / "subgrid-medium-1.npz"), "--report", str(report)]
    assert quality.main([*command, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["out_F"] == result["comp_F"] == 1.0 and result["missed"] == []
    document["curves"] = [{"points": c.tolist()} for c in scene.curves]
    report.write_text(json.dumps(document))
    assert quality.main(command) == 1
    line = capsys.readouterr().out
    assert "FAIL" in line and "completed 0.0" in line and "comp_F 1.000 " in line


@pytest.mark.skipif(not (REFERENCE / "score.py").is_file(), reason="the reference scorer is not here")
@pytest.mark.parametrize("name", ["rosette-hard-7", "theatre-medium-7"])
def test_the_measures_agree_with_the_reference(name):
    spec = importlib.util.spec_from_file_location("reference_score", REFERENCE / "score.py")
    reference = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(reference)
    path = REFERENCE / "scenes" / f"{name}.npz"
    scene, rng = load_scene(path), np.random.default_rng(1)
    curves = [c for c, label in zip(scene.curves, scene.labels) if label[0] < 2 or rng.random() < 0.2]
    curves += [t + rng.normal(size=t.shape) * 0.004 for t in scene.truth[::2]]
    inputs = [
        {"kind": str(rng.choice(["template", "strong", "noise"])),
         "component": None if rng.random() < 0.3 else int(label[1] if rng.random() < 0.7 else rng.integers(9))}
        for label in scene.labels
    ]  # fmt: skip
    theirs = reference.score(str(path), {"curves": [{"points": c.tolist()} for c in curves], "inputs": inputs})
    ours = measures.measure(scene, curves, inputs)
    assert set(theirs) == set(ours)
    for key, value in theirs.items():
        assert ours[key] == pytest.approx(value, abs=1e-4), key
