# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes drawn from a seed: the same everywhere, fair, of every kind; and the verdict on results."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from benchmarks import programs
from benchmarks.measures import sampled
from benchmarks.random_scenes import (
    LAYOUTS,
    LEVELS,
    RandomScene,
    layout_of,
    make_random_scene,
    name_of,
    save_random_scene,
)
from benchmarks.random_scenes.__main__ import main, seeds_of
from benchmarks.random_scenes.copies import STRETCH, has_copies
from benchmarks.random_scenes.designs import CLEARANCE, COUNTS, LENGTHS, is_clear
from benchmarks.random_scenes.elements import OUTLINES
from benchmarks.random_scenes.judging import completable, judge
from benchmarks.random_scenes.motifs import LARGEST, PARTS, SMALLEST, draw_motif, runs_beside, warped
from benchmarks.random_scenes.tables import line_of, table
from benchmarks.scenes import EDGE_LENGTH, load_scene
from benchmarks.scenes.shapes import resample, rotation

NONE = 6 * len(LAYOUTS) - 1
"""A seed that draws a scene where nothing recurs."""
REFERENCE = Path(__file__).parents[3] / "shared/evaluate"


@pytest.fixture(scope="module")
def scenes():
    """One clean scene of every layout."""
    seeds = [*range(len(LAYOUTS) - 1), NONE]
    return [make_random_scene(seed, "clean") for seed in seeds]


def same(a, b):
    return len(a) == len(b) and all(np.array_equal(p, q) for p, q in zip(a, b))


def instance_points(scene, k):
    chosen = [c for c, label in zip(scene.truth, scene.truth_labels) if label[0] == 0 and label[2] == k]
    return np.concatenate(chosen)


def perfect(scene):
    """The report of a program that knows the truth; one template for each kind, in the frame of its first place."""
    curves, templates, place = [], [], {}
    for kind in np.unique(scene.pose_kind):
        members = np.flatnonzero(scene.pose_kind == kind)
        to_first = [scene.poses[m] @ np.linalg.inv(scene.poses[members[0]]) for m in members]
        templates.append({"id": int(kind), "occurrences": np.array(to_first).tolist()})
        place |= {int(m): (int(kind), number) for number, m in enumerate(members)}
    for points, label in zip(scene.truth, scene.truth_labels):
        template, occurrence = place[int(label[2])] if label[0] == 0 else (None, None)
        kind = "strong" if template is None else "template"
        curves.append({"points": points.tolist(), "kind": kind, "template": template, "occurrence": occurrence})
    kinds = [["template", "strong", "noise"][label[0]] for label in scene.labels]
    inputs = [
        {"kind": k, "component": int(label[1]) if label[0] == 0 else None} for k, label in zip(kinds, scene.labels)
    ]
    return {"curves": curves, "templates": templates, "inputs": inputs}


def as_it_is(scene):
    """The report of a program that finds nothing and keeps every curve."""
    curves = [{"points": c.tolist(), "kind": "strong", "template": None, "occurrence": None} for c in scene.curves]
    return {"curves": curves, "templates": [], "inputs": [{"kind": "strong", "component": None} for _ in curves]}


def test_a_seed_gives_one_scene():
    one, two, other = (make_random_scene(seed, "hard") for seed in (3, 3, 19))
    assert same(one.curves, two.curves) and same(one.truth, two.truth) and np.array_equal(one.labels, two.labels)
    assert np.array_equal(one.poses, two.poses)
    assert one.layout == other.layout and not same(one.truth, other.truth)


def test_a_scene_is_the_one_that_others_have():
    """Counts and lengths of one seed, as they came out where this was written."""
    scene = make_random_scene(3, "medium")
    assert scene.layout == "staggered"
    found = len(scene.truth), len(scene.curves), len(scene.poses), sum(map(len, scene.curves))
    assert found == (90, 285, 22, 5340)
    assert np.abs(np.concatenate(scene.curves)).mean() == pytest.approx(3.862210, abs=1e-6)


def test_levels_show_the_same_things():
    clean, medium = (make_random_scene(8, level) for level in ("clean", "medium"))
    assert len(clean.truth) == len(medium.truth) and len(clean.poses) == len(medium.poses)
    between = medium.poses[0] @ np.linalg.inv(clean.poses[0])
    moved = clean.truth[0] @ between[:3, :3].T + between[:3, 3]
    assert np.allclose(moved, medium.truth[0], atol=1e-9)
    assert (clean.labels[:, 0] < 2).all() and (medium.labels[:, 0] == 2).any()


