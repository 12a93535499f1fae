# SPDX-License-Identifier: GPL-3.0-or-later
"""Edge meshes and curve objects of a scene as curves, its meshes as surfaces: evaluated, in world space."""

from __future__ import annotations

from dataclasses import dataclass, replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError
from ...core.files.network import Reading, concatenate, curves_of_chains, curves_of_samples
from ...core.geometry.chains import chains_of_edges

KINDS = ("MESH", "CURVE", "CURVES")
STRENGTH = "curvature"  # a float attribute of the points, 1 / length
KIND = "kind"  # an int attribute of the points of detected curves, index into core.detection.KINDS
NORMAL = "surface_normal"  # a vector attribute of theirs, the normal of the scan
EDGE_LENGTH = "edge_length"  # a custom property of detected curves: the mean edge length of their scan


@dataclass(frozen=True)
class SceneReading:
    """Curves of objects.

    names : the objects that were read
    owner : (reading.count,) int64, which of them each input curve comes from
    """

    reading: Reading
    names: tuple[str, ...]
    owner: np.ndarray


def curve_objects(objects) -> list:
    """Those that may hold curves: curve objects, and meshes that have edges and no faces."""
    return [o for o in objects if o.type in KINDS and (o.type != "MESH" or (o.data.edges and not o.data.polygons))]


def is_surface(item) -> bool:
    """Whether an object is a mesh with faces, in which curves can be detected."""
    return item.type == "MESH" and len(item.data.polygons) > 0


def read_surface(item, depsgraph):
    """Points (n, 3) float64 and triangles (m, 3) int64 of a mesh object, polygons cut as Blender cuts them.

    Raises InputError for other types, no faces, coordinates that are not finite.
    """
    if item.type != "MESH":
        text = rpt_("object {name!r} is of type {type}; choose a mesh with faces")
        raise InputError(text.format(name=item.name, type=item.type))
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.polygons:
            text = rpt_("object {name!r} has no faces; choose a scan, or complete its curves directly")
            raise InputError(text.format(name=item.name))
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        mesh.calc_loop_triangles()
        triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", triangles)
    finally:
        evaluated.to_mesh_clear()
    matrix = np.array(evaluated.matrix_world, float)
    triangles = triangles.reshape(-1, 3).astype(np.int64)
    if np.linalg.det(matrix[:3, :3]) < 0:  # mirrored: what was outside is inside
        triangles = triangles[:, ::-1]
    return _world(item.name, points, matrix), triangles


def read_objects(objects, depsgraph) -> SceneReading:
    """Read objects in the order given.

    Raises InputError for one of another type, a surface, one without curves, coordinates that are not finite.
    """
    objects = list(objects)
    if not objects:
        raise InputError("no curves are chosen; choose edge meshes or curve objects")
    readings = [_read_object(o, depsgraph) for o in objects]
    owner = np.repeat(np.arange(len(objects)), [r.count for r in readings])
    return SceneReading(concatenate(readings), tuple(o.name for o in objects), owner)


def _read_object(item, depsgraph) -> Reading:
    if item.type not in KINDS:
        text = rpt_("object {name!r} is of type {type}; choose edge meshes or curve objects")
        raise InputError(text.format(name=item.name, type=item.type))
    evaluated = item.evaluated_get(depsgraph)
    matrix = np.array(item.matrix_world if evaluated is None else evaluated.matrix_world, float)
    if evaluated.type == "CURVES":
        return _read_hair(item.name, evaluated.data, matrix)
    if item.type == "CURVE" and not item.modifiers and _is_thick(item.data):
        return _read_thin(item, matrix)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.edges:
            text = rpt_("object {name!r} has no edges; choose edge meshes or curve objects")
            raise InputError(text.format(name=item.name))
        if mesh.polygons:
            if item.type == "CURVE":
                text = rpt_("object {name!r} is a surface of {faces} faces; set its bevel to 0 or apply its modifiers")
            else:
                text = rpt_("object {name!r} is a surface of {faces} faces; detect its feature curves first")
            raise InputError(text.format(name=item.name, faces=len(mesh.polygons)))
        reading = _read_mesh(item.name, mesh, matrix)
        return replace(reading, edge_length=_known_edge_length(item, matrix))
    finally:
        evaluated.to_mesh_clear()


