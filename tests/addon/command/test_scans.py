# SPDX-License-Identifier: GPL-3.0-or-later
"""Scans on the command line: detected first, then completed; what is taken of a file that has both."""

import json
import os

import numpy as np
import pytest

KINDS = ("ridge", "valley", "sharp", "boundary")


def ply(points, faces, edges=()):
    rows = ["ply", "format ascii 1.0", f"element vertex {len(points)}"]
    rows += [f"property float {c}" for c in "xyz"]
    rows += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
    rows += [f"element edge {len(edges)}", "property int vertex1", "property int vertex2", "end_header"]
    for values in (points, [[len(f), *f] for f in faces], edges):
        rows += [" ".join(f"{v:.6g}" for v in row) for row in values]
    return "\n".join(rows) + "\n"


@pytest.fixture
def folder(tmp_path, monkeypatch, bumps):
    """The current folder, with one scan in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scan.ply").write_text(ply(*bumps()))
    return tmp_path


def load(name):
    with open(name, encoding="utf-8") as file:
        return json.load(file)


def test_a_scan_is_all_it_needs(folder, fcn, bpy):
    code, said = fcn("scan.ply", "--out", "r.blend", "--report", "r.json")
    assert code == 0, said
    stages = [line.split()[0] for line in said.splitlines() if "100%" in line]
    assert stages[:4] == ["mesh", "curvature", "lines", "blast"]
    report = load("r.json")
    (scan,) = report["detection"]["scans"]
    assert report["seconds"]["detect"] > 0
    assert report["input"]["edge_length"] == scan["edge_length"]
    assert report["input"]["curves"] == scan["curves"] == len(report["inputs"]) >= 3
    assert report["detection"]["parameters"]["ridges"] is True
    assert "template" in {row["kind"] for row in report["inputs"]}  # the bumps recur
    bpy.ops.wm.open_mainfile(filepath=str(folder / "r.blend"))
    assert [c.name for c in bpy.context.scene.collection.children] == ["FCN scan"]


def test_curves_alone_with_their_attributes(folder, fcn, bpy):
    code, said = fcn(
        "scan.ply", "--detect-only", "--out", "d.blend", "--curves", "d.obj", "--report", "d.json", "--no-valleys",
        "--boundary",
    )  # fmt: skip
    assert code == 0, said
    report = load("d.json")
    assert report["schema"] == "fcn-detection/1"
    assert {c["kind"] for c in report["curves"]} == {"ridge", "boundary"}
    assert set(report["seconds"]) == {"read", "detect", "write"}
    assert (folder / "d.obj").read_text().count("\nl ") == len(report["curves"]) == report["scans"][0]["curves"]
    for name in ("d.dxf", "d.svg"):
        assert fcn("scan.ply", "--detect-only", "--curves", name, "--no-valleys", "--boundary", "--quiet") == (0, "")
    ezdxf = pytest.importorskip("ezdxf")
    drawn = ezdxf.readfile(folder / "d.dxf").modelspace()
    assert len(drawn) == len(report["curves"]) and {e.dxf.layer for e in drawn} == {"ridge", "boundary"}
    assert (folder / "d.svg").read_text().count("<path ") == len(report["curves"])
    bpy.ops.wm.open_mainfile(filepath=str(folder / "d.blend"))
    (item,) = bpy.context.scene.objects
    mesh = item.data
    assert (item.name, item["edge_length"]) == ("scan curves", report["scans"][0]["edge_length"])
    points = np.concatenate([c["points"] for c in report["curves"]])
    assert np.allclose(points, [item.matrix_world @ v.co for v in mesh.vertices], atol=1e-5)
    for name, expected in (
        ("curvature", np.concatenate([c["strength"] for c in report["curves"]])),
        ("kind", np.concatenate([[KINDS.index(c["kind"])] * len(c["points"]) for c in report["curves"]])),
    ):
        values = np.empty(len(mesh.vertices), np.float32 if name == "curvature" else np.int32)
        mesh.attributes[name].data.foreach_get("value", values)
        assert np.allclose(values, expected, rtol=1e-5)


def test_detected_curves_complete_as_the_scan_does(folder, fcn):
    assert fcn("scan.ply", "--report", "a.json", "--quiet") == (0, "")
    assert fcn("scan.ply", "--detect-only", "--out", "d.blend", "--quiet") == (0, "")
    code, said = fcn("d.blend", "--report", "b.json")
    assert code == 0 and "(mean edge of the scan)" in said
    a, b = load("a.json"), load("b.json")
    assert b["input"]["edge_length"] == pytest.approx(a["input"]["edge_length"])
    assert [t["kind"] for t in a["transformations"]] == [t["kind"] for t in b["transformations"]]
    assert len(a["curves"]) == len(b["curves"])


def test_the_parameters_of_detection_are_taken(folder, fcn):
    lengths = []
    for detail in ("0.7", "2"):
        code, said = fcn("scan.ply", "--detect-only", "--detail", detail, "--min_length", "30", "--report", "d.json")
        assert code == 0, said
        report = load("d.json")
        assert report["parameters"]["detail"] == report["scans"][0]["detail"] == float(detail)
        assert min(c["length"] for c in report["curves"]) >= 30 * report["scans"][0]["edge_length"]
        lengths.append(report["scans"][0]["length"])
    assert lengths[0] != lengths[1]


def test_a_scan_of_a_blend_in_the_world(folder, fcn, bpy, bumps):
    points, faces = bumps()
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    item = bpy.data.objects.new("Scan", mesh)
    item.location, item.scale = (100, 0, 0), (2, 2, 2)
    bpy.context.scene.collection.objects.link(item)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "a.blend"), copy=True)
    assert fcn("a.blend", "--detect-only", "--report", "a.json", "--quiet") == (0, "")
    assert fcn("scan.ply", "--detect-only", "--report", "b.json", "--quiet") == (0, "")
    a, b = load("a.json"), load("b.json")
    assert a["scans"][0]["edge_length"] == pytest.approx(2 * b["scans"][0]["edge_length"], rel=1e-4)
    assert min(p[0] for c in a["curves"] for p in c["points"]) > 99
    assert a["scans"][0]["length"] == pytest.approx(2 * b["scans"][0]["length"], rel=0.02)


def test_of_a_blend_with_both_the_curves_are_taken_unless_the_scan_is_named(folder, fcn, bpy, bumps, wall):
    points, faces = bumps()
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Scan", mesh))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "a.blend"), copy=True)
    code, said = fcn("a.blend", "--edge-length", "1")
    assert "left out: 1 mesh with faces ('Scan'); name a scan with --object" in said
    code, said = fcn("a.blend", "--object", "Scan", "--detect-only")
    assert code == 0 and "a.blend: object 'Scan':" in said


def test_of_a_file_with_faces_and_edges_it_is_said_what_is_taken(folder, fcn, bumps, arcs):
    (folder / "both.ply").write_text(ply(*bumps(), edges=[(0, 1), (1, 2)]))
    code, said = fcn("both.ply", "--detect-only")
    assert code == 0 and "it is taken as a scan, its edges are left out; --take-edges takes them" in said
    (folder / "both.obj").write_text(arcs() + "f 1 2 3\n")
    code, said = fcn("both.obj", "--take-edges", "--edge-length", "0.1")
    assert code == 0 and "both.obj has faces and edges: the edges are taken" in said and "4 curves" in said


CASES = [
    (["points.ply"], "points.ply: it has points only"),
    (["points.obj"], "points.obj: no `l` lines"),
    (["nan.ply"], "nan.ply: vertex 1"),
    (["flat.ply"], "flat.ply: all faces have zero area"),
    (["index.ply"], "index.ply: face 0: index 9 has no point"),
    (["cut.ply"], "cut.ply: the file was cut off"),
    (["empty.stl"], "empty.stl: the file is empty"),
    (["garbage.glb"], "garbage.glb: Blender cannot import it"),
    (["plane.ply"], "plane.ply: no feature curve is found; lower strong_fold"),
    (["scan.ply", "--no-ridges", "--no-valleys"], "no kind of feature curve is asked for"),
    (["scan.ply", "--detail", "-1"], "detail is -1.0: give a number from 0 to 20 (edge lengths)"),
    (["scan.ply", "--weak-fold", "30"], "weak_fold is 30: give at most strong_fold, 20"),
    (["scan.ply", "lines.obj", "--detect-only"], "--detect-only is for scans"),
    (["scan.ply", "--take-edges"], "no edges or lines of its own"),
    (["scan.ply", "--out", "scan.ply"], "--out writes a .blend file"),
    (["scan.ply", "--l0", "5000"], "none is longer than l0 = 5000"),
]


@pytest.mark.parametrize(("arguments", "message"), CASES, ids=[" ".join(c[0]) for c in CASES])
def test_bad_scans_are_one_line_exit_code_2_and_no_file(folder, fcn, arguments, message):
    square = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    (folder / "points.ply").write_text(ply(square, []))
    (folder / "points.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (folder / "nan.ply").write_text(ply([(0, 0, 0), (float("nan"), 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    (folder / "flat.ply").write_text(ply([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]))
    (folder / "index.ply").write_text(ply(square, [(0, 1, 9)]))
    (folder / "cut.ply").write_text(ply(square, [(0, 1, 2)] * 9)[:-12])
    (folder / "empty.stl").write_text("")
    (folder / "garbage.glb").write_bytes(np.random.default_rng(0).bytes(3000))
    (folder / "plane.ply").write_text(ply(square, [(0, 1, 2)]))
    (folder / "lines.obj").write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
    before = sorted(os.listdir())
    code, said = fcn(*arguments, "--report", "r.json", "--quiet")
    assert code == 2
    assert said.startswith("error: ") and said.count("\n") == 1
    assert message in said
    assert sorted(os.listdir()) == before


def test_help_explains_detection(part, capsys):
    assert part("fcn_addon.command.run").main(["--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for words in ("--detail N", "--detect-only", "--no-ridges", "--boundary", "--strong-fold", "[degrees, default 20]"):
        assert words in text
