# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated geometry as arrays: first in its own space, then in world space."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError
from ...core.files.reading import Reading, curves_of_chains, curves_of_samples
from ...core.geometry.chains import chains_of_edges
from ..scene.curve_data import KIND, NORMAL, STRENGTH


@dataclass(frozen=True)
class Wires:
    """Edges over shared points.

    points : (n, 3) float64; edges : (k, 2) int64
    strength, normals, kind : (n,), (n, 3) and (n,) of the points, None where they are not known
    """

    points: np.ndarray
    edges: np.ndarray
    strength: np.ndarray | None = None
    normals: np.ndarray | None = None
    kind: np.ndarray | None = None


@dataclass(frozen=True)
class Lines:
    """Polylines: points (n, 3) float64, of curve i from offsets[i] to offsets[i + 1]; closed (m,) bool."""

    points: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    strength: np.ndarray | None = None


@dataclass(frozen=True)
class Surface:
    """Points (n, 3) float64 and triangles (m, 3) int64, polygons cut as Blender cuts them."""

    points: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class MeshParts:
    """What a mesh holds.

    wires : its edges that are of no face, None where it has none
    surface : its faces, None where it has none
    """

    wires: Wires | None
    surface: Surface | None


def read_mesh(mesh) -> MeshParts:
    """The loose edges and the faces of a mesh."""
    points = _vectors(mesh.vertices, "co")
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    edges = edges.reshape(-1, 2).astype(np.int64)
    if not len(mesh.polygons):
        return MeshParts(_wires(mesh, points, edges) if len(edges) else None, None)
    of_face = np.zeros(len(edges), bool)
    loops = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", loops)
    of_face[loops] = True
    mesh.calc_loop_triangles()
    triangles = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    surface = Surface(points, triangles.reshape(-1, 3).astype(np.int64))
    return MeshParts(None if of_face.all() else _wires(mesh, points, edges[~of_face]), surface)


def _wires(mesh, points, edges) -> Wires:
    kind, normals = mesh.attributes.get(KIND), mesh.attributes.get(NORMAL)
    if not (_is(normals, "FLOAT_VECTOR") and _is(kind, "INT")):
        return Wires(points, edges, _strength(mesh.attributes, len(points)))
    kinds = np.empty(len(points), np.int32)
    kind.data.foreach_get("value", kinds)
    return Wires(
        points, edges, _strength(mesh.attributes, len(points)), _vectors(normals.data, "vector"), kinds.astype(np.int64)
    )


def read_lines(attributes, sizes) -> Lines:
    """Polylines of hair curves, or of a drawing of Grease Pencil: attributes of points, and how many each curve has."""
    count = int(np.sum(sizes))
    closed = np.zeros(len(sizes), bool)
    cyclic = attributes.get("cyclic")
    if cyclic is not None and len(closed):
        cyclic.data.foreach_get("value", closed)
    points = _vectors(attributes["position"].data, "vector") if count else np.zeros((0, 3))
    return Lines(points, np.r_[0, np.cumsum(sizes)].astype(np.int64), closed, _strength(attributes, count))


def in_world(name, local, matrix):
    """Wires, Lines or a Surface under a (4, 4) matrix that may scale, shear and mirror.

    Raises InputError where a coordinate is not finite.
    """
    points = local.points @ matrix[:3, :3].T + matrix[:3, 3]
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        text = rpt_("object {name!r}: vertex {vertex} is not finite; remove it or correct it")
        raise InputError(text.format(name=name, vertex=wrong[0]))
    if isinstance(local, Surface):  # mirrored: what was outside is inside
        mirrored = np.linalg.det(matrix[:3, :3]) < 0
        return Surface(points, local.triangles[:, ::-1] if mirrored else local.triangles)
    strength = None if local.strength is None else local.strength / (mean_scale(matrix) or 1.0)
    moved = replace(local, points=points, strength=strength)
    if isinstance(local, Wires) and local.normals is not None:
        normals, kind = _moved_normals(local, matrix)
        return replace(moved, normals=normals, kind=kind)
    return moved


def _moved_normals(local, matrix):
    """Normals go with the inverse transpose; a mirrored scan turns none of them inside out."""
    normals = local.normals @ np.linalg.pinv(matrix[:3, :3])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not np.isfinite(length).all() or not (length > 0).all():
        return None, None
    return normals / length, local.kind


def mean_scale(matrix) -> float:
    """By how much a matrix scales lengths, as the mean of the three directions."""
    return abs(float(np.linalg.det(matrix[:3, :3]))) ** (1 / 3)


def as_reading(name, geometry) -> Reading:
    """Wires or Lines in world space as curves. Raises InputError where none has two different points."""
    where = f"object {name!r}"
    if isinstance(geometry, Wires):
        chains = chains_of_edges(geometry.edges)
        return curves_of_chains(
            where, geometry.points, chains, geometry.strength, normals=geometry.normals, kind=geometry.kind
        )
    source = np.arange(len(geometry.closed))
    return curves_of_samples(where, geometry.points, geometry.offsets, geometry.closed, source, geometry.strength)


def _is(attribute, data_type) -> bool:
    return attribute is not None and attribute.domain == "POINT" and attribute.data_type == data_type


def _strength(attributes, count):
    """Curvature of the points, None where it is not known."""
    attribute = attributes.get(STRENGTH)
    if not _is(attribute, "FLOAT") or not count:
        return None
    values = np.empty(count, np.float32)
    attribute.data.foreach_get("value", values)
    return np.nan_to_num(np.abs(values.astype(np.float64)), posinf=0.0)


def _vectors(data, field) -> np.ndarray:
    """(n, 3) float64"""
    values = np.empty(3 * len(data), np.float32)
    data.foreach_get(field, values)
    return values.reshape(-1, 3).astype(np.float64)
