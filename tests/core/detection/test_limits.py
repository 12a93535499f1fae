# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a mesh may be, and how soon a run stops."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from core.detection import TriangleMesh, detect
from core.errors import Cancelled
from tests.core.detection import surfaces

ROOT = Path(__file__).resolve().parents[3]

WITHIN = """
import re, resource, sys
import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree
from core.detection import TriangleMesh, detect
from core.errors import InputError

def grid(n):
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    z = 0.05 * np.abs(10 * x % 2 - 1)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    return np.stack([x.ravel(), y.ravel(), z.ravel()], 1), np.concatenate(
        [np.stack([a, a + n, a + n + 1], 1), np.stack([a, a + n + 1, a + 1], 1)]
    )

detect(TriangleMesh.of(*grid(40)))  # loads all that is loaded late
vertices, faces = grid(500)
taken = 1024 * int(re.search(r"VmSize:\\s+(\\d+)", open("/proc/self/status").read())[1])
room = int(taken + int(sys.argv[1]) * len(faces))
resource.setrlimit(resource.RLIMIT_AS, (room, room))
try:
    print(len(detect(TriangleMesh.of(vertices, faces))), "curves")
except InputError as error:
    print("InputError:", error)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the limit is Linux's")
@pytest.mark.parametrize(
    "bytes_per_face, said",
    [
        (800, "9 curves"),
        (300, "InputError: not enough memory for 498002 faces: decimate the mesh first"),
        (50, "InputError: not enough memory for 498002 faces: decimate the mesh first"),
    ],
)
def test_a_large_mesh_gives_a_right_result_or_a_clear_error(bytes_per_face, said):
    # 800 bytes a face are 4 GB for five million faces
    done = subprocess.run(
        [sys.executable, "-c", WITHIN, str(bytes_per_face)], cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.stdout.strip() == said, done.stderr


def test_no_step_takes_a_large_part_of_the_run():
    v, f, _ = surfaces.folded_sheet(250, 7, 50.0)
    v = surfaces.noisy(v, 0.0003)
    best = 1.0
    for _ in range(3):  # the machine may pause one of the runs
        told = [time.perf_counter()]

        def tell(_stage, _fraction, told=told):
            told.append(time.perf_counter())

        detect(TriangleMesh.of(v, f, progress=tell), progress=tell)
        best = min(best, max(b - a for a, b in zip(told, told[1:])) / (told[-1] - told[0]))
    assert best < 0.08  # half a second of the 15 s that 1.3 million faces take is 0.03


@pytest.mark.parametrize("after", [3, 30, 60, 90, 110])
def test_a_run_can_be_stopped_at_any_call(after):
    v, f, _ = surfaces.folded_sheet(30, 3, 50.0)
    calls = 0

    def stop(_stage, _fraction):
        nonlocal calls
        calls += 1
        if calls == after:
            raise Cancelled

    with pytest.raises(Cancelled):
        detect(TriangleMesh.of(v, f, progress=stop), progress=stop)
    assert calls == after
