# SPDX-License-Identifier: GPL-3.0-or-later
"""The report says what the completion holds, in world space and per input curve."""

import json

import numpy as np
import pytest

from core.parameters import Parameters
from core.report import STAGES, classes_of_inputs, lengths, report
from core.values import CompletedCurve, Completion, Curves, InputClasses, Template, Transformation


def turned(angle, shift):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, shift[0]], [s, c, 0, shift[1]], [0, 0, 1, shift[2]], [0, 0, 0, 1]])


ARC = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
PLACES = np.array([np.eye(4), turned(np.pi / 2, (5, 0, 1))])


@pytest.fixture
def completion():
    step = Transformation(3, "single", PLACES[1:], np.array([[0, 1]]), 12.5, 0.25)
    curves = (CompletedCurve(ARC, True, 4, 0.75), CompletedCurve(ARC + 2, False, 2, 0.5))
    template = Template(7, 3, curves, PLACES, np.array([[1.0, 0.5], [0.25, 0.0]]))
    classes = InputClasses(np.array(["template", "noise", "strong"]), np.array([3, -1, -1]), np.array([4, -1, -1]))
    strong = (CompletedCurve(ARC + 9, False, -1, 1.0),)
    return Completion(0.5, (step,), (template,), strong, classes, {"blast": 1.5}, {"matches": np.int64(3)})


@pytest.fixture
def curves():
    return Curves.from_list([ARC, ARC + 1, ARC + 2], closed=[True, False, False])


def made(completion, curves, **more):
    return report(completion, curves, version="1.2.3", parameters=Parameters(l0=30), **more)


def test_it_is_json_and_has_what_is_promised(completion, curves):
    document = json.loads(json.dumps(made(completion, curves), allow_nan=False))
    assert document["schema"] == "fcn-report/1"
    assert document["version"] == "1.2.3"
    assert document["input"] == {"curves": 3, "samples": 9, "edge_length": 0.5, "noise": document["input"]["noise"]}
    assert document["input"]["noise"] >= 0.05 * 0.5
    assert document["parameters"]["l0"] == 30
    assert set(document["seconds"]) == {"read", "detect", *STAGES, "write"}
    assert document["seconds"]["blast"] == 1.5
    assert document["work"] == {"matches": 3}
    (step,) = document["transformations"]
    assert (step["id"], step["kind"], step["extent"]) == (3, "single", [[0, 1]])
    assert np.allclose(step["generators"], PLACES[1:])
    (template,) = document["templates"]
    assert (template["id"], template["transformation"], template["components"]) == (7, 3, [2, 4])
    assert np.allclose(template["occurrences"], PLACES)


def test_curves_stand_in_the_world_at_every_occurrence(completion, curves):
    rows = made(completion, curves)["curves"]
    assert [(r["kind"], r["template"], r["component"], r["occurrence"], r["support"]) for r in rows] == [
        ("template", 7, 4, 0, 1.0),
        ("template", 7, 2, 0, 0.5),
        ("template", 7, 4, 1, 0.25),
        ("template", 7, 2, 1, 0.0),
        ("strong", None, None, None, 1.0),
    ]
    assert [r["closed"] for r in rows] == [True, False, True, False, False]
    # A quarter turn about z takes (1, 1, 0) to (-1, 1, 0), then the shift.
    assert np.allclose(rows[2]["points"][2], [4, 1, 1])
    assert np.allclose(rows[4]["points"], ARC + 9)


def test_inputs_are_in_the_order_of_the_file(completion, curves):
    assert made(completion, curves)["inputs"] == [
        {"kind": "template", "transformation": 3, "component": 4},
        {"kind": "noise", "transformation": None, "component": None},
        {"kind": "strong", "transformation": None, "component": None},
    ]


def test_a_curve_that_was_cut_is_what_most_of_its_length_is(completion):
    long, short = ARC * 3, ARC
    pieces = Curves.from_list([short, long, short])
    pieces = Curves(pieces.points, pieces.offsets, pieces.closed, None, np.array([1, 1, 3]))
    classes = classes_of_inputs(completion.inputs, pieces, 5)
    assert classes.kind.tolist() == ["noise", "noise", "noise", "strong", "noise"]
    pieces = Curves.from_list([long, short, short])
    pieces = Curves(pieces.points, pieces.offsets, pieces.closed, None, np.array([0, 0, 1]))
    classes = classes_of_inputs(completion.inputs, pieces, 2)
    assert (classes.kind.tolist(), classes.component.tolist()) == (["template", "strong"], [4, -1])


def test_input_curves_without_a_length_are_counted(completion, curves):
    document = made(completion, curves, count=5, seconds={"read": 2.0})
    assert document["input"]["curves"] == len(document["inputs"]) == 5
    assert document["seconds"]["read"] == 2.0


def test_lengths_include_the_closing_edge(curves):
    assert lengths(curves) == pytest.approx([2 + 2**0.5, 2, 2])
    assert len(lengths(Curves.from_list([]))) == 0


def test_each_curve_is_there_as_primitives_too(completion, curves):
    rows = made(completion, curves)["curves"]
    for row in rows:
        assert row["primitives"] and row["deviation"] >= 0
        ends = [(np.array(p["start"]), np.array(p.get("end", p["start"]))) for p in row["primitives"]]
        assert all((a[1] == b[0]).all() for a, b in zip(ends, ends[1:]))
        if not row["closed"]:
            off = [np.linalg.norm(ends[0][0] - row["points"][0]), np.linalg.norm(ends[-1][1] - row["points"][-1])]
            assert max(off) <= 5 * 0.5
