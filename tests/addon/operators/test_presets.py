# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the parameters: those that come along, and the user's."""

import os
from pathlib import Path


def presets(part):
    return sorted((part("fcn_addon.installation").ROOT / "ui" / "presets" / "fcn_addon").glob("*.py"))


def test_the_presets_that_come_along(bpy, part):
    properties = part("fcn_addon.properties.settings")
    values = {}
    for path in presets(part):
        bpy.context.scene.fcn.parameters.bayes_ratio = 7  # what a preset does not name goes back to the default
        bpy.ops.script.execute_preset(filepath=str(path), menu_idname="FCN_PT_presets")
        values[path.stem] = properties.parameters(bpy.context.scene.fcn.parameters)
    assert set(values) == {"Default", "Drawn_or_CAD", "Very_Noisy_Scan"}
    assert values["Default"] == part("core.parameters").Parameters()
    assert {v.bayes_ratio for v in values.values()} == {values["Default"].bayes_ratio}
    assert values["Drawn_or_CAD"].smoothing < values["Default"].smoothing < values["Very_Noisy_Scan"].smoothing


def test_blender_finds_the_presets(bpy, part):
    found = {name for path in bpy.utils.preset_paths("fcn_addon") for name in os.listdir(path)}
    assert {path.name for path in presets(part)} <= found


def test_a_preset_of_the_user(bpy, part):
    group = bpy.context.scene.fcn.parameters
    group.l0 = 31
    assert bpy.ops.fcn.save_preset(name="Mine", remove_active=False) == {"FINISHED"}
    group.l0 = 20
    path = next(p for folder in bpy.utils.preset_paths("fcn_addon") for p in [Path(folder, "Mine.py")] if p.is_file())
    bpy.ops.script.execute_preset(filepath=str(path), menu_idname="FCN_PT_presets")
    assert group.l0 == 31
