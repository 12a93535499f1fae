# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as Blender draws them, where only Blender knows how: it evaluates them in a scene that is gone afterwards.

That serves hair curves with Bezier, Catmull-Rom and NURBS splines, curves that geometry nodes make, and curve objects
with a bevel under modifiers, which are read as the path that the bevel follows.
"""

from __future__ import annotations

from contextlib import contextmanager

import bpy
import numpy as np

from .geometry import MeshParts, read_mesh

POLY = 1  # of the attribute curve_type
# Nodes that leave the curves alone and turn them into edges, each with its entry and its exit.
CURVES = (("SeparateComponents", "Geometry", "Curve"), ("CurveToMesh", "Curve", "Mesh"))
INSTANCES = (("RealizeInstances", "Geometry", "Geometry"), *CURVES)
STROKES = (("GreasePencilToCurves", "Grease Pencil", "Curves"), *INSTANCES)


def needs_drawing(attributes, count) -> bool:
    """Whether curves, by their attributes, are drawn otherwise than straight from point to point."""
    types = attributes.get("curve_type")
    if types is None:
        return count > 0  # they are Catmull-Rom curves
    values = np.empty(len(types.data), np.int32)
    types.data.foreach_get("value", values)
    return bool((values != POLY).any())


def hair_curves(data) -> MeshParts:
    """Evaluated hair curves as wires."""
    copy = data.copy()
    try:
        item = bpy.data.objects.new("Drawn", copy)
        return _evaluated(item, CURVES)
    finally:
        bpy.data.hair_curves.remove(copy)


def curves_of_nodes(original) -> MeshParts:
    """The curves, instances of curves too, that the modifiers of an object make; without its meshes."""
    with _thin_copy(original) as item:
        return _evaluated(item, INSTANCES)


def strokes(original) -> MeshParts:
    """The strokes of Grease Pencil, from Blender 4.3 on, as wires."""
    with _thin_copy(original) as item:
        return _evaluated(item, STROKES)


def path(original) -> MeshParts:
    """A curve object as wires under its modifiers, without bevel, extrusion and filling."""
    with _thin_copy(original) as item:
        return _evaluated(item, ())


def plain_path(data) -> MeshParts:
    """A curve as wires without bevel, extrusion and filling, and without any modifier; no scene is touched."""
    data = data.copy()
    thin = bpy.data.objects.new("Drawn", data)
    try:
        _make_thin(data)
        return read_mesh(thin.to_mesh())
    finally:
        thin.to_mesh_clear()
        bpy.data.objects.remove(thin)
        bpy.data.curves.remove(data)


def is_thick(data) -> bool:
    """Whether a curve is drawn as more than its path."""
    return bool(data.bevel_depth or data.extrude or data.bevel_object or data.dimensions == "2D")


def _make_thin(data):
    data.dimensions, data.bevel_depth, data.extrude, data.bevel_object = "3D", 0.0, 0.0, None


@contextmanager
def _thin_copy(original):
    """A copy of an object with its modifiers, at the origin; of a curve, without bevel. Its data goes at the end."""
    item = original.copy()
    data = None
    try:
        item.parent = None
        item.animation_data_clear()
        item.matrix_world = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
        item.hide_viewport = False
        item.constraints.clear()
        if item.type == "CURVE":
            data = item.data = item.data.copy()
            _make_thin(data)
        yield item
    finally:
        if data is not None:
            bpy.data.curves.remove(data)  # with it goes the object, where it is still there


def _evaluated(item, steps) -> MeshParts:
    """What an object is in a scene of its own; the object is gone afterwards.

    steps : nodes that its geometry goes through at the end
    """
    scene = bpy.data.scenes.new("Drawn")
    nodes = None
    try:
        scene.collection.objects.link(item)
        if steps:
            nodes = _group(steps)
            item.modifiers.new("Drawn", "NODES").node_group = nodes
        layer = scene.view_layers[0]
        layer.update()
        evaluated = item.evaluated_get(layer.depsgraph)
        if not steps:
            return _to_mesh(evaluated)
        found = [i.object.data for i in layer.depsgraph.object_instances if i.object.type == "MESH"]
        return read_mesh(found[0]) if found else MeshParts(None, None)
    finally:
        bpy.data.scenes.remove(scene)
        bpy.data.objects.remove(item)
        if nodes is not None:
            bpy.data.node_groups.remove(nodes)


def _to_mesh(evaluated) -> MeshParts:
    mesh = evaluated.to_mesh()
    try:
        return MeshParts(None, None) if mesh is None else read_mesh(mesh)
    finally:
        evaluated.to_mesh_clear()


def _group(steps):
    """Nodes one after the other."""
    group = bpy.data.node_groups.new("Drawn", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        group.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    last = group.nodes.new("NodeGroupInput").outputs[0]
    for kind, entry, leave in steps:
        node = group.nodes.new(f"GeometryNode{kind}")
        group.links.new(last, node.inputs[entry])
        last = node.outputs[leave]
    group.links.new(last, group.nodes.new("NodeGroupOutput").inputs[0])
    return group
