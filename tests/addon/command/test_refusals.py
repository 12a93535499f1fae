# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line refuses, how it says so, and that no file is left of a run that fails or is stopped."""

import os
import signal
import sys

import numpy as np
import pytest

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


def test_l0_that_is_longer_than_all_curves(folder, fcn):
    code, said = fcn("in.obj", "--edge-length", "0.1", "--l0", "5000", "--quiet")
    assert (code, said.count("\n")) == (2, 1) and "none is longer than l0 = 5000 edge lengths" in said


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


def test_a_disk_that_is_full_is_no_fault_of_the_program(folder, part):
    outputs, error = part("fcn_addon.command.outputs").Outputs, part("core.errors").InputError
    with pytest.raises(error, match=r"r.json: cannot be written \(No space left on device\)"):
        with outputs(["r.json"]) as names:
            with open("/dev/full" if sys.platform == "linux" else names.part("r.json"), "w") as file:
                if sys.platform != "linux":
                    raise OSError(28, "No space left on device")
                file.write("x" * 100000)
    assert os.listdir() == ["in.obj"]
