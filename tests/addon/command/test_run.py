# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line in this process: what it reads, writes, says, and its exit codes."""

import dataclasses
import io
import json
import os
import signal
import sys
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def folder(tmp_path, monkeypatch, arcs):
    """The current folder, with one input in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.obj").write_text(arcs())
    return tmp_path


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


CASES = [
    ([], "INPUT"),
    (["no.obj"], "no.obj: no such file"),
    (["no.blend"], "no.blend: no such file"),
    (["bad.blend"], "bad.blend: Blender cannot open it"),
    (["empty.obj"], "empty.obj: the file is empty"),
    (["cut.obj"], "cut.obj: line 2: index 9 has no point"),
    (["garbage.obj"], "garbage.obj: this is binary data"),
    (["garbage.ply"], "garbage.ply: no PLY header"),
    (["garbage.txt"], "garbage.txt: this is binary data"),
    (["nan.obj"], "nan.obj: line 2: 'nan' is not finite"),
    (["in.xyz"], "a .xyz file cannot be read; give one of .abc, .blend, .cgal, .dae, .dxf, .fbx, .glb"),
    (["in.obj", "--l0", "x"], "--l0: 'x' is not a number"),
    (["in.obj", "--l0", "1"], "l0 is 1.0: give a number of at least 4 (edge lengths)"),
    (["in.obj", "--l0", "nan"], "l0 is nan"),
    (["in.obj", "--threads", "1.5"], "--threads: '1.5' is not a whole number"),
    (["in.obj", "--s", "3"], "t must not be below s"),
    (["in.obj", "--edge-length", "0"], "0 is no length"),
    (["in.obj", "--edge-length=-1"], "-1 is no length"),
    (["in.obj", "--edge-length", "1", "--surface", "in.obj"], "not allowed with"),
    (["in.obj", "--surface", "in.obj"], "in.obj: no faces"),
    (["in.obj", "--bogus"], "unrecognized arguments: --bogus"),
    (["in.obj", "--object", "X"], "chooses from a .blend"),
    (["in.obj", "--out", "r.obj"], "r.obj: --out writes a .blend file"),
    (["in.obj", "--report", "no/r.json"], "no/r.json: cannot be written (No such file or directory)"),
    (["in.obj", "--report", "dir.json"], "dir.json: cannot be written, it is a folder"),
    (["in.obj", "--curves", "in.obj"], "in.obj: this is also an input"),
    (["in.obj", "--report", "r.json", "--figure", "r.json"], "r.json: two outputs have this name"),
]


@pytest.mark.parametrize(("arguments", "message"), CASES, ids=[" ".join(c[0]) or "nothing" for c in CASES])
def test_wrong_input_is_one_line_exit_code_2_and_no_file(folder, fcn, arguments, message):
    (folder / "empty.obj").write_text("")
    (folder / "cut.obj").write_text("v 0 0 0\nl 1 9\n")
    (folder / "nan.obj").write_text("v 0 0 0\nv nan 0 0\nl 1 2\n")
    (folder / "dir.json").mkdir()
    garbage = np.random.default_rng(0).bytes(3000) + b"\0"
    for name in ("garbage.obj", "garbage.ply", "garbage.txt", "bad.blend"):
        (folder / name).write_bytes(garbage)
    before = sorted(os.listdir())
    code, said = fcn(*arguments)
    assert code == 2
    assert said.startswith("error: ") and said.count("\n") == 1
    assert message in said
    assert sorted(os.listdir()) == before


def test_names_that_a_blend_file_does_not_have(folder, fcn, bpy):
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "a.blend"), copy=True)
    for arguments, message in [
        (["--object", "Q"], "a.blend: no object 'Q'"),
        (["--collection", "Q"], "a.blend: no collection 'Q'"),
        ([], "a.blend: the scene shows no curves and no faces"),
    ]:
        code, said = fcn("a.blend", *arguments)
        assert (code, said.count("\n")) == (2, 1) and message in said


def kinds(folder):
    return [row["kind"] for row in json.loads((folder / "r.json").read_text())["inputs"]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n", "the longest has 20.0; try l0 = 10"),
        ("v 0 0 0\nv .1 0 0\nl 1 2\n", "no curve is strong"),
    ],
)
def test_no_strong_curve_suggests_l0(folder, fcn, text, message):
    (folder / "weak.obj").write_text(text)
    code, said = fcn("weak.obj", "--edge-length", "0.1", "--report", "r.json", "--quiet")
    assert (code, said.count("\n")) == (2, 1) and message in said and "l0" in said
    assert not (folder / "r.json").exists()


@pytest.mark.parametrize("length", [0.2, 0.5, 0.9, 2.0])
def test_the_advice_works_when_it_is_tried(folder, fcn, length):
    (folder / "weak.obj").write_text(f"v 0 0 0\nv {length / 2} 0 0\nv {length} 0 0\nl 1 2 3\n")
    code, said = fcn("weak.obj", "--edge-length", "0.1")
    assert code == 2
    edge_length = said.partition("an edge length of ")[2].split()[0]
    assert fcn("weak.obj", "--edge-length", edge_length)[0] == 0
    assert ("try l0" in said) == (length > 0.4)
    if "try l0" in said:
        assert fcn("weak.obj", "--edge-length", "0.1", "--l0", said.partition("try l0 = ")[2].split(",")[0])[0] == 0


def test_an_edge_length_from_drawn_lines_is_said_to_be_coarse(folder, fcn):
    (folder / "in.obj").write_text(as_obj(window_row(2), joined=True))
    said = fcn("in.obj")[1]
    assert "edge length 0.05112 (coarse: taken for a drawing, a fiftieth of a typical outline," in said
    assert "which measures 2.56; --edge-length or --surface set it)" in said


def test_l0_that_is_longer_than_all_curves(folder, fcn):
    code, said = fcn("in.obj", "--edge-length", "0.1", "--l0", "5000", "--quiet")
    assert (code, said.count("\n")) == (2, 1) and "none is longer than l0 = 5000 edge lengths" in said


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


def test_an_earlier_result_stays_when_the_run_fails(folder, fcn):
    (folder / "r.json").write_text("earlier")
    (folder / "bad.obj").write_text("v 0 0 0\nl 1 9\n")
    assert fcn("bad.obj", "--report", "r.json")[0] == 2
    assert (folder / "r.json").read_text() == "earlier"


@pytest.mark.parametrize("mode", [0o500, 0o000])
def test_a_folder_that_may_not_be_written(folder, fcn, mode):
    if not hasattr(os, "geteuid"):
        pytest.skip("users are another thing here")
    locked = folder / "locked"
    locked.mkdir(mode)
    root = os.geteuid() == 0
    try:
        if root:  # who may write everywhere
            os.seteuid(65534)
        code, said = fcn("in.obj", "--report", locked / "r.json")
    finally:
        if root:
            os.seteuid(0)
    assert code == 2 and said.endswith("cannot be written (Permission denied); check the folder\n")


def test_ctrl_c_stops_with_130_and_no_file(folder, fcn, part, monkeypatch):
    terminal, seen = part("fcn_addon.command.terminal").Terminal, []

    def press(self, stage, fraction):
        seen.append(sorted(p.name for p in folder.iterdir()))
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(terminal, "progress", press)
    before = signal.getsignal(signal.SIGINT)
    code, said = fcn("in.obj", "--report", "r.json", "--quiet")
    assert (code, said) == (130, "error: stopped, nothing was written\n")
    assert seen == [[f".r.{os.getpid()}.part.json", "in.obj"]]  # it was on its way
    assert os.listdir() == ["in.obj"]
    assert signal.getsignal(signal.SIGINT) is before


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def test_progress_in_a_log_is_a_line_a_tenth_with_the_time_left(part):
    clock, stream = Clock(), io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(stream=stream, clock=clock)
    for i in range(101):
        clock.now = i * 1.0
        terminal.progress("blast", i / 100)
    lines = stream.getvalue().splitlines()
    assert len(lines) == 11
    assert lines[2].split() == ["blast", "20%", "1", "min", "20", "s", "left"]
    assert lines[-1].split() == ["blast", "100%", "1", "min", "40", "s"]


def test_progress_of_a_short_stage_is_one_line_in_a_log(part):
    stream = io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(stream=stream, clock=Clock())
    for stage in ("blast", "seeding"):
        for i in range(11):
            terminal.progress(stage, i / 10)
    assert [line.split()[:2] for line in stream.getvalue().splitlines()[1:]] == [["blast", "100%"], ["seeding", "100%"]]


def test_quiet_says_errors_only(part):
    stream = io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(quiet=True, stream=stream)
    terminal.say("a")
    terminal.progress("blast", 0.5)
    terminal.error("b\nc")
    assert stream.getvalue() == "error: b c\n"


def test_a_disk_that_is_full_is_no_fault_of_the_program(folder, part):
    outputs, error = part("fcn_addon.command.outputs").Outputs, part("core.errors").InputError
    with pytest.raises(error, match=r"r.json: cannot be written \(No space left on device\)"):
        with outputs(["r.json"]) as names:
            with open("/dev/full" if sys.platform == "linux" else names.part("r.json"), "w") as file:
                if sys.platform != "linux":
                    raise OSError(28, "No space left on device")
                file.write("x" * 100000)
    assert os.listdir() == ["in.obj"]


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
    assert fcn("in.dxf", "--report", "r.json", "--curves", "r.dxf", "--quiet") == (0, "")
    made = ezdxf.readfile(folder / "r.dxf")
    assert not made.audit().errors and made.units == 4
    assert len(made.modelspace().query("INSERT")) == sum(places(folder / "r.json")) == 3
    assert fcn("in.dxf", "--curves", "r.svg", "--quiet") == (0, "")
    assert (folder / "r.svg").read_text().count("<use ") == 3
    # what was written is read: the same curves at the same places
    assert fcn("r.dxf", "--report", "again.json", "--quiet") == (0, "")
    assert places(folder / "again.json") == [3]


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


@pytest.mark.skipif(not CASES_FOLDER.exists(), reason="the cases are not here")
@pytest.mark.parametrize("name", ["cad_lines.obj", "mixed.obj", "row.polylines.txt"])
def test_cases_of_a_row_of_windows(folder, fcn, name):
    code, said = fcn(CASES_FOLDER / name, "--report", "r.json", "--quiet")
    assert (code, said) == (0, "") and places(folder / "r.json") == [6]
