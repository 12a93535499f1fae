# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a result is seen, and in which colours. All of it follows from what is stored in the file."""

from __future__ import annotations

import numpy as np

from .. import colours

ITEMS = (
    ("RESULT", "Result", "The completed curves: templates dark blue, strong single curves light blue"),
    ("COMPONENTS", "Components", "The completed curves and the input that shows them, a colour per component"),
    ("TEMPLATES", "Templates", "The completed curves, a colour per template"),
    ("INPUT", "Input", "The curves as they were"),
)
SHOWN = {
    "RESULT": {"templates", "strong"},
    "COMPONENTS": {"components"},
    "TEMPLATES": {"templates", "strong"},
    "INPUT": {"input"},
}
ROLE = "fcn_role"  # of a result's collections, which users may rename


def child(root, role):
    """The collection of a result that has a role, None if it was removed."""
    return next((c for c in root.children if c.get(ROLE) == role), None)


def can_show(root, view) -> bool:
    """Whether a result has what a view shows."""
    return any(collection.get(ROLE) in SHOWN[view] for collection in root.children)


def update(group, _context):
    """Called by Blender when a property of a result changes."""
    root = group.id_data
    if root.fcn_result.is_result:
        refresh(root)


def update_solo(group, context):
    """Called by Blender when another template becomes the active one."""
    if group.solo:
        update(group, context)


def refresh(root):
    """Show what the view, the support and the rejections say.

    Notes
    -----
    O(objects). Blender walks all objects of the file whenever the visibility of one is set, so the flags are written
    in bulk and only the last one the usual way, which makes Blender look once.
    """
    result = root.fcn_result
    view = result.view
    for collection in root.children:
        role = collection.get(ROLE)
        if role in {"input", "templates", "components", "strong"}:
            _hide(collection, role not in SHOWN[view])
    templates, strong, components = (child(root, role) for role in ("templates", "strong", "components"))
    kept = {row.home: row.kept for row in result.transformations if row.home is not None}
    out = _hidden_templates(result)
    own = {row.ident: tuple(row.colour) for row in result.template_rows}
    for home in templates.children if templates else ():
        gone = not kept.get(home, True)
        _hide_objects(home, [gone or _is_out(o, result.support) or o.get("template") in out for o in home.objects])
        _colour(home, view, own, tuple(result.template_colour))
    if strong:
        _hide_objects(strong, [_is_out(o, result.support) for o in strong.objects])
        for item in strong.objects:
            _paint(item, tuple(result.strong_colour))
    for home in components.children if components else ():
        # The curves are those of the templates and hidden with them; the input pieces belong to this view alone.
        _hide_objects(home, [o.hide_viewport if "support" in o else view != "COMPONENTS" for o in home.objects])


def _hidden_templates(result) -> set:
    """Numbers of the templates that are switched off, or all but the active one."""
    rows = result.template_rows
    alone = rows[result.active_template].ident if result.solo and result.active_template < len(rows) else None
    return {row.ident for row in rows if not row.shown or alone is not None and row.ident != alone}


def _is_out(item, least) -> bool:
    """Whether an object is rejected or shown by too little of the input."""
    return bool(item.get("rejected", False)) or item.get("support", 1.0) < least - 1e-6


def _hide(collection, hidden):
    if collection.hide_viewport != hidden:
        collection.hide_viewport = collection.hide_render = hidden


def _hide_objects(collection, hidden):
    objects = collection.objects
    hidden = np.array(hidden, bool)
    before = np.zeros(len(hidden), bool)
    objects.foreach_get("hide_viewport", before)
    changed = np.flatnonzero(before != hidden)
    if len(changed):
        objects.foreach_set("hide_render", hidden)
        last = int(changed[-1])
        value = bool(hidden[last])
        hidden[last] = not value
        objects.foreach_set("hide_viewport", hidden)
        objects[last].hide_viewport = value
        # The evaluated copies must learn of it too, or they write their own flags back.
        for i in changed.tolist():
            objects[i].update_tag(refresh={"OBJECT"})


def _colour(home, view, own, plain):
    """Colours of the curves in a transformation's collection; `plain` is that of all templates."""
    for item in home.objects:
        if item.type != "EMPTY":
            _paint(item, _colour_of(item, view, own, plain))


def _paint(item, rgb):
    colour = (*rgb, 1.0)
    if any(abs(a - b) > 1e-6 for a, b in zip(item.color, colour)):
        item.color = colour


def _colour_of(item, view, own, plain):
    if view == "COMPONENTS":
        return colours.distinct(item.get("component", -1))
    if view == "TEMPLATES":
        label = item.get("template", -1)
        return own.get(label) or colours.distinct(label)
    return plain
