# SPDX-License-Identifier: GPL-3.0-or-later
"""A scan in a real window: detect its curves, stop once, change the threshold, undo, all the way in one go.

xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup --enable-event-simulate \
    --window-geometry 0 0 1280 800 -P tests/window/scan_session.py -- PICTURES_FOLDER
"""

import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
MANY = 12  # walls in a row, to be busy with long after the key that stops it was seen
sys.path[:0] = [str(HERE), str(HERE.parent.parent)]
from driver import EXTENSION, Driver, Redraws  # noqa: E402
from whole_session import CATEGORY, settings, small  # noqa: E402


def prepare(driver):
    """The example's scan, coarser, in an otherwise empty scene, seen from the front."""
    from examples.make_scan import scan

    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    made = scan(spacing=0.04)
    mesh = bpy.data.meshes.new("Wall")
    mesh.from_pydata(made.vertices.tolist(), [], made.faces.tolist())
    item = bpy.data.objects.new("Wall", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    with driver.context():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()
    bpy.ops.ed.undo_push(message="ready")


def still(driver, chosen):
    """Whatever is selected, what lies below all that is about the selection stays where it is; a generator."""
    found = []
    for item in chosen:
        for other in bpy.context.selected_objects:
            other.select_set(False)
        if item is not None:
            item.select_set(True)
        bpy.context.view_layer.objects.active = item
        driver.region("UI").tag_redraw()
        yield 0.4
        driver.move(driver.region("UI").x + 30, driver.region("UI").y + 30)
        yield 0.2
        if not found:
            yield from driver.find("fcn.form", found)
        driver.move(found[0][0], found[0][1] - 6)
        yield 0.3
        seen = driver.under_mouse()
        assert "fcn.form" in seen, (item, seen)


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    prepare(driver)
    yield from driver.sidebar(CATEGORY)
    driver.picture("s1-scan")

    print("-- stopped by Esc", flush=True)
    wall = bpy.data.objects["Wall"]
    row = wall.modifiers.new("Row", "ARRAY")
    row.count, wall.display_type = MANY, "BOUNDS"  # without a graphics card, to draw them takes seconds
    with driver.context():
        assert bpy.ops.fcn.detect("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    yield 0.2
    began = time.monotonic()
    yield from driver.key("ESC")
    yield lambda: not running.running()
    driver.note(f"detection stopped {time.monotonic() - began:.2f} s after Esc")
    yield 0.3
    assert "Wall curves" not in bpy.data.objects
    wall.modifiers.remove(row)
    wall.display_type = "TEXTURED"

    print("-- detected by the button", flush=True)
    with Redraws(driver) as redraws:
        yield from driver.press("bpy.ops.fcn.detect()")
        yield lambda: not running.running() and "Wall curves" in bpy.data.objects
    driver.note(f"longest gap between two redraws {redraws.longest:.2f} s, median {redraws.median:.3f} s")
    item = bpy.data.objects["Wall curves"]
    curves = item.fcn_curves
    assert curves.total > 20 and bpy.context.active_object == item
    yield 0.5
    driver.picture("s2-curves")
    yield from still(driver, (item, None, wall, item))

    print("-- the threshold, by dragging it", flush=True)
    found = []
    yield from driver.find("fcn_curves.fold", found)
    x, y = found[0]
    yield from driver.drag(x, y, x + 60)
    yield 0.3
    driver.picture("s3-threshold")
    assert curves.fold > 0 and curves.shown < curves.total, (curves.fold, curves.shown)
    shown = curves.shown
    with driver.context():
        bpy.ops.ed.undo()
    yield 0.5
    curves = bpy.data.objects["Wall curves"].fcn_curves
    assert curves.shown > shown

    print("-- other thresholds are outlined before a run", flush=True)
    trial, scene = sys.modules[f"{EXTENSION}.fcn_addon.job.trial"], bpy.context.scene
    scene.fcn.detection.strong_fold *= 1.6
    yield lambda: isinstance(trial.latest(), trial.Trial)
    assert trial.latest().shorter > 0
    yield 0.5
    driver.picture("s3-outline")
    scene.fcn.detection.property_unset("strong_fold")
    trial.stop()
    with driver.context():
        bpy.ops.ed.undo()
    yield 0.5
    assert "Wall curves" not in bpy.data.objects and "Wall" in bpy.data.objects

    print("-- in one go", flush=True)
    small(driver)
    bpy.data.objects.remove(bpy.data.objects["Facade"])
    scan = bpy.data.objects["Example Scan"]
    scan.hide_set(False)
    scan.select_set(True)
    bpy.context.view_layer.objects.active = scan
    yield 0.3
    began = time.monotonic()
    yield from driver.press("bpy.ops.fcn.complete_scan()")
    yield 2.0
    driver.picture("s4-running")
    yield lambda: not running.running()
    driver.note(f"the scan was completed after {time.monotonic() - began:.0f} s")
    yield 1.0
    assert settings().result is not None and settings().result.fcn_result.source == "Example Scan"
    bpy.data.objects["Example Scan"].hide_set(True)
    yield 0.5
    driver.picture("s5-completed")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
