# SPDX-License-Identifier: GPL-3.0-or-later
"""Transformations in words."""

import numpy as np
import pytest


def motion(angle=0.0, shift=(0, 0, 0), axis=(0, 0, 1)):
    """(4, 4), a turn about an axis through the origin by Rodrigues' formula, then a shift."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    made = np.eye(4)
    made[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    made[:3, 3] = shift
    return made


def metres(value):
    return f"{value:.2f} m"


@pytest.mark.parametrize(
    ("kind", "generators", "extent", "expected"),
    [
        ("grid", [motion(shift=(1.8, 0, 0)), motion(shift=(0, 0, 2.4))], [[-2, 2], [0, 2]],
         "Grid 1: 5 x 3, step 1.80 m, 2.40 m"),
        ("translation", [motion(shift=(0, 0.6, 0.8))], [[0, 11]], "Row 1 of 12, step 1.00 m"),
        ("rotation", [motion(np.radians(18))], [[0, 19]], "Ring 1: 20 x 18°"),
        ("screw", [motion(np.radians(30), (0, 0, -0.2))], [[0, 7]], "Spiral 1: 8 x 30°, rise 0.20 m"),
        ("single", [motion(np.pi, (3, 0, 4), (1, 2, 3))], [[0, 1]], "Pair 1: turned 180°, moved 5.00 m"),
        ("single", [motion(0, (3, 0, 4))], [[0, 1]], "Pair 1: moved 5.00 m"),
    ],
)  # fmt: skip
def test_titles(part, kind, generators, extent, expected):
    make = part("core.values").Transformation
    transformation = make(9, kind, np.array(generators), np.array(extent), 1.0, 0.5)
    assert part("fcn_addon.wording").titles([transformation], metres) == {9: expected}


def test_each_kind_is_counted_for_itself(part):
    make = part("core.values").Transformation
    row = (np.array([motion(shift=(1, 0, 0))]), np.array([[0, 1]]), 1.0, 0.5)
    named = part("fcn_addon.wording").titles([make(i, k, *row) for i, k in enumerate(["single", "translation"] * 2)])
    assert [" ".join(title.replace(":", "").split()[:2]) for title in named.values()] == [
        "Pair 1", "Row 1", "Pair 2", "Row 2"
    ]  # fmt: skip


@pytest.mark.parametrize("angle", [0.0, 1e-4, 0.3, 2.0, np.pi - 1e-7, np.pi])
@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (-1, 2, 0.5)])
def test_angle_and_rise(part, angle, axis):
    along = np.array(axis) / np.linalg.norm(axis)
    turn, rise = part("fcn_addon.wording").angle_and_rise(motion(angle, 2.5 * along, axis))
    assert turn == pytest.approx(angle, abs=1e-7)
    if angle > 1e-3:
        assert abs(rise) == pytest.approx(2.5, abs=1e-6)


def test_numbers_of_things_and_letters(part):
    wording = part("fcn_addon.wording")
    assert [wording.counted(n, "occurrence") for n in (0, 1, 2, 1234)] == [
        "0 occurrences", "1 occurrence", "2 occurrences", "1,234 occurrences",
    ]  # fmt: skip
    assert [wording.letters(n) for n in (0, 1, 25, 26, 27, 701, 702)] == ["A", "B", "Z", "AA", "AB", "ZZ", "AAA"]
