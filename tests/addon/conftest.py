# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as Blender loads it: the project's folder linked into a fresh extensions folder, and enabled.

These tests never import `core` or `fcn_addon` directly: their modules are those of the loaded extension.
"""

import importlib
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
NAME = "bl_ext.user_default.fcn_addon"

# Blender reads this when bpy is imported, which must therefore not be before.
_resources = tempfile.mkdtemp(prefix="fcn-tests-")
os.environ["BLENDER_USER_RESOURCES"] = _resources


@pytest.fixture(scope="session", autouse=True)
def extension():
    """The name of the enabled extension's root package."""
    reason = "these tests need Blender as a module (pip install bpy) and the libraries that it links to"
    pytest.importorskip("bpy", reason=reason, exc_type=ImportError)
    import addon_utils

    home = Path(_resources) / "extensions" / "user_default"
    home.mkdir(parents=True)
    (home / "fcn_addon").symlink_to(ROOT, target_is_directory=True)
    faults = []
    addon_utils.enable(NAME, default_set=True, handle_error=faults.append)
    assert not faults, faults
    yield NAME
    # What is still registered when the process ends brings some versions down.
    addon_utils.disable(NAME, default_set=True)
    shutil.rmtree(_resources, ignore_errors=True)


@pytest.fixture
def part(extension):
    """Import a module of the extension: part("fcn_addon.result.writer")."""
    return lambda name: importlib.import_module(f"{extension}.{name}")


@pytest.fixture
def bpy(extension):
    """bpy with an empty scene and the extension enabled."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy


@pytest.fixture
def completion(part):
    """A small completion made by hand: a template of two curves at 3 x 2 places, one strong curve."""
    values = part("core.values")
    steps = np.array([np.eye(4), np.eye(4)])
    steps[0, 0, 3], steps[1, 2, 3] = 1.8, 2.4
    grid = values.Transformation(5, "grid", steps, np.array([[0, 2], [0, 1]]), 40.0, 0.4)
    angle = np.linspace(0, np.pi, 9)
    arch = np.c_[np.cos(angle), np.zeros(9), np.sin(angle)] + [100, 0, 0]
    ring = np.c_[np.cos(2 * angle[:-1]), np.zeros(8), np.sin(2 * angle[:-1])] / 4 + [100, 0, 1]
    parts = (values.CompletedCurve(arch, False, 0, 0.8), values.CompletedCurve(ring, True, 1, 0.6))
    power = np.linalg.matrix_power
    places = np.array([power(steps[0], i) @ power(steps[1], j) for i in range(3) for j in range(2)])
    places[-1] = places[-1] @ np.array([[0, -1, 0, 7], [1, 0, 0, 8], [0, 0, 1, 9], [0, 0, 0, 1.0]])
    evidence = np.linspace(0, 1, 12).reshape(6, 2)
    template = values.Template(3, 5, parts, places, evidence)
    classes = values.InputClasses(
        np.array(["template", "template", "strong", "noise"]), np.array([5, 5, -1, -1]), np.array([0, 1, -1, -1])
    )
    strong = (values.CompletedCurve(arch + [0, 50, 0], False, -1, 1.0),)
    return values.Completion(0.02, (grid,), (template,), strong, classes, {"blast": 1.0}, {"matches": 3})


@pytest.fixture
def curves(part):
    """The input that `completion` is of; the second curve is closed."""
    rng = np.random.default_rng(1)
    lines = [np.cumsum(rng.normal(size=(n, 3)), axis=0) for n in (4, 5, 6, 3)]
    return part("core.values").Curves.from_list(
        lines, [False, True, False, False], [np.full(len(p), 2.0) for p in lines]
    )


@pytest.fixture
def arcs():
    """Makes OBJ text: equal wavy curves one step apart, and a stray one; the edge length is 0.1."""

    def make(count=3, *, stray=True, step=6.0, noise=0.01, shift=0.0, seed=5, length=7.0):
        rng = np.random.default_rng(seed)
        along = np.arange(0, length, 0.1)
        wave = np.c_[along, np.sin(along) + 0.3 * np.cos(2.3 * along), 0.5 * np.cos(1.7 * along)]
        lines = [wave + [0, step * i, 0] + noise * rng.normal(size=wave.shape) for i in range(count)]
        if stray:
            lines.append(np.cumsum(rng.normal(scale=0.05, size=(12, 3)), axis=0) + [0, 0, 5])
        text, base = [], 1
        for line in lines:
            text += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in (line + shift).tolist()]
            text.append("l " + " ".join(map(str, range(base, base + len(line)))))
            base += len(line)
        return "\n".join(text) + "\n"

    return make


@pytest.fixture
def bumps():
    """Makes points and triangles of a sheet with three equal wavy ridges; the edges are about 0.2 long."""

    def make(rows=3, step=0.2):
        x, y = np.arange(0, 12, step), np.arange(-2, 6 * rows - 2, step)
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        path = np.sin(0.9 * grid[:, 0]) + 0.3 * np.cos(2.1 * grid[:, 0])
        away = (grid[:, 1] - path + 3) % 6 - 3
        points = np.c_[grid, np.exp(-((away / 0.5) ** 2))]
        index = np.arange(len(grid)).reshape(len(x), len(y))
        a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
        return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])

    return make


@pytest.fixture
def scan(bpy, bumps):
    """That sheet as an object of the scene, chosen."""
    points, faces = bumps()
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    item = bpy.data.objects.new("Scan", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()
    return item


@pytest.fixture
def wall(bpy, curves):
    """The curves as a selected edge mesh "Wall" in the scene."""
    mesh = bpy.data.meshes.new("Wall")
    edges = []
    for a, b, loop in zip(curves.offsets[:-1], curves.offsets[1:], curves.closed):
        edges += [(i, i + 1) for i in range(a, b - 1)] + ([(b - 1, a)] if loop else [])
    mesh.from_pydata(curves.points.tolist(), edges, [])
    item = bpy.data.objects.new("Wall", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()
    bpy.context.scene.fcn.form = "DENSE"  # with a point for each of the completion's
    return item


@pytest.fixture
def work(part, completion, monkeypatch):
    """In place of the method, which takes long, a function that gives the completion made by hand."""

    def do(task, report):
        report("blast", 0.5)
        return completion

    monkeypatch.setattr(part("fcn_addon.job.completing"), "_work", do)
    return do


@pytest.fixture
def made(bpy, part, wall, work):
    """The result of the button; a collection."""
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    bpy.context.view_layer.update()
    return bpy.context.scene.fcn.result
