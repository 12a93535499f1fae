# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawings on the command line: a row of windows, drawn line by line."""

import json
from pathlib import Path

import numpy as np
import pytest

CASES_FOLDER = Path(__file__).resolve().parents[4] / "shared" / "cases" / "files"


def window_row(count=6):
    """(k, 2, 3) segments of a row of windows, as a drawing program has them: corner to corner."""
    t = np.linspace(0, np.pi, 9)
    outline = [(-0.8, 2.2), (-0.8, 0), (0.8, 0), (0.8, 2.2), *zip(0.8 * np.cos(t)[1:], 2.2 + 0.8 * np.sin(t)[1:])]
    inner = [(-0.4, 0.2), (-0.4, 1.76), (0.16, 2.09), (0.56, 1.1), (0.56, 0.2)]
    out = []
    for i in range(count):
        for line in (outline, inner):
            for (a, b), (c, d) in zip(line[:-1], line[1:]):
                out.append([(a + 2.7 * i, 0, b), (c + 2.7 * i, 0, d)])
    return np.array(out)


def as_obj(segments, joined):
    rows, known, lines = [], {}, []
    for segment in np.round(segments, 6).tolist():
        index = []
        for point in map(tuple, segment):
            if not joined or point not in known:
                rows.append("v {} {} {}".format(*point))
                known[point] = len(rows)
            index.append(known[point])
        lines.append("l {} {}".format(*index))
    return "\n".join([*rows, *lines]) + "\n"


def places(path):
    return [len(t["occurrences"]) for t in json.loads(path.read_text())["templates"]]


def test_an_edge_length_from_drawn_lines_is_said_to_be_coarse(folder, fcn):
    (folder / "in.obj").write_text(as_obj(window_row(2), joined=True))
    said = fcn("in.obj")[1]
    assert "edge length 0.05112 (coarse: taken for a drawing, a fiftieth of a typical outline," in said
    assert "which measures 2.56; --edge-length or --surface set it)" in said


def test_lines_with_points_of_their_own_give_what_joined_ones_give(folder, fcn):
    segments = window_row(3)
    reports = []
    for joined in (True, False):
        (folder / "in.obj").write_text(as_obj(segments, joined))
        assert fcn("in.obj", "--report", "r.json", "--quiet") == (0, "")
        assert places(folder / "r.json") == [3]
        report = json.loads((folder / "r.json").read_text())
        reports.append([(i["kind"], i["component"]) for i in report["inputs"]])
    assert reports[0] == reports[1] and len(reports[0]) == 6


def test_weld_says_how_near_ends_are_one(folder, fcn):
    segments = window_row(3) + np.random.default_rng(0).uniform(-0.01, 0.01, (1, 1, 1))
    segments[::2, 1, 1] += 0.015  # every second line ends beside the next one
    (folder / "in.obj").write_text(as_obj(segments, joined=False))
    code, said = fcn("in.obj", "--edge-length", "0.064", "--weld", "0.3", "--report", "r.json")
    assert code == 0 and said.startswith("6 curves, 48 points") and places(folder / "r.json") == [3]
    assert not fcn("in.obj", "--edge-length", "0.2", "--weld", "0.07")[1].startswith("6 curves")
    assert fcn("in.obj", "--weld=-1")[0] == 2


def test_a_drawing_in_and_a_drawing_out(folder, fcn):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=4)
    for a, b in window_row(3).tolist():
        document.modelspace().add_line(a, b)
    document.saveas(folder / "in.dxf")
    code, said = fcn("in.dxf", "--report", "r.json", "--curves", "r.dxf")
    assert code == 0 and "edge length 0.05112 mm (coarse" in said
    made = ezdxf.readfile(folder / "r.dxf")
    assert not made.audit().errors and made.units == 4
    assert len(made.modelspace().query("INSERT")) == sum(places(folder / "r.json")) == 3
    assert fcn("in.dxf", "--curves", "r.svg", "--quiet") == (0, "")
    assert (folder / "r.svg").read_text().count("<use ") == 3
    # what was written is read: the same curves at the same places
    assert fcn("r.dxf", "--report", "again.json", "--quiet") == (0, "")
    assert places(folder / "again.json") == [3]


@pytest.mark.skipif(not CASES_FOLDER.exists(), reason="the cases are not here")
@pytest.mark.parametrize("name", ["cad_lines.obj", "mixed.obj", "row.polylines.txt"])
def test_cases_of_a_row_of_windows(folder, fcn, name):
    code, said = fcn(CASES_FOLDER / name, "--report", "r.json", "--quiet")
    assert (code, said) == (0, "") and places(folder / "r.json") == [6]
