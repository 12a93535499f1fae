# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of a result on its collection, so that a reopened file can still be worked with."""

from __future__ import annotations

import json
from contextlib import contextmanager
from dataclasses import asdict

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from bpy.types import PropertyGroup

from .. import colours
from ..detected import scan_lock
from ..registration import register_classes, unregister_classes
from ..scene.families import within
from ..wording import description, titles
from . import attributes, templates, views

ICONS = {
    "single": "MOD_ARRAY",
    "translation": "THREE_DOTS",
    "grid": "MESH_GRID",
    "rotation": "DRIVER_ROTATIONAL_DIFFERENCE",
    "screw": "MOD_SCREW",
}


class FCN_PG_transformation(PropertyGroup):
    """One transformation of a result, as the list shows it; its `name` is the title."""

    short: StringProperty(name="Title", description="As much of the title as fits into the list")
    ident: IntProperty(name="Number", description="Its number in the report")
    kind: StringProperty(name="Kind")
    step: StringProperty(name="Step", description="How often and by how much")
    count: IntProperty(name="Occurrences", description="How many occurrences its templates have")
    curves: IntProperty(name="Curves", description="How many curves its occurrences have")
    support: FloatProperty(name="Support", description="Share of the length of all curves that recurs under it")
    log_bayes_factor: FloatProperty(
        name="Clearness", description="How much better it explains the curves than none, as a logarithm"
    )
    home: PointerProperty(type=bpy.types.Collection)
    kept: BoolProperty(
        name="Keep",
        description="Show what this transformation explains; switched off, it is rejected and stays out of the result",
        default=True,
        update=views.update,
    )


class FCN_PG_result(PropertyGroup):
    """The state of a result."""

    is_result: BoolProperty()
    source: StringProperty(name="Source", description="What the curves were called")
    objects: StringProperty(description="Names of the objects that were completed, as JSON")
    edge_length: FloatProperty(name="Edge Length", subtype="DISTANCE", precision=4)
    seconds: FloatProperty(name="Time")
    templates: IntProperty(name="Templates")
    occurrences: IntProperty(name="Occurrences")
    strong: IntProperty(name="Strong Curves")
    left_out: StringProperty(name="Left Out", description="What of the chosen objects was not taken, and why")
    noise: IntProperty(name="Noise", description="Input curves that were dropped")
    parameters: StringProperty(description="The parameters of the run, as JSON")
    view: EnumProperty(
        name="View",
        description="What of the result the viewport shows",
        items=views.ITEMS,
        update=views.update,
    )
    support: FloatProperty(
        name="Support",
        description="Hide curves of which the input shows less than this share of their length",
        subtype="FACTOR",
        min=0.0,
        max=1.0,
        update=views.update,
    )
    locked: StringProperty(description="Names of the scans that were made unselectable, as JSON")
    scan_locked: BoolProperty(
        name="Scan Not Selectable",
        description="Clicks go through the scan to the completed curves. Switch it off to select the scan again",
        default=True,
        update=scan_lock.update,
    )
    attributes: BoolProperty(
        name="Attributes for Geometry Nodes",
        description="Give every completed curve its support, component, template and occurrence as attributes, which "
        "geometry nodes can use. Large results get slower",
        update=attributes.update,
    )
    template_colour: FloatVectorProperty(
        name="Templates", description="Colour of the curves of templates in the view Result", subtype="COLOR", size=3,
        min=0.0, max=1.0, default=colours.TEMPLATE, update=views.update,
    )  # fmt: skip
    strong_colour: FloatVectorProperty(
        name="Single Curves", description="Colour of the curves that do not recur", subtype="COLOR", size=3,
        min=0.0, max=1.0, default=colours.STRONG, update=views.update,
    )  # fmt: skip
    transformations: CollectionProperty(type=FCN_PG_transformation)
    template_rows: CollectionProperty(type=templates.FCN_PG_template)
    active_template: IntProperty(
        name="Template", description="The template that the buttons are about", min=0, update=templates.chosen
    )
    places: CollectionProperty(type=templates.FCN_PG_place)
    active_place: IntProperty(name="Occurrence", description="The occurrence that is looked at", min=0)
    solo: BoolProperty(
        name="Solo",
        description="Show the occurrences of the active template alone",
        update=views.update,
    )
    active: IntProperty(name="Transformation", description="The transformation that the buttons are about", min=0)


