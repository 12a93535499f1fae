# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths in the units of a scene."""

from __future__ import annotations

import bpy

from ..wording import plain_length


def unit_length(scene):
    """A function that words a length in the units of a scene."""
    units = scene.unit_settings
    if units.system == "NONE":
        return plain_length
    return lambda value: bpy.utils.units.to_string(
        units.system, "LENGTH", value * units.scale_length, precision=3, split_unit=False
    )
