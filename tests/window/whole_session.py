# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole session in a real window: curves in, cancel once, run to the end, look at it, correct it, save and reopen.

xvfb-run -a -s "-screen 0 1280x800x24" blender --factory-startup --enable-event-simulate \
    --window-geometry 0 0 1280 800 -P tests/window/whole_session.py -- PICTURES_FOLDER
"""

import sys
import time
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from driver import EXTENSION, RIGHT, Driver, Redraws  # noqa: E402

EXAMPLE = HERE.parent.parent / "examples" / "facade.obj"
CATEGORY = "Feature Curves"


def prepare(driver):
    """The example as an edge mesh in an otherwise empty scene, seen from the front."""
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    bpy.ops.wm.obj_import(filepath=str(EXAMPLE), forward_axis="Y", up_axis="Z")
    item = bpy.context.selected_objects[0]
    item.name = "Facade"
    bpy.context.view_layer.objects.active = item
    with driver.context():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()
    driver.area.spaces.active.overlay.show_relationship_lines = False


def small(driver):
    """The example that the window makes, a few seconds long; its curves are called "Facade", the scan is hidden."""
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    with driver.context():
        assert bpy.ops.fcn.try_example() == {"FINISHED"}
    bpy.context.active_object.name = "Facade"
    bpy.data.objects["Example Scan"].hide_set(True)  # without a graphics card it takes long to draw
    driver.area.spaces.active.overlay.show_relationship_lines = False


def settings():
    return bpy.context.scene.fcn


def result():
    return settings().result.fcn_result


def visible():
    return [o for o in settings().result.all_objects if "support" in o and o.visible_get()]


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    latest = sys.modules[f"{EXTENSION}.fcn_addon.job.summary"]
    prepare(driver)
    yield from driver.sidebar(CATEGORY)
    yield lambda: not isinstance(latest.latest(), str | None)
    yield 0.3
    driver.picture("1-panel")
    found = []
    yield from driver.find("bpy.ops.fcn.complete()", found)
    x, y = found[0][0], found[0][1] - 45  # the header of the parameters, which lies below the button
    yield from driver.click(x, y)
    yield 0.7
    driver.picture("1-parameters")
    yield from driver.click(x, y)
    yield 0.7

    yield from driver.press("bpy.ops.fcn.complete()")
    yield running.running
    yield 1.0
    driver.picture("2-progress")
    yield from driver.press("bpy.ops.fcn.cancel()")
    yield lambda: not running.running()
    assert settings().result is None and len(bpy.data.collections) <= 1, "a cancelled run must leave nothing"

    yield from driver.press("bpy.ops.fcn.complete()")
    yield running.running
    yield 0.5
    region = driver.region("WINDOW")
    driver.move(region.x + 300, region.y + 300)
    yield 0.2
    stopped = time.monotonic()
    driver.event("ESC", "PRESS", region.x + 300, region.y + 300)
    yield lambda: not running.running()
    driver.note(f"Esc to the end of the run: {time.monotonic() - stopped:.2f} s")
    assert settings().result is None

    with Redraws(driver) as idle:
        yield 2.0
    driver.note(f"redraws without a run: {1000 * idle.median:.0f} ms, longest {1000 * idle.longest:.0f} ms")
    yield from driver.press("bpy.ops.fcn.complete()")
    with Redraws(driver) as busy:
        yield 5.0
        assert running.running()
    driver.note(f"redraws during a run: {1000 * busy.median:.0f} ms, longest {1000 * busy.longest:.0f} ms")
    running.cancel()
    yield lambda: not running.running()

    small(driver)
    yield 0.5
    yield from driver.press("bpy.ops.fcn.complete()")
    began = time.monotonic()
    yield lambda: settings().result is not None
    driver.note(f"button to result: {time.monotonic() - began:.1f} s, the method itself {result().seconds:.1f} s")
    yield 1.0
    assert result().templates and visible()
    driver.picture("3-result")
    yield from result_session(driver)


def result_session(driver):
    """What is done with a result that is there."""
    size = len(visible())
    for view, column, row in (("COMPONENTS", 1, 0), ("TEMPLATES", 0, 1), ("INPUT", 1, 1), ("RESULT", 0, 0)):
        yield from driver.choose("fcn_result.view", column, row)
        assert result().view == view, f"the switch shows {result().view}, not {view}"
        driver.picture(f"4-view-{view.lower()}")
    assert len(visible()) == size

    found = []
    yield from driver.find("fcn_result.support", found)
    x, y = found[0]
    yield from driver.drag(x, y, x + 230)
    least = result().support
    assert least > 0 and len(visible()) < size
    assert all(o["support"] >= least - 1e-6 for o in visible())
    driver.picture("5-support")
    result().support = 0.0
    assert len(visible()) == size

    yield from driver.press("bpy.ops.fcn.select_template(", shares=RIGHT)
    chosen = bpy.context.selected_objects
    assert chosen and {o["template"] for o in chosen} == {result().template_rows[0].ident}
    driver.picture("6-selected")
    for item in chosen[1:]:
        item.select_set(False)
    bpy.context.view_layer.objects.active = chosen[0]
    yield from correct(driver, chosen[0], size)


def local_view(driver, item):
    """Into the local view of what is selected and back; there its curves are seen in their colours too."""
    chosen = bpy.context.selected_objects
    overlay = sys.modules[f"{EXTENSION}.ui.overlay"]
    with driver.context():
        bpy.ops.view3d.localview()
    for other in chosen:
        other.select_set(False)
    yield 0.5
    driver.picture("8-local-view")
    assert overlay._batches[bpy.context.scene.session_uid, driver.area.spaces.active.as_pointer()] is not None
    with driver.context():
        bpy.ops.view3d.localview()
    for other in chosen:
        other.select_set(True)
    bpy.context.view_layer.objects.active = item
    yield 0.3


def correct(driver, item, size):
    """Selecting the source, editing and rejecting, with the operators that the buttons call."""
    space = driver.area.spaces.active

    def press(name):
        with driver.context():
            assert getattr(bpy.ops.fcn, name)("INVOKE_DEFAULT") == {"FINISHED"}

    press("select_source")
    yield 0.5
    assert bpy.context.mode == "EDIT_MESH" and result().view == "INPUT"
    driver.picture("7-source")
    press("select_result")
    yield 0.3
    assert bpy.context.mode == "OBJECT" and item.select_get()
    with driver.context():
        bpy.ops.view3d.view_all()
    yield 0.3
    distance = space.region_3d.view_distance
    press("edit_template")
    yield 0.5
    assert bpy.context.mode == "EDIT_CURVE" and space.overlay.show_fade_inactive and not space.local_view
    assert space.region_3d.view_distance < 0.9 * distance
    driver.picture("8-edit-template")
    yield from driver.key("TAB")
    yield lambda: not space.overlay.show_fade_inactive
    assert bpy.context.mode == "OBJECT"
    settings().edit_alone = True
    press("edit_template")
    yield 0.5
    assert bpy.context.mode == "EDIT_CURVE" and space.local_view
    yield from driver.key("TAB")
    yield lambda: not space.local_view
    assert bpy.context.mode == "OBJECT"
    settings().edit_alone = False
    press("select_occurrence")
    assert {item, item.parent} < set(bpy.context.selected_objects)
    yield from local_view(driver, item)
    press("reject_occurrence")
    yield 0.3
    assert not item.visible_get()
    press("reject_transformation")
    with driver.context():
        bpy.ops.view3d.view_all()
    yield 0.5
    assert not any(o.visible_get() for o in result().transformations[0].home.objects)
    driver.picture("9-rejected")
    press("restore")
    yield 0.3
    assert len(visible()) == size

    name = settings().result.name
    path = str(Path(bpy.app.tempdir) / "saved.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile()
    yield 0.5
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 0.5
    yield from driver.sidebar(CATEGORY)
    assert settings().result.name == name and len(visible()) == size
    result().view = "TEMPLATES"
    yield 0.5
    driver.picture("10-reopened")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
