# SPDX-License-Identifier: GPL-3.0-or-later
"""run.py as a program of its own, in a plain Python and with Blender's module."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent.parent


def run(*arguments, blocked=(), cwd=None):
    """Exit code, stdout and stderr of `python run.py arguments`; imports of `blocked` fail."""
    begin = "".join(f"sys.modules[{name!r}] = None; " for name in blocked)
    program = f"import sys, runpy; {begin}sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
    command = [sys.executable, "-c", program, str(ROOT / "run.py"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=300)
    return done.returncode, done.stdout, done.stderr


def test_text_in_and_text_out_need_no_blender(tmp_path, arcs):
    (tmp_path / "in.obj").write_text(arcs())
    code, _, said = run("in.obj", "--report", "r.json", "--curves", "r.obj", "--quiet", blocked=["bpy"], cwd=tmp_path)
    assert (code, said) == (0, "")
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["templates"]
    assert sorted(os.listdir(tmp_path)) == ["in.obj", "r.json", "r.obj"]


def test_with_blenders_module_a_blend_file_is_written(tmp_path, arcs):
    (tmp_path / "in.obj").write_text(arcs())
    code, _, said = run("in.obj", "--out", "r.blend", "--quiet", cwd=tmp_path)
    assert (code, said) == (0, "")
    assert sorted(os.listdir(tmp_path)) == ["in.obj", "r.blend"]


@pytest.mark.parametrize(
    ("arguments", "blocked", "message"),
    [
        (["no.obj"], [], "error: no.obj: no such file; check the path\n"),
        (["no.obj", "--out", "r.blend"], ["bpy"], "error: a .blend file needs Blender: use `blender -b -P run.py"),
        (["no.blend"], ["bpy"], "error: a .blend file needs Blender"),
        (["no.obj", "--figure", "r.png"], ["matplotlib"], "error: --figure needs matplotlib: `pip install matplotlib`"),
        (["no.obj"], ["numpy"], "error: numpy is missing: `pip install numpy scipy` gets both\n"),
    ],
)
def test_what_is_missing_is_said_in_one_line(tmp_path, arguments, blocked, message):
    code, _, said = run(*arguments, blocked=blocked, cwd=tmp_path)
    assert code == 2
    assert said.startswith(message) and said.count("\n") == 1
    assert not os.listdir(tmp_path)


def test_help_needs_no_blender():
    code, out, _ = run("--help", blocked=["bpy", "matplotlib"])
    assert code == 0 and "--l0" in out
