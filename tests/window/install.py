# SPDX-License-Identifier: GPL-3.0-or-later
"""The three steps of installing, as pictures: the preferences, the file, the panel."""

import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from driver import EXTENSION, Driver  # noqa: E402

CATEGORY = "Feature Curves"


def session(driver):
    if EXTENSION in bpy.context.preferences.addons:
        bpy.ops.preferences.addon_disable(module=EXTENSION)
    bpy.context.preferences.active_section = "EXTENSIONS"
    driver.area.type = "PREFERENCES"
    yield 1.0
    driver.picture("install-1-preferences")

    area = next(a for a in driver.window.screen.areas if a.type == "PREFERENCES")
    bpy.ops.preferences.addon_enable(module=EXTENSION)
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "Feature Curve"
    area.tag_redraw()
    yield 1.0
    driver.picture("install-2-enabled")

    bpy.ops.preferences.addon_expand(module=EXTENSION)
    area.tag_redraw()
    yield 0.5
    driver.picture("install-4-preferences")
    bpy.ops.preferences.addon_expand(module=EXTENSION)

    area.type = "VIEW_3D"
    yield 0.5
    yield from driver.sidebar(CATEGORY)
    yield 1.0
    driver.picture("install-3-panel")
    assert driver.region("UI").active_panel_category == CATEGORY


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
