# SPDX-License-Identifier: GPL-3.0-or-later
"""Every operator is one step of undo: pairs of them in a real window, with undo and redo, whole states compared.

Runs inside a session that has a result; see `whole_session`.
"""

import bpy


def state(driver):
    """All that undo must bring back: mode, view, selection, visibility, templates, local view, fading."""
    context, space = bpy.context, driver.area.spaces.active
    result = context.scene.fcn.result.fcn_result
    objects = [o for o in context.scene.fcn.result.all_objects]
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


# What is pressed one after the other; each first, then back and forth.
WALKS = (
    ("select_occurrence", "reject_occurrence", "restore"),
    ("edit_template", "edit_template", "select_source", "select_result"),
    ("select_source", "select_result", "make_unique"),
    ("make_unique", "edit_template", "edit_template"),
    ("reject_occurrence", "select_template", "select_source"),
    ("select_template", "delete_occurrence", "select_template"),
)


def choose(item):
    for other in bpy.context.selected_objects:
        other.select_set(False)
    item.select_set(True)
    bpy.context.view_layer.objects.active = item


def walk(driver):
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
            yield 0.4
            states.append(state(driver))
        yield from back_and_forth(driver, names, states)


def back_and_forth(driver, names, states):
    """Undo to the start, redo to the end, undo again: each state must be one that was there before."""
    for i in reversed(range(len(names))):
        yield from to(driver, states[i], f"undo of {names[i]} in {names}")
    for i in range(1, len(states)):
        yield from to(driver, states[i], f"redo of {names[i - 1]} in {names}", again=True)
    for i in reversed(range(len(names))):
        yield from to(driver, states[i], f"second undo of {names[i]} in {names}")


def to(driver, wanted, what, again=False):
    """One step, or two where edit mode is entered: Blender has a step of its own for that."""
    for _ in range(2):
        undo(driver, again)
        yield 0.4
        found = difference(wanted, state(driver))
        if not found:
            return
    raise AssertionError(f"{what}: {found}")
