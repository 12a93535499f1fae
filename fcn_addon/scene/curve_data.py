# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as Blender's data: curve data, and meshes of edges."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from ...core.fitting.primitives import bernstein

STRENGTH = "curvature"  # a float attribute of the points, 1 / length
KIND = "kind"  # an int attribute of the points of detected curves, index into core.detection.KINDS
NORMAL = "surface_normal"  # a vector attribute of theirs, the normal of the scan
OFFSET = "fcn_offset"  # of an occurrence's empty: how far its curves lie from it, in its own axes, double precision
TWIN = "fcn_twin"  # of curve data far from the origin: which part of which template they are a copy of
DIGEST = "fcn_digest"  # of such data: what tells whether they were edited
EDGE_LENGTH = "edge_length"  # a custom property of detected curves: the mean edge length of their scan


def curve_data(name, polylines, closed):
    """Curve data with a poly spline each; without bevel."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    for points, loop in zip(polylines, closed):
        add_poly(data, points, loop)
    return data


def add_poly(data, points, loop):
    """Add a poly spline of points (k, 3) to curve data."""
    spline = data.splines.new("POLY")
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.c_[points, np.ones(len(points))].astype(np.float32).ravel())
    spline.use_cyclic_u = bool(loop)


ALIGNED = 1e-3  # radians up to which two handles count as one direction


def bezier_data(name, paths, closed):
    """Curve data with a Bezier spline each; `paths` are (k, 4, 3) control points of their segments."""
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions, data.resolution_u = "3D", 24
    for path, loop in zip(paths, closed):
        add_bezier(data, path, loop)
    return data


def add_bezier(data, path, loop):
    """Add a Bezier spline of segments (k, 4, 3) to curve data."""
    spline = data.splines.new("BEZIER")
    ring = loop and len(path) > 1
    knots = len(path) + (not ring)
    spline.bezier_points.add(knots - 1)
    ends = path[-1] if ring else np.repeat(path[-1:, 3:], 4, axis=1)[0]
    begins = path if ring else np.concatenate([path, np.repeat(path[-1:, 3:], 4, axis=1)])
    before = np.concatenate([ends[None] if ring else np.repeat(path[:1, :1], 4, axis=1), path])[:knots]
    for place, values in (("co", begins[:, 0]), ("handle_left", before[:, 2]), ("handle_right", begins[:, 1])):
        spline.bezier_points.foreach_set(place, values.astype(np.float32).ravel())
    left, right = before[:, 3] - before[:, 2], begins[:, 1] - begins[:, 0]
    straight = [_is_straight(segment) for segment in path]
    for i, point in enumerate(spline.bezier_points):
        into, out = straight[i - 1] if i or ring else False, straight[i] if i < len(path) else False
        tangent = not (into and out) and _angle(left[i], right[i]) < ALIGNED
        point.handle_left_type = "ALIGNED" if tangent else "VECTOR" if into else "FREE"
        point.handle_right_type = "ALIGNED" if tangent else "VECTOR" if out else "FREE"
    spline.use_cyclic_u = bool(loop)


def _is_straight(segment):
    way = segment[3] - segment[0]
    return np.linalg.norm(np.cross(segment[1:3] - segment[0], way)) <= 1e-9 * max(way @ way, 1e-300)


def _angle(a, b):
    size = np.linalg.norm(a) * np.linalg.norm(b)
    return np.arccos(np.clip(a @ b / size, -1, 1)) if size > 0 else np.inf


def spline_points(spline, step=None):
    """(k, 3) float64, the points of a poly spline, or points on a Bezier spline, at most `step` apart.

    With step None a straight segment has its ends alone, any other 16 points. The first is not repeated at the end.
    """
    if spline.type != "BEZIER":
        row = np.empty(4 * len(spline.points), np.float32)
        spline.points.foreach_get("co", row)
        return row.reshape(-1, 4)[:, :3].astype(float)
    parts = []
    for segment in bezier_path(spline):
        count = 1 if _is_straight(segment) else 16
        if step is not None:
            count = max(count, int(np.ceil(np.linalg.norm(np.diff(segment, axis=0), axis=1).sum() / step)))
        parts.append(bernstein(np.arange(count) / count) @ segment)
    return np.concatenate([*parts, *([] if spline.use_cyclic_u else [bezier_path(spline)[-1, 3:]])])


def bezier_path(spline):
    """(k, 4, 3) float64, the control points of the segments of a Bezier spline."""
    knots, left, right = (_read(spline, name) for name in ("co", "handle_left", "handle_right"))
    path = np.stack([knots, right, np.roll(left, -1, axis=0), np.roll(knots, -1, axis=0)], axis=1)
    return path if spline.use_cyclic_u else path[:-1]


def _read(spline, name):
    row = np.empty(3 * len(spline.bezier_points), np.float32)
    spline.bezier_points.foreach_get(name, row)
    return row.reshape(-1, 3).astype(float)


def digest(data) -> str:
    """What changes when the curves of curve data or of an edge mesh are edited."""
    found = hashlib.blake2b(digest_size=16)
    if hasattr(data, "vertices"):
        values = np.empty(3 * len(data.vertices), np.float32)
        data.vertices.foreach_get("co", values)
        found.update(values.tobytes())
        return found.hexdigest()
    for spline in data.splines:
        values = bezier_path(spline) if spline.type == "BEZIER" else spline_points(spline)
        found.update(values.tobytes())
    return found.hexdigest()


def twin(data) -> str | None:
    """Which part of a template curve data are, where each occurrence has its own and they are as they were made."""
    return data[TWIN] if TWIN in data and data.get(DIGEST) == digest(data) else None


def mesh_data(name, curves, points):
    """A mesh of the edges of curves, with these (n, 3) points in place of their own."""
    mesh = bpy.data.meshes.new(name)
    fill_mesh(mesh, curves, points)
    return mesh


def fill_mesh(mesh, curves, points):
    """Put the edges of curves into an empty mesh, with these (n, 3) points in place of their own."""
    edges = _edges(curves)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    mesh.edges.add(len(edges))
    mesh.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    mesh.update()


def _edges(curves) -> np.ndarray:
    """(k, 2) int64, the edges of all curves, those that close a curve last."""
    ends = np.zeros(len(curves.points), bool)
    ends[curves.offsets[1:] - 1] = True
    inner = np.flatnonzero(~ends)
    first, last = curves.offsets[:-1][curves.closed], curves.offsets[1:][curves.closed] - 1
    return np.concatenate([np.stack([inner, inner + 1], axis=1), np.stack([last, first], axis=1)])
