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


def project_modules():
    return {path: dotted(path) for room in ROOMS for path in modules(room)}


# The rooms of the bridge, from the ground up; modules beside them are the ground, but for the roof.
BRIDGE = {
    "scene": set(),
    "reading": {"scene"},
    "detected": {"scene"},
    "result": {"scene", "reading", "detected"},
    "properties": {"detected", "result"},
    "exchange": {"scene", "detected", "result"},
    "command": {"scene", "reading", "detected", "result"},
    "job": {"scene", "reading", "detected", "result", "properties"},
}
ROOF = {"handlers"}


@pytest.mark.parametrize("room", [*BRIDGE, "the ground"])
def test_imports_go_down_only_inside_the_bridge(room):
    folder = ROOT / "fcn_addon"
    paths = (folder / room).rglob("*.py") if room in BRIDGE else folder.glob("*.py")
    above = {*BRIDGE, *ROOF} - {room} - BRIDGE.get(room, set())
    wrong = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in paths
        for name in imported(path)
        if path.stem not in ROOF and name.startswith("fcn_addon.") and name.split(".")[1] in above
    ]
    assert not wrong


@pytest.mark.parametrize("room", BRIDGE)
def test_a_room_of_the_bridge_holds_nine_modules_at_most(room):
    assert 2 <= len([p for p in (ROOT / "fcn_addon" / room).glob("*.py") if p.stem != "__init__"]) <= 9


def dotted(path):
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imported_modules():
    """Module -> the modules of the project that it imports, also inside functions; of a package only what is meant."""
    names = project_modules()
    known = set(names.values())
    graph = {}
    for path, name in names.items():
        wanted = {full if full in known else full.rpartition(".")[0] for full in imported(path)}
        graph[name] = (wanted & known) - {name}
    return graph


def circles(graph):
    """Sets of nodes that reach each other, of two and more."""
    reach = {}
    for start in graph:
        seen, front = set(), [start]
        while front:
            for node in graph[front.pop()]:
                if node not in seen:
                    seen.add(node)
                    front.append(node)
        reach[start] = seen
    return {frozenset(b for b in reach[a] if a in reach[b]) for a in graph if a in reach[a]}


def test_circles_are_found():
    graph = {"a": {"b"}, "b": {"c", "d"}, "c": {"b"}, "d": set(), "e": {"a"}}
    assert circles(graph) == {frozenset({"b", "c"})}


def test_no_modules_import_each_other_in_a_circle():
    assert [sorted(circle) for circle in circles(imported_modules())] == []


# Of the core, what is longer for now, and is to become shorter.
LONG = {"description", "tensor"}


def test_no_module_is_longer_than_300_lines():
    long = [path for path in project_modules() if len(path.read_text(encoding="utf-8").splitlines()) > 300]
    assert not [dotted(path) for path in long if path.parts[len(ROOT.parts)] != "core" or path.stem not in LONG]


def test_the_core_imports_numpy_and_scipy_only():
    allowed = {"core", "numpy", "scipy", *sys.stdlib_module_names}
    names = "readers/dxf.py", "readers/dxf_held.py", "readers/dxf_space.py", "writers/dxf.py"
    drawings = {ROOT / "core" / "files" / name for name in names}
    wrong = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in modules("core")
        for name in imported(path)
        if name.partition(".")[0] not in allowed | ({"ezdxf"} if path in drawings else set())
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


@pytest.mark.parametrize(
    "name",
    [
        "command/run",
        "command/arguments",
        "command/outputs",
        "command/terminal",
        "command/writing",
        "wording",
        "colours",
    ],
)
def test_the_command_line_needs_no_blender_until_a_blend_file_is_used(name):
    tree = ast.parse((ROOT / "fcn_addon" / f"{name}.py").read_text(encoding="utf-8"))
    top = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    names = {alias.name for node in top if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in top if isinstance(node, ast.ImportFrom) and node.module}
    assert not {n.partition(".")[0] for n in names} & BLENDER
    assert not names & {"blend_file"} and not any(
        n.startswith(("scene", "reading", "result", "detected")) for n in names
    )


def test_every_source_file_says_its_licence():
    files = [p for room in (*ROOMS, "tests", "benchmarks", "examples", ".ci") for p in (ROOT / room).rglob("*.py")]
    wrong = [
        str(p)
        for p in [*files, *ROOT.glob("*.py")]
        if p.stat().st_size and "GPL-3.0-or-later" not in p.read_text()[:80]
    ]
    assert not wrong
