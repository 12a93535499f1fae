# SPDX-License-Identifier: GPL-3.0-or-later
"""Save the parameters as a preset, or remove one."""

from __future__ import annotations

from dataclasses import fields

import bpy
from bl_operators.presets import AddPresetBase

from ..core.parameters import Parameters

FOLDER = "fcn_addon"


class FCN_OT_save_preset(AddPresetBase, bpy.types.Operator):
    """Save the parameters as a preset, or remove the preset that is shown"""

    bl_idname = "fcn.save_preset"
    bl_label = "Save Curve Completion Preset"
    preset_menu = "FCN_PT_presets"
    preset_defines = ["parameters = bpy.context.scene.fcn.parameters"]
    preset_values = [f"parameters.{field.name}" for field in fields(Parameters)]
    preset_subdir = FOLDER