CLASSES = (FCN_PG_transformation, templates.FCN_PG_template, templates.FCN_PG_place, FCN_PG_result)


def register():
    register_classes(CLASSES)
    bpy.types.Collection.fcn_result = PointerProperty(type=FCN_PG_result)


def unregister():
    del bpy.types.Collection.fcn_result
    unregister_classes(CLASSES)


@contextmanager
def known():
    """Within, Blender knows what results keep, also where the add-on is not enabled."""
    before = hasattr(bpy.types.Collection, "fcn_result")
    if not before:
        register()
    try:
        yield
    finally:
        if not before:
            unregister()


def describe(root, completion, run, length, names=None):
    """Fill in the properties of a result's collection.

    Parameters
    ----------
    root : Collection that `writer.write` made
    run : has label, sources, parameters and left_out
    length : turns a length into words
    names : template id -> what it is called; letters if None
    """
    result = root.fcn_result
    result.is_result = True
    result.source = run.label
    result.objects = json.dumps([source.name for source in run.sources])
    result.parameters = json.dumps(asdict(run.parameters))
    result.edge_length = completion.edge_length
    result.seconds = sum(completion.seconds.values())
    result.templates = len(completion.templates)
    result.occurrences = sum(len(t.occurrences) for t in completion.templates)
    result.strong = len(completion.strong)
    result.left_out = run.left_out.words()
    result.noise = int(np.count_nonzero(completion.inputs.kind == "noise"))
    templates.describe(root, completion, names or {})
    homes = {c["transformation"]: c for c in child(root, "templates").children}
    named = titles(completion.transformations, length)
    for t in completion.transformations:
        row = result.transformations.add()
        mine = [template for template in completion.templates if template.transformation == t.id]
        row.name, row.kind, row.step = named[t.id], t.kind, description(t, length)
        row.short = row.name.partition(",")[0]
        row.ident, row.home = t.id, homes[t.id]
        row.count = sum(len(template.occurrences) for template in mine)
        row.curves = sum(len(template.occurrences) * len(template.curves) for template in mine)
        row.support, row.log_bayes_factor = t.support, t.log_bayes_factor
    templates.fill_places(root)


def child(root, role):
    """The collection of a result that has a role: input, templates, components, strong or noise; None if removed."""
    return views.child(root, role)


def shown_in(scene) -> list:
    """The collections of a scene that hold results, those of linked files too."""
    return [c for c in scene.collection.children_recursive if c.fcn_result.is_result]


def of_scene(scene) -> list:
    """The collections of a scene that hold results which can be changed: not those of linked files."""
    return [root for root in shown_in(scene) if root.library is None]


def active(scene):
    """The result that the panel is about, None if there is none."""
    chosen = scene.fcn.result
    found = of_scene(scene)
    if chosen is not None and chosen in found:
        return chosen
    return found[-1] if found else None


def active_transformation(scene):
    """The chosen row of the active result, None if there is none."""
    root = active(scene)
    if root is None:
        return None
    rows = root.fcn_result.transformations
    return rows[root.fcn_result.active] if root.fcn_result.active < len(rows) else None


def source_names(root) -> list[str]:
    """Names of the objects that a result was made of."""
    return json.loads(root.fcn_result.objects or "[]")


def remove(root):
    """Remove a result with all data that nothing else uses; what is also linked elsewhere stays."""
    scan_lock.unlock(root)
    tree = {root, *root.children_recursive}
    remove_objects([o for o in within(root) if tree.issuperset(o.users_collection)], tree)


def remove_objects(objects, collections=()):
    """Remove objects, and collections, with all data that nothing else uses."""
    data = list(dict.fromkeys(o.data for o in objects if o.data is not None))
    bpy.data.batch_remove([*objects, *collections])
    bpy.data.batch_remove([d for d in data if d.users == 0])