def _is_thick(data) -> bool:
    return bool(data.bevel_depth or data.extrude or data.bevel_object or data.dimensions == "2D")


def _read_thin(item, matrix) -> Reading:
    """A curve with a bevel or a fill, read without it from a copy that is gone afterwards."""
    data = item.data.copy()
    data.dimensions, data.bevel_depth, data.extrude, data.bevel_object = "3D", 0.0, 0.0, None
    thin = bpy.data.objects.new(item.name, data)
    try:
        return _read_mesh(item.name, thin.to_mesh(), matrix)
    finally:
        thin.to_mesh_clear()
        bpy.data.objects.remove(thin)
        bpy.data.curves.remove(data)


def _read_mesh(name, mesh, matrix) -> Reading:
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    strength = _floats(mesh.attributes.get(STRENGTH), len(mesh.vertices), matrix)
    points = _world(name, points, matrix)
    chains = chains_of_edges(edges.reshape(-1, 2))
    surface = _surface(mesh, matrix)
    return curves_of_chains(f"object {name!r}", points, chains, strength, **surface)


def _read_hair(name, data, matrix) -> Reading:
    """The newer curve type: points as an attribute, curves as ranges of them."""
    count = len(data.points)
    if count == 0:
        raise InputError(rpt_("object {name!r} has no points; choose edge meshes or curve objects").format(name=name))
    points = np.empty(3 * count, np.float32)
    data.attributes["position"].data.foreach_get("vector", points)
    first = np.empty(len(data.curves), np.int32)
    data.curves.foreach_get("first_point_index", first)
    cyclic = data.attributes.get("cyclic")
    closed = np.zeros(len(first), bool)
    if cyclic is not None:
        cyclic.data.foreach_get("value", closed)
    strength = _floats(data.attributes.get(STRENGTH), count, matrix)
    offsets = np.r_[first, count].astype(np.int64)
    points = _world(name, points, matrix)
    return curves_of_samples(f"object {name!r}", points, offsets, closed, np.arange(len(first)), strength)


def _world(name, points, matrix) -> np.ndarray:
    """(n, 3) float64, local coordinates in world space."""
    points = points.reshape(-1, 3).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        text = rpt_("object {name!r}: vertex {vertex} is not finite; remove it or correct it")
        raise InputError(text.format(name=name, vertex=wrong[0]))
    return points


def _surface(mesh, matrix):
    """Normals in world space and kinds of the points of detected curves, empty for other meshes."""
    normal, kind = mesh.attributes.get(NORMAL), mesh.attributes.get(KIND)
    for attribute, data_type in ((normal, "FLOAT_VECTOR"), (kind, "INT")):
        if attribute is None or attribute.domain != "POINT" or attribute.data_type != data_type:
            return {}
    normals, kinds = np.empty(3 * len(mesh.vertices), np.float32), np.empty(len(mesh.vertices), np.int32)
    normal.data.foreach_get("vector", normals)
    kind.data.foreach_get("value", kinds)
    # Normals go with the inverse transpose; a mirrored scan turns none of them inside out.
    cofactor = np.linalg.pinv(matrix[:3, :3]).T
    normals = normals.reshape(-1, 3).astype(float) @ cofactor.T
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not np.isfinite(length).all() or not (length > 0).all():
        return {}
    return {"normals": normals / length, "kind": kinds.astype(np.int64)}


def _known_edge_length(item, matrix):
    """Mean edge length of the scan that detected curves come from in world space, None where it is not known."""
    value = item.get(EDGE_LENGTH)
    if not isinstance(value, float) or not np.isfinite(value) or value <= 0:
        return None
    return value * abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3) or None


def _floats(attribute, count, matrix):
    """Curvature of the points in world space, which scales with the inverse of the object's mean scale."""
    if attribute is None or attribute.domain != "POINT" or attribute.data_type != "FLOAT":
        return None
    values = np.empty(count, np.float32)
    attribute.data.foreach_get("value", values)
    scale = abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
    return np.nan_to_num(np.abs(values.astype(np.float64)) / (scale or 1.0), posinf=0.0)
