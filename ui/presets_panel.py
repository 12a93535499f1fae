# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the parameters: those that come along, and those that the user saves."""

from __future__ import annotations

import bpy
from bl_ui.utils import PresetPanel


class FCN_PT_presets(PresetPanel, bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_label = "Curve Completion Presets"
    preset_subdir = "fcn_addon"
    preset_operator = "script.execute_preset"
    preset_add_operator = "fcn.save_preset"