def test_a_pose_carries_a_thing_to_its_instance(scenes):
    for scene in scenes:
        first = {}
        for k, (pose, kind) in enumerate(zip(scene.poses, scene.pose_kind)):
            own = (instance_points(scene, k) - pose[:3, 3]) @ pose[:3, :3]
            assert np.allclose(own, first.setdefault(int(kind), own), atol=1e-9)
        turns = scene.poses[:, :3, :3]
        assert np.allclose(turns @ turns.transpose(0, 2, 1), np.eye(3))
        mirrored = np.linalg.det(turns) < 0
        assert mirrored.mean() == 0.5 if scene.layout == "mirrored" else not mirrored.any()


def test_instances_keep_their_distance_from_every_other_curve(scenes):
    for scene in scenes:
        points, of = sampled(scene.truth, EDGE_LENGTH / 2)
        instance = scene.truth_labels[of, 2]
        for k in range(len(scene.poses)):
            apart = cKDTree(points[instance != k]).query(points[instance == k])[0].min() if (instance != k).any() else 9
            assert apart >= 0.98 * CLEARANCE * EDGE_LENGTH, scene.layout


def test_scenes_are_of_fair_size(scenes):
    for scene in scenes:
        length = sum(len(c) - 1 for c in scene.truth)
        assert LENGTHS[0] * 0.9 <= length <= 2.2 * LENGTHS[1], scene.layout
        counts = np.bincount(scene.pose_kind) if len(scene.poses) else []
        assert all(COUNTS[0] <= c <= COUNTS[1] for c in counts)
        edges = np.concatenate([np.linalg.norm(np.diff(c, axis=0), axis=1) for c in scene.truth])
        assert abs(np.median(edges) / EDGE_LENGTH - 1) < 0.03


def test_every_layout_is_what_its_name_says(scenes):
    kinds = {scene.layout: len(set(scene.pose_kind.tolist())) for scene in scenes}
    assert tuple(kinds) == LAYOUTS
    assert kinds["two"] == 2 and kinds["three"] == 3 and kinds["inside"] == 2 and kinds["none"] == 0
    single = scenes[LAYOUTS.index("single")]
    assert (single.truth_labels[:, 0] == 1).sum() >= PARTS[0]
    assert layout_of(len(LAYOUTS)) == LAYOUTS[0]


def test_all_motifs_are_drawn():
    motifs = [draw_motif(np.random.default_rng(seed)) for seed in range(90)]
    words = {word for m in motifs for word in m.words}
    assert {"symmetric", "uneven", "flat", "deep", "bar", "circle", "spline", "zigzag", "spiral"} <= words
    assert {"tracery", "baluster", "ring", "foot", "return"} <= words
    for shape in OUTLINES:
        assert f"frame: {shape}" in words and f"nested frames: {shape}" in words
    boxes = np.array([m.box for m in motifs])
    assert all(PARTS[0] <= len(m.parts) <= PARTS[1] for m in motifs)
    across = boxes[:, :2].max(axis=1)
    assert across.min() < 1.5 * SMALLEST and across.max() > 0.7 * LARGEST
    aspect = np.log(boxes[:, 0] / boxes[:, 1]) / np.log(5)
    assert aspect.min() < -0.8 and aspect.max() > 0.8


def test_a_curve_that_runs_along_another_is_seen():
    x = np.arange(60.0)
    straight = np.c_[x, 0 * x, 0 * x]
    assert runs_beside(straight + [0, 2.5, 0], [straight])
    assert not runs_beside(straight + [0, 3.5, 0], [straight])
    assert not runs_beside(np.c_[0 * x + 30, x - 30, 0 * x], [straight])  # a crossing
    assert not runs_beside(straight, [])


def test_bodies_are_clear_by_the_distance_only():
    x = np.arange(40.0)
    straight = np.c_[x, 0 * x, 0 * x]
    assert is_clear([straight, straight + [0, CLEARANCE + 0.3, 0]])
    assert not is_clear([straight, straight + [0, CLEARANCE - 0.1, 0]])


def test_a_bent_thing_is_symmetric_no_more():
    motif = draw_motif(np.random.default_rng(5), size=120, symmetric=True, framed=True)

    def off(m):
        points = np.concatenate(m.parts)
        return np.median(cKDTree(points).query(points * [-1, 1, 1])[0])

    assert off(motif) < 1 < 3 < off(warped(motif, np.random.default_rng(0)))


