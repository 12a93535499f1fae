# SPDX-License-Identifier: GPL-3.0-or-later
"""Coordinates that were rounded too coarsely are told from good ones."""

import numpy as np
import pytest


@pytest.fixture
def step(part, bumps):
    """The rounding that is found in a scan, after a change of its points; its edge length is about 0.2."""

    def call(change):
        points, triangles = bumps()
        return part("fcn_addon.coarse").rounding_step(change(points), triangles, 0.22)

    return call


def jitter(points):
    """As a scanner has them: not on a grid."""
    return points + np.random.default_rng(0).uniform(-0.08, 0.08, points.shape)


@pytest.mark.parametrize(
    ("offset", "expected"),
    [((450123.4, 5411987.6, 212.3), 0.5), ((450123.4, 541198.7, 212.3), 0.0625), ((4501.2, 5411.9, 212.3), None)],
)
def test_single_precision_far_from_the_origin(step, offset, expected):
    assert step(lambda points: (jitter(points) + offset).astype(np.float32).astype(float)) == expected


@pytest.mark.parametrize(("digits", "expected"), [(0, 1.0), (1, 0.1), (2, None), (6, None)])
def test_decimals_of_text_files(step, digits, expected):
    found = step(lambda points: np.round(jitter(points), digits))
    assert found == (expected if expected is None else pytest.approx(expected))


def test_what_is_no_rounding(step):
    assert step(lambda points: points) is None  # a grid of heights
    assert step(jitter) is None
    assert step(lambda points: 0 * points) is None
    assert step(lambda points: points[:, [2, 0, 1]]) is None


def test_the_command_says_it(part, bpy, capsys, bumps, tmp_path):
    points, triangles = bumps()
    path = tmp_path / "scan.obj"
    rows = [
        *(f"v {x:.1f} {y:.1f} {z:.1f}" for x, y, z in jitter(points)),
        *(f"f {a} {b} {c}" for a, b, c in triangles + 1),
    ]
    path.write_text("\n".join([*rows, "f 1 1 2"]) + "\n")
    assert part("fcn_addon.command.run").main([str(path), "--detect-only", "--report", str(tmp_path / "r.json")]) == 0
    said = capsys.readouterr().err
    assert f"{path}: its coordinates are rounded to 0.1, which is coarse beside its edge length of 0.2" in said
    assert "faces have no area or are there twice; they are left out" in said
    assert "rounded to 0.1" in (tmp_path / "r.json").read_text()
