# SPDX-License-Identifier: GPL-3.0-or-later
"""The templates of a result as a list: their names, colours, which are shown, and the occurrences of the active one.

All is kept on the objects: a template's by the number in their "template", a rejected one by "rejected". The rows are a
view of that, so what is renamed, deleted or rejected elsewhere is right here too after `count`.
"""

from __future__ import annotations

from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty
from bpy.types import PropertyGroup

from .. import colours
from ..scene.curve_data import TWIN
from ..scene.families import children, within
from ..wording import letters
from . import views

PART = "support"  # a custom property that the curves of occurrences have, and their empties have not


def of_template(root, ident) -> list:
    """All objects of a template's occurrences, empties and curves."""
    home = views.child(root, "templates")
    return [] if home is None else [item for item in within(home) if item.get("template", -1) == ident]


def holders(root, ident) -> list:
    """The empties of a template's occurrences, in their order."""
    found = [item for item in of_template(root, ident) if PART not in item]
    return sorted(found, key=lambda item: item["occurrence"])


def count(root):
    """Count again what is left of each template, and rename what belongs to a renamed one."""
    rows = root.fcn_result.template_rows
    left = {row.ident: [0, 0] for row in rows}
    home = views.child(root, "templates")
    for item in within(home) if home else ():
        if PART not in item and item.get("template", -1) in left:
            left[item["template"]]["rejected" in item] += 1
    for row in rows:
        row.count, row.rejected = left[row.ident]
    fill_places(root)
    for row in root.fcn_result.transformations:
        mine = within(row.home) if row.home else ()
        row.count = sum(PART not in item and "rejected" not in item for item in mine)
        row.curves = sum(PART in item and "rejected" not in item for item in mine)


def _renamed(row, _context):
    """Called by Blender: the objects of the template are called after it."""
    root = row.id_data
    for item in of_template(root, row.ident):
        place = item["occurrence"] + 1
        if PART in item:
            part = item.data.get("part", 0)
            if "unique" not in item:
                _call(item.data, f"{row.name} {part + 1}" + (f" at {place}" if TWIN in item.data else ""))
            _call(item, f"{row.name} {part + 1} at {place}")
        else:
            _call(item, f"{row.name} at {place}")


def _call(block, name):
    """Name a data block. Blender looks for a free name and sorts again even where it has this one already."""
    if block.name != name:
        block.name = name


def settle_names(root):
    """Call all objects after their templates: while an earlier result was there too, its objects had these names."""
    for row in root.fcn_result.template_rows:
        _renamed(row, None)
    fill_places(root)


def _shown(row, _context):
    views.refresh(row.id_data)


def _coloured(row, _context):
    views.refresh(row.id_data)


def fill_places(root):
    """Make the list of places that of the active template."""
    result, row = root.fcn_result, active(root)
    result.places.clear()
    for item, parts in children(holders(root, row.ident) if row else ()).items():
        place = result.places.add()
        place.name = item.name
        if "rejected" in item:  # kept is the default, and setting it looks for the object
            place.kept = False
        supports = [part[PART] for part in parts if PART in part]
        place.support = sum(supports) / len(supports) if supports else 0.0


def _kept(place, _context):
    """Called by Blender: take this occurrence out of the result or back in."""
    root = place.id_data
    item = next((o for o in within(root) if o.name == place.name), None)
    if item is not None and ("rejected" in item) == place.kept:
        set_rejected(item, not place.kept)
        views.refresh(root)
        count(root)


def chosen(group, context):
    """Called by Blender when another template becomes the active one."""
    fill_places(group.id_data)
    views.update_solo(group, context)


class FCN_PG_place(PropertyGroup):
    """One occurrence of the active template; `name` is that of its empty."""

    kept: BoolProperty(
        name="Keep", description="Switched off, this occurrence is rejected and stays out of the result", default=True,
        update=_kept,
    )  # fmt: skip
    support: FloatProperty(name="Support", description="How much of its curves the input shows here")


class FCN_PG_template(PropertyGroup):
    """One template of a result, as the list shows it; `name` is what the user calls it."""

    name: StringProperty(name="Name", description="What this template is called, here and in the outliner",
                         update=_renamed)  # fmt: skip
    ident: IntProperty(name="Number", description="Its number in the report")
    count: IntProperty(name="Occurrences", description="How many occurrences there are, without rejected ones")
    rejected: IntProperty(name="Rejected", description="How many occurrences were rejected")
    support: FloatProperty(
        name="Support", description="How much of its curves the input shows, on average over its occurrences"
    )
    shown: BoolProperty(name="Show", description="Show this template in the viewport", default=True, update=_shown)
    colour: FloatVectorProperty(
        name="Colour", description="Its colour in the view Templates", subtype="COLOR", size=3, min=0.0, max=1.0,
        update=_coloured,
    )  # fmt: skip


def describe(root, completion, names):
    """Fill in the rows of a result; `names` has those that are not to be letters."""
    for t, template in enumerate(completion.templates):
        row = root.fcn_result.template_rows.add()
        row.ident = int(template.id)
        row.name = names.get(template.id, f"Template {letters(t)}")
        row.colour = colours.distinct(int(template.id))
        row.count = len(template.occurrences)
        row.support = float(template.evidence.mean()) if template.evidence.size else 0.0


def kept_names(earlier, completion) -> dict:
    """Template id -> name, for templates most of whose occurrences stand where a named one of an earlier result stood.

    earlier : results that the new one replaces
    """
    import numpy as np
    from scipy.spatial import cKDTree

    named = {}
    places = [
        (row.name, item.matrix_world.translation)
        for root in earlier
        for row in root.fcn_result.template_rows
        for item in holders(root, row.ident)
    ]
    if not places:
        return named
    tree, owner = cKDTree([tuple(place) for _, place in places]), [name for name, _ in places]
    taken = set()
    for template in completion.templates:
        points = np.concatenate([c.points for c in template.curves])
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        now = template.occurrences[:, :3, :3] @ centre + template.occurrences[:, :3, 3]
        distance, near = tree.query(now)
        found = [owner[k] for k, d in zip(near, distance) if d <= 0.25 * size]
        best = max(sorted(set(found)), key=found.count, default=None)
        if best is not None and best not in taken and 2 * found.count(best) > len(now):
            named[template.id] = best
            taken.add(best)
    spare = (f"Template {letters(i)}" for i in range(10**6))
    for template in completion.templates:
        if template.id not in named:
            named[template.id] = next(name for name in spare if name not in taken)
    return named


def active(root):
    """The chosen row, None if there is none."""
    rows, index = root.fcn_result.template_rows, root.fcn_result.active_template
    return rows[index] if index < len(rows) else None


def set_rejected(item, rejected):
    """Take an occurrence out or back in: its empty and its curves."""
    for part in (item, *item.children):
        if rejected:
            part["rejected"] = True
        elif "rejected" in part:
            del part["rejected"]
