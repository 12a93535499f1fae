# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line in this process: what it reads and writes, and what it makes of it."""

import dataclasses
import json
import os

import numpy as np
import pytest


def test_everything_it_can_write(folder, fcn, bpy):
    pytest.importorskip("matplotlib")
    names = ["--out", "r.blend", "--curves", "r.obj", "--report", "r.json", "--figure", "r.png"]
    code, said = fcn("in.obj", *names, "--edge-length", "0.1")
    assert code == 0, said
    assert sorted(os.listdir()) == ["in.obj", "r.blend", "r.json", "r.obj", "r.png"]
    report = json.loads((folder / "r.json").read_text())
    assert report["input"]["curves"] == len(report["inputs"]) == 4
    assert report["input"]["edge_length"] == 0.1
    assert [i["kind"] for i in report["inputs"]][:3] == ["template"] * 3
    assert (folder / "r.obj").read_text().count("\nl ") == len(report["curves"]) >= 3
    assert (folder / "r.png").read_bytes().startswith(b"\x89PNG")
    assert "4 curves" in said and "edge length 0.1 (as given)" in said and "wrote r.blend" in said
    bpy.ops.wm.open_mainfile(filepath=str(folder / "r.blend"))
    assert [c.name for c in bpy.context.scene.collection.children] == ["FCN in"]
    # As the panel would have made it: curves with handles, and a result that can be worked with.
    root = bpy.context.scene.collection.children[0]
    parts = [o for o in root.all_objects if "support" in o]
    assert parts and {s.type for o in parts for s in o.data.splines} == {"BEZIER"}
    result = root.fcn_result
    assert result.is_result and [row.name for row in result.template_rows][:1] == ["Template A"]
    places = len(report["templates"][0]["occurrences"])
    assert places > 2 and result.template_rows[0].count == places and result.edge_length == pytest.approx(0.1)
    item = next(o for o in parts if o["occurrence"] == 1 and o["template"] == report["templates"][0]["id"])
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    assert bpy.ops.fcn.reject_occurrence() == {"FINISHED"}
    assert root.fcn_result.template_rows[0].count == places - 1


def test_a_blend_file_in_gives_what_its_curves_give(folder, fcn, bpy):
    assert fcn("in.obj", "--out", "a.blend", "--report", "a.json", "--edge-length", "0.1", "--quiet") == (0, "")
    for chosen in (["--object", "Input"], ["--collection", "Input"], ["--object", "Input", "--collection", "Input"]):
        code, said = fcn("a.blend", *chosen, "--report", "b.json", "--edge-length", "0.1", "--quiet")
        assert code == 0, said
        a, b = (json.loads((folder / name).read_text()) for name in ("a.json", "b.json"))
        assert [i["kind"] for i in a["inputs"]] == [i["kind"] for i in b["inputs"]]
        assert len(a["curves"]) == len(b["curves"])


def test_parameters_by_name_with_either_sign(folder, fcn):
    for name in ("--delta-l", "--delta_l"):
        code, said = fcn(
            "in.obj", "--report", "r.json", "--edge-length", "0.1", name, "4", "--l0", "20", "--threads", "1"
        )
        assert code == 0, said
        parameters = json.loads((folder / "r.json").read_text())["parameters"]
        assert (parameters["delta_l"], parameters["l0"], parameters["threads"]) == (4, 20, 1)


def test_edge_length_of_a_surface_and_of_the_curves(folder, fcn):
    (folder / "scan.obj").write_text("v 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n")
    code, said = fcn("in.obj", "--surface", "scan.obj")
    assert code == 0 and f"edge length {(0.2 + 0.02**0.5) / 3:.4g} (mean edge of scan.obj)" in said
    code, said = fcn("in.obj")
    assert code == 0 and "estimated from the curves" in said


