# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole walk with mouse and keys: select, edit, make unique, reject, undo to the start, redo to the end, save,
reopen, export, import again. The end is compared with what was recorded on the way, and with `RECORD`.

Runs inside a session that has the example's result; see `steps_session`.
"""

import csv
import time
from pathlib import Path

import bpy
import steps
from driver import RIGHT

RECORD = {"templates": 1, "places": 6, "rejected": 1}
"""What the end state is by hand: the example's windows, one of them rejected."""


def record(driver):
    """All that the walk changes, as plain values; None for a scene without a result."""
    root = bpy.context.scene.fcn.result
    if root is None:
        return None
    shapes = {}
    for item in root.all_objects:
        if item.type == "CURVE":
            points = [p for s in item.data.splines for p in s.bezier_points]
            shapes[item.data.name] = [round(sum(p.co[i] for p in points), 4) for i in range(3)] + [len(points)]
    rows = root.fcn_result.template_rows
    return {**steps.state(driver), "shapes": shapes, "rows": [(r.name, r.count, r.rejected) for r in rows]}


def lasting(found):
    """What a file keeps of a record: not the selection."""
    return {k: v for k, v in found.items() if k not in {"selected", "active"}}


def occurrence(number, template=None):
    """The longest visible curve of an occurrence, by default of the first template."""
    root = bpy.context.scene.fcn.result
    template = root.fcn_result.template_rows[0].ident if template is None else template
    mine = [o for o in root.all_objects if o.get("occurrence") == number and o.get("template") == template]
    return max((o for o in mine if "support" in o and o.visible_get()), key=lambda o: max(o.dimensions))


def click_on(driver, item):
    """All in view, and a click on the middle of a curve's first segment; a generator."""
    yield from driver.key("HOME")
    yield 0.3
    yield from driver.click(*steps.place_of(driver, item))
    yield 0.2
    active = bpy.context.view_layer.objects.active
    assert active is not None and active.get("occurrence") == item["occurrence"], f"{item.name} was not taken"


def choose(driver, number, dense):
    """Make a curve of an occurrence of the first template active: by a click on it, or where curves of others lie
    beside it by the arrow of the list, which also looks at it; a generator."""
    if not dense:
        yield from click_on(driver, occurrence(number))
        return
    yield from driver.press(f"bpy.ops.fcn.select_template(index=-1, place={number})", shares=RIGHT)
    yield 0.3
    active = bpy.context.view_layer.objects.active
    assert active is not None and active.get("occurrence") == number and active.select_get()


def undo(driver, again=False):
    yield from driver.key("Z", ctrl=True, shift=again)


def walk(driver, folder, known=RECORD):
    """The walk; a generator.

    folder : for the files
    known : what is recorded of the end by hand, None for what the result says
    """
    start = record(driver)
    if known is not None:
        assert [row[1:] for row in start["rows"]] == [(known["places"], 0)] * known["templates"], start["rows"]
    places = sum(count for _, count, _ in start["rows"])
    began, clicks = time.monotonic(), driver.clicks
    dense = known is None
    yield from choose(driver, 0, dense)
    yield from driver.press("bpy.ops.fcn.edit_template()")
    yield lambda: bpy.context.mode == "EDIT_CURVE"
    before = record(driver)["shapes"]
    yield from driver.key("A")
    yield from driver.key("G")
    yield from driver.key("X")
    yield from driver.key("ONE", unicode="1")
    yield from driver.key("RET")
    yield from driver.key("TAB")
    yield lambda: bpy.context.mode == "OBJECT" and not driver.area.spaces.active.overlay.show_fade_inactive
    assert record(driver)["shapes"] != before, "nothing was moved"
    yield from choose(driver, 1, dense)
    yield from driver.press("bpy.ops.fcn.make_unique()", near=True)
    assert any("unique" in o for o in bpy.context.scene.fcn.result.all_objects)
    last = start["rows"][0][1] - 1
    yield from choose(driver, min(last, 2) if dense else last, dense)  # the list shows three rows
    yield from driver.press("bpy.ops.fcn.reject_occurrence()", near=True)
    end = record(driver)
    assert end["rows"][0][1:] == (last, 1) and end["rows"][1:] == start["rows"][1:], end["rows"]
    places -= 1
    if known is not None:
        assert places == known["places"] - known["rejected"]
    driver.note(f"the walk: {driver.clicks - clicks} clicks, {time.monotonic() - began:.0f} s")
    yield from there_and_back(driver, start, end)
    yield from saved_and_opened(driver, end, folder)
    yield from out_and_in(driver, folder, places)


def there_and_back(driver, start, end, most=14):
    """Undo to the start, redo to the end."""
    for wanted, again in ((start, False), (end, True)):
        step = 0
        while steps.difference(lasting(wanted), lasting(record(driver))) and step < most:
            yield from undo(driver, again)
            yield 0.1
            step += 1
        gap = steps.difference(lasting(wanted), lasting(record(driver)))
        assert not gap, f"{'redo' if again else 'undo'}: {gap}"
        driver.note(f"{'redo to the end' if again else 'undo to the start'}: {step} steps")


def saved_and_opened(driver, end, folder):
    path = str(Path(folder) / "walk.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile()
    yield 0.3
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 0.5
    gap = steps.difference(lasting(end), lasting(record(driver)))
    assert not gap, f"reopened: {gap}"


def visible():
    return [o for o in bpy.context.scene.fcn.result.all_objects if "support" in o and o.visible_get()]


def box(points):
    return [round(f(p[i] for p in points), 3) for f in (min, max) for i in range(3)]


def out_and_in(driver, folder, places):
    """Each format is written, and what can be read is imported again: as many curves in the same place."""
    count = len(visible())
    paths = {form: str(Path(folder) / f"walk.{form.lower()}") for form in ("OBJ", "DXF", "SVG", "CSV")}
    for form, path in paths.items():
        with driver.context():
            assert bpy.ops.fcn.export_curves(filepath=path, form=form) == {"FINISHED"}
    with open(paths["CSV"], newline="") as file:
        assert len(list(csv.DictReader(file))) == places
    with open(paths["OBJ"]) as file:
        lines = file.read().splitlines()
    assert sum(line.startswith("l ") for line in lines) == count
    written = box([tuple(map(float, line.split()[1:])) for line in lines if line.startswith("v ")])
    with open(paths["SVG"]) as file:
        assert file.read().count("<use ") == places
    bpy.context.scene.fcn.result.fcn_result.view = "INPUT"
    size = max(abs(value) for value in written)
    for form, near in (("OBJ", 5e-4 * size), ("DXF", 5e-3 * size)):
        with driver.context():
            assert bpy.ops.fcn.import_curves(filepath=paths[form]) == {"FINISHED"}
        item = bpy.context.view_layer.objects.active
        found = box([item.matrix_world @ v.co for v in item.data.vertices])
        assert max(abs(a - b) for a, b in zip(found, written)) < near, (form, found, written)
        yield 0.3
    driver.picture("first-8-imported")
    driver.note(f"{count} curves went out and came in again")
