# SPDX-License-Identifier: GPL-3.0-or-later
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import steps
import whole_session
from driver import EXTENSION, Driver


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    whole_session.prepare(driver)
    yield from driver.sidebar("Feature Curves")
    yield 1.0
    driver.picture("t0-empty")
    with driver.context():
        bpy.ops.fcn.complete("INVOKE_DEFAULT")
    yield 1.5
    driver.picture("t1-run")
    yield lambda: not running.running()
    yield 1.0
    driver.picture("t2-result")
    with driver.context():
        bpy.ops.fcn.select_template(index=0)
    yield 0.5
    driver.picture("t3-selected")
    item = bpy.context.selected_objects[0]
    steps.choose(item)
    with driver.context():
        bpy.ops.fcn.edit_template()
    yield 0.8
    driver.picture("t4-edit")
    yield from driver.key("TAB")
    yield 0.8
    driver.picture("t5-after-tab")
    print("after tab", steps.state(driver)["faint"], bpy.context.mode)
    yield from steps.walk(driver)


driver = Driver(sys.argv[sys.argv.index("--") + 1])
driver.run(session(driver))