def test_copies_are_seen_wherever_they_lie():
    knots = np.random.default_rng(4).normal(size=(2, 12, 3)) * 12  # a turn in every 30 edges
    drawn, other = (resample(CubicSpline(np.arange(12), k)(np.linspace(0, 11, 900)), 1.0) for k in knots)
    turn = rotation((1, 2, 3), 130)
    assert not has_copies([drawn, other])
    for copy in (drawn @ turn.T + 50, (drawn @ turn.T + 50)[::-1], drawn * [-1, 1, 1], drawn[37:]):
        assert has_copies([drawn], [copy])
    assert not has_copies([drawn], [drawn[: STRETCH - 1]])
    straight = np.c_[np.arange(200.0), np.zeros((200, 2))]
    assert not has_copies([straight, straight + [0, 9, 0]])  # like all lines
    wave = np.c_[np.arange(500.0), 20 * np.sin(np.arange(500) * 2 * np.pi / 120), np.zeros(500)]
    assert has_copies([wave])  # its own periods


def test_where_nothing_recurs_no_stretch_has_a_copy(scenes):
    parts = [c / EDGE_LENGTH for c in scenes[-1].truth]
    assert scenes[-1].layout == "none" and not has_copies([resample(c, 1.0) for c in parts])


def test_the_truth_passes_and_the_input_does_not(scenes):
    for scene in scenes:
        whole, bare = judge(scene, perfect(scene), "clean"), judge(scene, as_it_is(scene), "clean")
        assert whole["passed"] and whole["pose_recall"] == whole["pose_precision"] == 1.0, scene.layout
        assert whole["stray"] == 0
        assert bare["pose_recall"] == (1.0 if scene.layout == "none" else 0.0)
    scene = make_random_scene(1, "medium")
    assert judge(scene, perfect(scene), "medium")["passed"]
    assert not judge(scene, as_it_is(scene), "medium")["passed"]


def test_anything_found_where_nothing_recurs_fails():
    scene = make_random_scene(NONE, "medium")
    report = as_it_is(scene)
    assert judge(scene, report, "medium")["passed"]
    report["templates"] = [{"id": 0, "occurrences": [np.eye(4).tolist(), np.eye(4).tolist()]}]
    failed = judge(scene, report, "medium")
    assert not failed["passed"] and failed["rule"] == "none" and failed["pose_precision"] == 0


def test_what_is_seen_twice_passes_by_being_found():
    scene = next(s for s in (make_random_scene(k, "medium", layout="row") for k in range(200)) if len(s.poses) == 2)
    found, missed = perfect(scene), as_it_is(scene)
    first = [c for c in found["curves"] if c["occurrence"] == 0]
    found["curves"] = first + missed["curves"]  # the second place is not drawn
    result = judge(scene, found, "medium")
    assert result["rule"] == "twice" and result["passed"] and not result["reached"]["instances"]
    assert not judge(scene, missed, "medium")["passed"]
    wrong = np.array(found["templates"][0]["occurrences"])
    wrong[1, :3, 3] += 4 * EDGE_LENGTH * wrong[1, :3, 2]
    found["templates"][0]["occurrences"] = wrong.tolist()
    assert not judge(scene, found, "medium")["passed"]


def test_what_no_input_shows_cannot_be_completed():
    x = np.linspace(0, 0.98, 50)
    line = np.c_[x, 0 * x, 0 * x]
    poses = np.array([np.eye(4)] * 3)
    poses[:, 1, 3] = 0, 1, 2
    scene = RandomScene(
        curves=[
            line[a:b] + [0.002, y, z] for a, b, y, z in ((0, 20, 0, 0), (10, 30, 1, 0), (0, 25, 2, 0), (25, 50, 2, 9))
        ],
        labels=np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2], [2, -1, -1]]),
        truth=[line + [0, y, 0] for y in (0, 1, 2)],
        truth_labels=np.array([[0, 0, 0], [0, 0, 1], [0, 0, 2]]),
        poses=poses,
        pose_kind=np.zeros(3, int),
        layout="row",
        words=(),
    )
    # Up to two edges beyond its ends a curve shows what is there: 22, 23 and 27 of 50, and 32 of them somewhere.
    assert completable(scene) == pytest.approx((10 + 9 + 5) / (28 + 27 + 23))


