# SPDX-License-Identifier: GPL-3.0-or-later
"""The lists of a result in a real window, the search in edit mode, a shortcut, and a run with the sidebar closed.

See whole_session.py for how it is run.
"""

import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import steps  # noqa: E402
from driver import EXTENSION, LEFT, RIGHT, Driver  # noqa: E402
from whole_session import CATEGORY, result, settings, small, visible  # noqa: E402


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    small(driver)
    driver.area.spaces.active.show_region_ui = False
    yield 0.5
    said = []

    def over():
        now = running.current()
        said.extend([now.shown[1]] if now is not None and now.shown and now.shown[1] not in said else [])
        return not running.running()

    with driver.context():
        assert bpy.ops.fcn.complete("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    yield 2.0
    driver.picture("list-1-sidebar-closed")
    yield over
    assert len(said) > 1, said
    yield from driver.sidebar(CATEGORY)
    yield 0.5
    yield from lists(driver)
    yield from shortcuts(driver)
    yield from as_meshes(driver, running)


def lists(driver):
    """Eye, solo, one occurrence out and in, restore, a name and a colour."""
    row, every = result().template_rows[0], len(visible())
    mine = [o for o in visible() if o.get("template") == row.ident]
    yield from driver.press("template_rows[0].shown", shares=LEFT)
    yield 0.3
    assert not row.shown and len(visible()) == every - len(mine)
    driver.picture("list-2-eye")
    yield from driver.press("template_rows[0].shown", shares=LEFT)
    yield 0.3
    assert row.shown and len(visible()) == every
    yield from driver.press("fcn_result.solo", shares=RIGHT)
    yield 0.3
    assert result().solo and {o["template"] for o in visible() if o["occurrence"] >= 0} == {row.ident}
    yield from driver.press("fcn_result.solo", shares=RIGHT)
    yield 0.3

    left = row.count
    for place in (1, 2):
        yield from driver.press(f"places[{place}].kept", shares=LEFT)
        yield 0.3
    assert row.count == left - 2 and row.rejected == 2 and len(visible()) < every
    driver.picture("list-3-rejected")
    yield from driver.press("places[1].kept", shares=LEFT)  # one by one
    yield 0.3
    assert row.count == left - 1
    yield from driver.press("bpy.ops.fcn.restore()", shares=RIGHT)
    yield 0.3
    assert (row.count, row.rejected, len(visible())) == (left, 0, every)

    yield from driver.press("bpy.ops.fcn.select_template(index=0", shares=RIGHT)
    yield 0.3
    assert set(bpy.context.selected_objects) == set(mine)
    row.name, row.colour = "Lancet", (0.9, 0.6, 0.1)
    result().view = "TEMPLATES"
    yield 0.5
    driver.picture("list-4-renamed")
    assert all(o.name.startswith("Lancet") and abs(o.color[1] - 0.6) < 1e-3 for o in mine)
    result().view = "RESULT"
    yield 0.3


def shortcuts(driver):
    """A shortcut that is off until it is switched on, and the search in edit mode."""
    keys = bpy.context.window_manager.keyconfigs.addon.keymaps["Object Mode"].keymap_items
    item = next(k for k in keys if k.idname == "fcn.edit_template")
    assert not item.active
    steps.choose(visible()[0])
    yield from driver.key("E", ctrl=True, alt=True, shift=True)
    yield 0.5
    assert bpy.context.mode == "OBJECT"
    item.active = True
    bpy.context.window_manager.keyconfigs.update()
    yield 0.3
    yield from driver.key("E", ctrl=True, alt=True, shift=True)
    yield lambda: bpy.context.mode == "EDIT_CURVE"
    item.active = False
    yield 0.5
    yield from driver.key("F3")
    yield 0.5
    for letter in "finish editing template":
        kind = "SPACE" if letter == " " else letter.upper()
        driver.event(kind, "PRESS", unicode=letter)
        driver.event(kind, "RELEASE")
        yield 0.05
    yield 0.5
    driver.picture("list-5-search")
    driver.event("RET", "PRESS")
    driver.event("RET", "RELEASE")
    yield lambda: bpy.context.mode == "OBJECT"
    yield 0.5


def as_meshes(driver, running):
    """The same curves again as edge meshes; the name that the user gave stays."""
    settings().form = "MESH"
    yield from driver.press("bpy.ops.fcn.complete()")
    yield running.running
    yield lambda: not running.running()
    yield 0.5
    assert {o.type for o in visible()} == {"MESH"} and result().template_rows[0].name == "Lancet"
    with driver.context():
        assert bpy.ops.fcn.apply(kind="MESH") == {"FINISHED"}
    item = bpy.context.active_object
    assert item.type == "MESH" and len(item.data.edges) >= len(item.data.vertices) - len(visible())
    driver.picture("list-6-meshes")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
