# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of transformations for people: "Grid 1: 5 x 3, step 1.80 m, 2.40 m", "Row 1 of 13, step 2 m"."""

from __future__ import annotations

import math

import numpy as np

LEAVE_EDIT_MODE = "Leave the edit mode first"
KINDS = {"single": "Pair", "translation": "Row", "grid": "Grid", "rotation": "Ring", "screw": "Spiral"}


def plain_length(value) -> str:
    """A length without a unit."""
    return f"{value:.4g}"


def counted(count, thing) -> str:
    """A number of things: "1 occurrence", "8 occurrences"."""
    return f"{count:,} {thing}" if count == 1 else f"{count:,} {thing}s"


def letters(number) -> str:
    """A, B, ... Z, AA, AB, ... for 0, 1, ..."""
    text = ""
    number += 1
    while number:
        number, rest = divmod(number - 1, 26)
        text = chr(ord("A") + rest) + text
    return text


def titles(transformations, length=plain_length) -> dict[int, str]:
    """Transformation id -> title, numbered within each kind in the order given.

    Parameters
    ----------
    length : turns a length in scene units into words
    """
    seen, named = {}, {}
    for t in transformations:
        seen[t.kind] = seen.get(t.kind, 0) + 1
        joint = " of " if t.kind == "translation" else ": "  # a row of 13, but a grid: 5 x 3
        named[t.id] = f"{KINDS[t.kind]} {seen[t.kind]}{joint}{description(t, length)}"
    return named


def description(transformation, length=plain_length) -> str:
    """How often and by how much: "5 x 3, step 1.80, 2.40"."""
    kind, generators = transformation.kind, transformation.generators
    cells = [int(high - low + 1) for low, high in transformation.extent]
    steps = [length(float(np.linalg.norm(g[:3, 3]))) for g in generators]
    if kind == "grid":
        return f"{cells[0]} x {cells[1]}, step {steps[0]}, {steps[1]}"
    if kind == "translation":
        return f"{cells[0]}, step {steps[0]}"
    turn, rise = angle_and_rise(generators[0])
    if kind == "rotation":
        return f"{cells[0]} x {_degrees(turn)}"
    if kind == "screw":
        return f"{cells[0]} x {_degrees(turn)}, rise {length(abs(rise))}"
    return f"turned {_degrees(turn)}, moved {steps[0]}" if turn > 1e-3 else f"moved {steps[0]}"


def angle_and_rise(motion) -> tuple[float, float]:
    """Angle of a (4, 4) rigid motion in radians, 0 to pi, and its shift along the axis in scene units."""
    rotation = np.asarray(motion, float)[:3, :3]
    turn = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    angle = math.atan2(float(np.linalg.norm(turn)), float(np.trace(rotation)) - 1)
    # The axis is the column space of R + R^T + (1 - tr R) I, which is a multiple of the axis' outer product.
    outer = rotation + rotation.T + (1 - np.trace(rotation)) * np.eye(3)
    axis = outer[:, int(np.argmax(np.linalg.norm(outer, axis=0)))]
    size = np.linalg.norm(axis)
    return angle, float(np.asarray(motion)[:3, 3] @ axis / size) if size > 1e-12 else 0.0


def _degrees(angle) -> str:
    return f"{round(math.degrees(angle), 1):g}°"


def duration(seconds) -> str:
    """A span of time in words: "0.4 s", "12 s", "3 min 20 s"."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"
