# SPDX-License-Identifier: GPL-3.0-or-later
"""The first minute in a real window: the example, a run, editing over the faint rest, undo and redo, clicks.

See whole_session.py for how it is run.
"""

import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import steps  # noqa: E402
import walk  # noqa: E402
from driver import EXTENSION, RIGHT, Driver  # noqa: E402


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    driver.area.spaces.active.overlay.show_relationship_lines = False
    yield from driver.sidebar("Feature Curves")
    yield 0.5
    driver.picture("first-1-empty")
    yield from driver.press("bpy.ops.fcn.try_example()")
    yield 1.0
    driver.picture("first-2-example")
    assert bpy.context.active_object.name == "Example Curves"
    yield from driver.press("bpy.ops.fcn.complete()")
    yield running.running
    yield 1.5
    driver.picture("first-3-run")
    yield lambda: not running.running()
    yield 1.0
    root = bpy.context.scene.fcn.result
    assert root.fcn_result.templates and not bpy.context.scene.fcn.show_source
    driver.picture("first-4-result")
    yield from edited(driver)
    bpy.data.objects["Example Scan"].hide_set(True)  # without a graphics card it takes long to draw
    yield from steps.pairs(driver)
    yield from steps.clicks(driver)
    driver.picture("first-7-end")
    yield from walk.walk(driver, bpy.app.tempdir)


def edited(driver):
    """A template is edited by its button; a handle is moved; Tab ends all that goes with it."""
    space = driver.area.spaces.active
    yield from driver.press("bpy.ops.fcn.select_template(", shares=RIGHT)
    item = bpy.context.selected_objects[0]
    steps.choose(item)
    with driver.context():
        bpy.ops.fcn.edit_template("INVOKE_DEFAULT", True)
    yield 0.6
    assert bpy.context.mode == "EDIT_CURVE" and space.overlay.show_fade_inactive
    driver.picture("first-5-edit")
    yield from driver.key("TAB")
    yield lambda: not space.overlay.show_fade_inactive
    assert bpy.context.mode == "OBJECT"
    driver.picture("first-6-after-tab")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
