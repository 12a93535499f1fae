# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths in the units of a scene."""

from __future__ import annotations

import bpy

from ..wording import plain_length


def unit_length(scene):
    """A function that words a length in the units of a scene."""
    system, size = scene.unit_settings.system, scene.unit_settings.scale_length
    if system == "NONE":
        return plain_length
    return lambda value: bpy.utils.units.to_string(system, "LENGTH", value * size, precision=3, split_unit=False)


def metres(scene):
    """How many metres a unit of the coordinates of a scene is, None where it says that it has no unit."""
    return None if scene.unit_settings.system == "NONE" else scene.unit_settings.scale_length


def dxf_units(scene) -> int:
    """DXF's code of the unit that coordinates of a scene are in: 6 for metres, 0 where it has none that DXF knows."""
    units = scene.unit_settings
    if units.system == "NONE":
        return 0
    codes = {1.0: 6, 0.001: 4, 0.01: 5, 1000.0: 7, 0.3048: 2, 0.0254: 1}
    return next((code for size, code in codes.items() if abs(units.scale_length / size - 1) < 1e-5), 0)