def test_the_other_scorer_agrees(tmp_path):
    if not (REFERENCE / "score.py").is_file():
        pytest.skip("no other scorer here")
    spec = importlib.util.spec_from_file_location("other_scorer", REFERENCE / "score.py")
    other = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(other)
    for seed, report in ((3, perfect), (17, as_it_is)):
        scene = make_random_scene(seed, "medium")
        save_random_scene(scene, tmp_path / "scene")
        expected = other.score(tmp_path / "scene.npz", report(scene))
        result = judge(scene, report(scene), "medium")
        for name, value in expected.items():
            assert result[name] == pytest.approx(value, abs=2e-3, nan_ok=True), name


def test_scenes_are_written_and_programs_run(tmp_path, capsys):
    assert main(["make", "--seeds", "3", "--level", "hard", "--folder", str(tmp_path)]) == 0
    stem = tmp_path / name_of(3, "hard", layout_of(3))
    scene, kept = make_random_scene(3, "hard"), load_scene(stem.with_suffix(".npz"))
    assert same(kept.curves, scene.curves) and np.array_equal(kept.truth_labels, scene.truth_labels)
    with np.load(stem.with_suffix(".npz")) as z:
        assert np.array_equal(z["poses"], scene.poses) and np.array_equal(z["pose_kind"], scene.pose_kind)
        assert str(z["layout"]) == "staggered"
    assert stem.with_suffix(".obj").read_text().count("\nl ") == len(scene.curves)
    nothing = tmp_path / "nothing.py"
    nothing.write_text(
        "import json, sys\n"
        "n = sum(line.startswith('l ') for line in open(sys.argv[1]))\n"
        "inputs = [{'kind': 'noise', 'component': None}] * n\n"
        "json.dump({'curves': [], 'templates': [], 'inputs': inputs}, open(sys.argv[-1], 'w'))\n"
    )
    out = tmp_path / "results.jsonl"
    both = ["run", "--seeds", str(NONE), "--level", "medium", "--layout", "none", "row", "--out", str(out)]
    assert main([*both, "--program", f"{sys.executable} {nothing}"]) == 0
    results = [json.loads(line) for line in out.read_text().splitlines()]
    assert [r["layout"] for r in results] == ["none", "row"]
    assert [r["passed"] for r in results] == [True, False] and all(r["measured"] for r in results)
    assert main(["run", "--seeds", "3", "--out", str(out), "--program", f"{sys.executable} -c pass"]) == 0
    assert not json.loads(out.read_text())["passed"]
    capsys.readouterr()
    assert main(["table", str(out), "--lines"]) == 0
    assert "without a result: 1 of 1" in capsys.readouterr().out


def test_a_program_that_takes_too_long_is_ended():
    run = programs.run([sys.executable, "-c", "import time; print('begun', flush=True); time.sleep(60)"], limit=1.0)
    assert not run.in_time and run.wall < 30 and run.code != 0 and run.said == "begun"
    run = programs.run([sys.executable, "-c", "x = bytearray(300_000_000)"], limit=60)
    assert run.in_time and run.code == 0 and run.peak > 300_000_000


def test_the_table_counts_by_layout():
    base = {"level": "medium", "seconds": 1.0, "peak": 2**20, "in_time": True, "measured": True, "said": ""}
    numbers = {"in_F": 0.7, "completed": 1.0, "instances": 4, "instances_90": 4, "pose_recall": 1.0}
    numbers |= {"pose_precision": 1.0, "templates": 1, "occurrences": 4, "drawn": 100.0}
    good = {"F": True, "completed": True, "instances": True}
    results = [
        base | numbers | {"name": "a", "layout": "row", "rule": "goals", "passed": True, "out_F": 1.0, "stray": 0.0}
        | {"reached": good},
        base | numbers | {"name": "b", "layout": "row", "rule": "goals", "passed": False, "out_F": 0.5, "stray": 10.0}
        | {"reached": good | {"F": False}},
        base | numbers | {"name": "c", "layout": "none", "rule": "none", "passed": False, "out_F": 0.8, "stray": 2.0}
        | {"reached": good},
    ]  # fmt: skip
    text = table(results)
    assert "0.50 (1/2)" in text and "something found: 1.00 (1/1)" in text
    assert "out minus in: +0.100" in text and "every true curve: 4.00%" in text
    assert "F 0.700>0.500*" in line_of(results[1])


def test_seeds_are_read():
    assert seeds_of("2:5") == [2, 3, 4] and seeds_of("7") == [7] and seeds_of("1,5") == [1, 5]
    assert tuple(LEVELS) == ("clean", "medium", "hard")
