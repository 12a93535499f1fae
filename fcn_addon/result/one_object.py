# SPDX-License-Identifier: GPL-3.0-or-later
"""What is visible of a result as one object, which other programs and geometry nodes understand."""

from __future__ import annotations

import bpy
import numpy as np

from ...core.errors import InputError
from .. import colours
from ..reading import reader
from ..scene import curve_data
from ..scene.families import within
from ..shifts import held_middle
from . import stored

LABELS = ("template", "component", "occurrence")


def visible_curves(root) -> list:
    """The completed curves of a result that can be seen now."""
    homes = [home for home in (stored.child(root, "templates"), stored.child(root, "strong")) if home]
    return [o for home in homes for o in within(home) if "support" in o and o.visible_get()]


def make(root, context, kind):
    """One object of all visible curves, linked beside the result; kind is "CURVE", "MESH" or "CURVES".

    The mesh has the support and the labels as attributes of its points, the new curves of each curve.
    Raises InputError where nothing is visible.
    """
    objects = visible_curves(root)
    if not objects:
        raise InputError("no completed curve is visible; switch the view to Result")
    if kind == "CURVE":
        return _link(_splines(f"{root.fcn_result.source} completed", objects), _middle(objects), context)
    read = reader.read_curves(objects, context.evaluated_depsgraph_get())
    curves = read.reading.curves
    support = np.array([o["support"] for o in objects], np.float32)
    values = {"support": support, **{n: np.array([o[n] for o in objects], np.int32) for n in LABELS}}
    owner = read.owner[curves.source]
    values = {name: every[owner] for name, every in values.items()}
    centre = held_middle(curves.points)
    data = MAKERS[kind](f"{root.fcn_result.source} completed", curves, curves.points - centre, values)
    return _link(data, centre, context)


def _link(data, centre, context):
    item = bpy.data.objects.new(data.name, data)
    item.location = centre
    item.color = (*colours.TEMPLATE, 1.0)
    context.scene.collection.objects.link(item)
    return item


def _middle(objects):
    """(3,) float64, about the middle of the places of objects: far from the origin, float32 holds what is near it."""
    places = np.array([item.matrix_world.translation for item in objects], float)
    return held_middle(places)


def _splines(name, objects):
    """Curve data with all splines of curve objects, handles kept, about their middle."""
    data, centre = curve_data.bezier_data(name, [], []), _middle(objects)
    for item in objects:
        matrix = np.array(item.matrix_world, float)
        matrix[:3, 3] -= centre
        for spline in item.data.splines if item.type == "CURVE" else ():
            if spline.type == "BEZIER":
                path = curve_data.bezier_path(spline) @ matrix[:3, :3].T + matrix[:3, 3]
                curve_data.add_bezier(data, path, spline.use_cyclic_u)
            else:
                points = curve_data.spline_points(spline) @ matrix[:3, :3].T + matrix[:3, 3]
                curve_data.add_poly(data, points, spline.use_cyclic_u)
    return data


def _mesh(name, curves, points, values):
    data = curve_data.mesh_data(name, curves, points)
    size = np.diff(curves.offsets)
    for label, every in values.items():
        _attribute(data, label, "POINT", np.repeat(every, size))
    return data


def _hair(name, curves, points, values):
    data = bpy.data.hair_curves.new(name)
    data.add_curves(np.diff(curves.offsets).tolist())
    data.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    if hasattr(data, "set_types"):
        data.set_types(type="POLY")  # before that they are Catmull-Rom curves, through the same points
    _attribute(data, "cyclic", "CURVE", curves.closed, kind="BOOLEAN")
    for label, every in values.items():
        _attribute(data, label, "CURVE", every)
    return data


def _attribute(data, name, domain, values, kind=None):
    kind = kind or ("FLOAT" if values.dtype.kind == "f" else "INT")
    attribute = data.attributes.get(name) or data.attributes.new(name, kind, domain)
    attribute.data.foreach_set("value", values)


MAKERS = {"MESH": _mesh, "CURVES": _hair}
