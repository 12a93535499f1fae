# SPDX-License-Identifier: GPL-3.0-or-later
"""Every operator is one step of undo: pairs of them in a real window, with undo and redo, whole states compared.

Runs inside a session that has a result; see `steps_session`.
"""

import bpy


def state(driver):
    """All that undo must bring back: mode, view, selection, visibility, templates, local view, fading."""
    context, space = bpy.context, driver.area.spaces.active
    result = context.scene.fcn.result.fcn_result
    objects = list(context.scene.fcn.result.all_objects)
    return {
        "mode": context.mode,
        "view": result.view,
        "active": context.view_layer.objects.active.name if context.view_layer.objects.active else "",
        "selected": sorted(o.name for o in objects if o.select_get()),
        "visible": sorted(o.name for o in objects if o.visible_get()),
        "rejected": sorted(o.name for o in objects if "rejected" in o),
        "shared": sorted((o.name, o.data.name) for o in objects if o.data is not None),
        "alone": bool(space.local_view),
        "faint": space.overlay.show_fade_inactive,
    }


def press(driver, name, **more):
    with driver.context():
        operator = getattr(bpy.ops.fcn, name)
        assert operator.poll(), f"{name} cannot run in {bpy.context.mode}"
        assert operator("INVOKE_DEFAULT", True, **more) == {"FINISHED"}, name


def undo(driver, again=False):
    with driver.context():
        (bpy.ops.ed.redo if again else bpy.ops.ed.undo)()


def difference(a, b):
    return {key: (a[key], b[key]) for key in a if a[key] != b[key]}


# What is pressed one after the other; each first, then back and forth. `walk` has Make Unique.
WALKS = (
    ("select_occurrence", "reject_occurrence", "restore"),
    ("edit_template", "edit_template", "select_source", "select_result"),
    ("reject_occurrence", "select_template", "select_source"),
    ("select_template", "delete_occurrence", "select_template"),
)


def choose(item):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item


def pairs(driver):
    """All walks; a generator. The scene is as it was at the end."""
    for names in WALKS:
        root = bpy.context.scene.fcn.result
        item = next(o for o in root.all_objects if "support" in o and o["occurrence"] == 1 and o.visible_get())
        choose(item)
        bpy.ops.ed.undo_push(message="Start")
        yield 0.3
        states = [state(driver)]
        for name in names:
            press(driver, name)
            yield 0.1
            states.append(state(driver))
        yield from back_and_forth(driver, names, states)


def back_and_forth(driver, names, states):
    """Undo to the start, redo to the end, undo at once to the start: each state must be one that was there before."""
    for i in reversed(range(len(names))):
        yield from to(driver, states[i], f"undo of {names[i]} in {names}")
    for i in range(1, len(states)):
        yield from to(driver, states[i], f"redo of {names[i - 1]} in {names}", again=True)
    yield from to(driver, states[0], f"all undone of {names}", most=2 * len(names))


def to(driver, wanted, what, again=False, most=2):
    """One step, or two where edit mode is entered: Blender has a step of its own for that."""
    for _ in range(most):
        undo(driver, again)
        yield 0.1
        found = difference(wanted, state(driver))
        if not found:
            return
    raise AssertionError(f"{what}: {found}")


def place_of(driver, item):
    """(x, y) in the window of the middle of a curve's first segment."""
    from bpy_extras.view3d_utils import location_3d_to_region_2d

    region, space = driver.region("WINDOW"), driver.area.spaces.active
    a, b = item.data.splines[0].bezier_points[:2]
    half = 0.125 * a.co + 0.375 * a.handle_right + 0.375 * b.handle_left + 0.125 * b.co
    place = location_3d_to_region_2d(region, space.region_3d, item.matrix_world @ half)
    return region.x + place[0], region.y + place[1]


def clicks(driver, count=5):
    """Clicks on completed curves, before a scan behind them: each takes a curve; a generator."""
    root = bpy.context.scene.fcn.result
    parts = [o for o in root.all_objects if "support" in o and o.visible_get() and o.type == "CURVE"]
    corners = [o.matrix_world @ o.data.splines[0].bezier_points[0].co for o in parts]
    low, high = (tuple(f(c[i] for c in corners) for i in range(3)) for f in (min, max))
    mesh = bpy.data.meshes.new("Behind")
    back = high[1] + 0.5
    mesh.from_pydata(
        [(low[0] - 1, back, low[2] - 1), (high[0] + 1, back, low[2] - 1), (high[0] + 1, back, high[2] + 1),
         (low[0] - 1, back, high[2] + 1)], [], [(0, 1, 2, 3)]
    )  # fmt: skip
    scan = bpy.data.objects.new("Behind", mesh)
    bpy.context.scene.collection.objects.link(scan)
    scan.hide_select = True
    with driver.context():
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_all()
    yield 0.5
    taken = 0
    for item in parts[:: max(1, len(parts) // count)][:count]:
        yield from driver.click(*place_of(driver, item))
        yield 0.2
        active = bpy.context.view_layer.objects.active
        taken += active is not None and active.get("occurrence") is not None and active.select_get()
    bpy.data.objects.remove(scan)
    driver.note(f"{taken} of {count} clicks took a completed curve")
    assert taken == count
