# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports go down only, and the core needs no Blender."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("core", "fcn_addon", "operators", "ui")

# What each room may import of the project; a room may always import itself.
MAY = {
    "core": set(),
    "fcn_addon": {"core"},
    "operators": {"core", "fcn_addon"},
    "ui": {"core", "fcn_addon"},
}
BLENDER = {"bpy", "mathutils", "bmesh", "gpu", "gpu_extras", "bpy_extras", "blf", "bl_ui", "addon_utils"}


def modules(room):
    return sorted((ROOT / room).rglob("*.py"))


def imported(path):
    """Absolute dotted names of all imports in a file, wherever in it they stand; ours begin with a room."""
    package = path.relative_to(ROOT).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            assert not node.level or node.level <= len(package) + 1, f"{path}: an import above the root"
            stem = [*base, *([node.module] if node.module else [])]
            yield from (".".join([*stem, alias.name]) for alias in node.names)


@pytest.mark.parametrize("room", ROOMS)
def test_imports_go_down_only(room):
    wrong = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in modules(room)
        for name in imported(path)
        if name.partition(".")[0] in {*ROOMS, "benchmarks", "tests", "examples"} - {room} - MAY[room]
    ]
    assert not wrong


def test_the_core_imports_numpy_and_scipy_only():
    allowed = {"core", "numpy", "scipy", *sys.stdlib_module_names}
    wrong = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in modules("core")
        for name in imported(path)
        if name.partition(".")[0] not in allowed
    ]
    assert not wrong


def test_the_root_imports_nothing_at_module_level():
    body = ast.parse((ROOT / "__init__.py").read_text(encoding="utf-8")).body
    assert not [node for node in body if isinstance(node, ast.Import | ast.ImportFrom)]


def test_every_core_module_imports_without_blender():
    names = [".".join(p.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for p in modules("core")]
    assert "core.values" in names and len(names) > 10
    program = f"""
import importlib, sys
for name in {sorted(BLENDER)!r}:
    sys.modules[name] = None
for name in {names!r}:
    importlib.import_module(name)
"""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", ["command_line", "arguments", "outputs", "terminal", "wording", "colours"])
def test_the_command_line_needs_no_blender_until_a_blend_file_is_used(name):
    tree = ast.parse((ROOT / "fcn_addon" / f"{name}.py").read_text(encoding="utf-8"))
    top = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    names = {alias.name for node in top if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in top if isinstance(node, ast.ImportFrom) and node.module}
    assert not {n.partition(".")[0] for n in names} & BLENDER
    assert not names & {"blend_file", "scene_reader", "scene_writer"}


def test_every_source_file_says_its_licence():
    files = [p for room in (*ROOMS, "tests", "benchmarks", "examples", ".ci") for p in (ROOT / room).rglob("*.py")]
    wrong = [
        str(p)
        for p in [*files, *ROOT.glob("*.py")]
        if p.stat().st_size and "GPL-3.0-or-later" not in p.read_text()[:80]
    ]
    assert not wrong
