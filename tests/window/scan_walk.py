# SPDX-License-Identifier: GPL-3.0-or-later
"""From a scan of yours to an edited drawing, with the clicks and the seconds that it takes.

By hand: `LIMIT=3000 SCAN=path/in/the/tree.ply .ci/real_blender bash .ci/in_window out/pictures scan_walk`.
"""

import os
import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
import driver as driving  # noqa: E402
import walk  # noqa: E402
from driver import EXTENSION, Driver  # noqa: E402

CATEGORY = "Feature Curves"


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    driver.area.spaces.active.overlay.show_relationship_lines = False
    yield from driver.sidebar(CATEGORY)
    bpy.ops.wm.ply_import(filepath=os.environ["SCAN"])
    scan = bpy.context.selected_objects[0]
    bpy.context.view_layer.objects.active = scan
    with driver.context():
        bpy.ops.view3d.view_axis(type=os.environ.get("VIEW", "FRONT"))
        bpy.ops.view3d.view_selected()
    bpy.ops.ed.undo_push(message="scan")
    yield 2.0
    driver.picture("walk-1-scan")
    driving.PATIENCE = 3000.0
    began, clicks = time.monotonic(), driver.clicks
    yield from driver.press("bpy.ops.fcn.complete_scan()")
    yield running.running
    said = []

    def over():
        now = running.current()
        if now is not None and now.shown and time.monotonic() - began > 10 * (len(said) + 1):
            said.append((round(time.monotonic() - began), now.shown[1], f"{now.shown[2]:.0%}", now.shown[3]))
            print("progress:", *said[-1], flush=True)
        return not running.running()

    yield over
    root = bpy.context.scene.fcn.result
    assert root is not None, "no result"
    driver.note(f"button to result: {driver.clicks - clicks} click, {time.monotonic() - began:.0f} s; "
                f"{len(scan.data.polygons):,} faces, {root.fcn_result.templates} templates at "
                f"{root.fcn_result.occurrences} places")  # fmt: skip
    scan.hide_set(True)  # without a graphics card it takes long to draw
    yield 1.0
    driver.picture("walk-2-result")
    yield from walk.walk(driver, bpy.app.tempdir, known=None)
    driver.picture("walk-3-end")
    driver.note(f"in all {driver.clicks} clicks, {time.monotonic() - began:.0f} s with the waiting")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