def test_help_explains_every_parameter_with_its_unit(part, capsys):
    fields = dataclasses.fields(part("core.parameters").Parameters)
    assert part("fcn_addon.command.run").main(["--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for f in fields:
        assert f"--{f.name.replace('_', '-')} " in text
        assert " ".join(f.metadata["help"].split()[:4]) in text
    assert "[edge lengths, default 25]" in text


def kinds(folder):
    return [row["kind"] for row in json.loads((folder / "r.json").read_text())["inputs"]]


def test_a_single_curve_is_strong_and_recurs_nowhere(folder, fcn, arcs):
    (folder / "in.obj").write_text(arcs(count=1, stray=False))
    assert fcn("in.obj", "--edge-length", "0.1", "--report", "r.json", "--quiet") == (0, "")
    assert kinds(folder) == ["strong"]


def test_curves_that_are_all_the_same_do_not_recur_where_they_are(folder, fcn):
    turn = np.linspace(0, 9, 120)
    spiral = np.exp(0.2 * turn)[:, None] * np.c_[np.cos(turn), np.sin(turn), 0.3 * turn]
    text = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in np.tile(spiral, (4, 1)).tolist()]
    text += ["l " + " ".join(str(120 * i + k + 1) for k in range(120)) for i in range(4)]
    (folder / "in.obj").write_text("\n".join(text))
    assert fcn("in.obj", "--edge-length", "0.3", "--report", "r.json", "--quiet") == (0, "")
    assert len(set(kinds(folder))) == 1
    for found in json.loads((folder / "r.json").read_text())["transformations"]:
        assert np.abs(np.array(found["generators"]) - np.eye(4)).max() > 0.3


def test_far_from_the_origin_the_result_is_the_same(folder, fcn, arcs):
    found = []
    for shift in (0.0, 1e7):
        (folder / "in.obj").write_text(arcs(shift=shift))
        assert fcn("in.obj", "--edge-length", "0.1", "--report", "r.json", "--quiet") == (0, "")
        found.append((kinds(folder), len(json.loads((folder / "r.json").read_text())["curves"])))
    assert found[0] == found[1]


def test_inputs_without_curves_are_passed_over_until_all_are(folder, fcn):
    (folder / "points.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (folder / "cloud.txt").write_text("0.1 0.2 0.3\n0.4 0.5 0.6\n")
    code, said = fcn("points.obj", "in.obj", "cloud.txt", "--edge-length", "0.1", "--report", "r.json")
    assert code == 0
    assert "passed over: points.obj: no `l` lines" in said and "passed over: cloud.txt: this is a point cloud" in said
    assert json.loads((folder / "r.json").read_text())["input"]["curves"] == 4
    code, said = fcn("points.obj", "cloud.txt")
    assert (code, said.count("\n")) == (2, 1)
    assert "no input has curves: points.obj: no `l`" in said and "cloud.txt: this is a point cloud" in said
    (folder / "cut.obj").write_text("v 0 0 0\nl 1 9\n")
    assert fcn("in.obj", "cut.obj")[0] == 2  # damage is no lack of curves


def test_the_written_curves_are_where_the_report_says_far_from_the_origin(folder, fcn, arcs, part):
    (folder / "in.obj").write_text(arcs(shift=5e6))
    assert fcn("in.obj", "--edge-length", "0.1", "--report", "r.json", "--curves", "r.obj", "--quiet") == (0, "")
    wanted = np.concatenate([c["points"] for c in json.loads((folder / "r.json").read_text())["curves"]])
    text = (folder / "r.obj").read_text().splitlines()
    found = np.array([line.split()[1:] for line in text if line.startswith("v ")], float)
    assert np.array_equal(found, wanted)
    pytest.importorskip("ezdxf")
    report = fcn("in.obj", "--edge-length", "0.1", "--report", "d.json", "--curves", "r.dxf", "--quiet")
    assert report == (0, "")
    pieces = [p for c in json.loads((folder / "d.json").read_text())["curves"] for p in c["primitives"]]
    ends = [p[end] for p in pieces if p["type"] != "circle" for end in ("start", "end")]
    drawn = part("core.files.formats").read_lines(folder / "r.dxf").curves.points
    far = [np.abs(drawn - p).max(axis=1).min() for p in ends]
    assert ends and max(far) < 1e-9 * max(np.ptp(wanted, axis=0).max(), 10.0)
