# SPDX-License-Identifier: GPL-3.0-or-later
"""Stanford PLY: edges as curves, faces and triangle strips as a surface. Other elements and colours are passed over."""

from __future__ import annotations

import numpy as np

from ...errors import InputError, NoCurves
from ..polygons import triangles_of_polygons
from ..reading import Reading, lines_of_points
from ..text import LARGEST
from .ply_data import Lists, read_elements
from .ply_header import read_header

CORNERS = ("vertex_indices", "vertex_index")
STRIPS = "tristrips"


def read_ply(path) -> Reading:
    """Vertices and edges; the vertex property `curvature`, where there is one, is the strength."""
    elements = read_elements(path)
    _points(path, elements)
    edge = elements.get("edge", {})
    if not {"vertex1", "vertex2"} <= set(edge):
        surface = {"face", STRIPS} & set(elements)
        hint = "it holds a surface; give it with --surface" if surface else "export its edges too"
        raise NoCurves(f"{path}: no element `edge` with vertex1 and vertex2, so no curves; {hint}")
    ends = [_integers(path, "edge", name, _plain(path, "edge", edge, name)) for name in ("vertex1", "vertex2")]
    index, offsets = np.stack(ends, axis=1).ravel(), np.arange(len(ends[0]) + 1) * 2
    vertex = elements.get("vertex", {})
    strength = None
    if "curvature" in vertex:
        strength = np.abs(np.asarray(_plain(path, "vertex", vertex, "curvature"), np.float64))
    points = _points(path, elements)
    _check_range(path, "edge", index, offsets, len(points))
    points, index, strength = _used(path, points, index, strength)
    return lines_of_points(path, points, index, offsets, named=np.zeros(len(ends[0]), bool), strength=strength)


def ply_content(path) -> tuple[bool, bool]:
    """Whether the header tells of faces, and whether it tells of edges."""
    counts = {element.name: element.count for element in read_header(path)}
    return counts.get("face", 0) > 0 or counts.get(STRIPS, 0) > 0, counts.get("edge", 0) > 0


def read_ply_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of all faces and strips."""
    elements = read_elements(path)
    corners = [(name, _corners(path, elements, name)) for name in ("face", STRIPS) if name in elements]
    if not corners:
        raise InputError(f"{path}: no element `face` with vertex_indices; give the scan that the curves come from")
    points, parts = _points(path, elements), []
    for name, lists in corners:
        index, offsets = _integers(path, name, CORNERS[0], lists.values), lists.offsets
        if name == STRIPS:
            index, offsets = _strips(index, offsets)
        _check_range(path, name, index, offsets, len(points))
        parts.append((index, offsets))
    del elements, corners, lists  # with them the bytes of the file
    if len(parts) > 1:
        index = np.concatenate([index for index, _ in parts])
        sizes = np.concatenate([np.diff(offsets) for _, offsets in parts])
        offsets = np.r_[0, np.cumsum(sizes)]
    points, index, _ = _used(path, points, index, None)
    return points, triangles_of_polygons(points, index, offsets)


def _corners(path, elements, name) -> Lists:
    for word in CORNERS:
        if word in elements[name]:
            found = elements[name][word]
            if not isinstance(found, Lists):
                raise InputError(f"{path}: `{word}` of `{name}` is one number where a list belongs; export it again")
            return found
    raise InputError(f"{path}: element `{name}` has no {CORNERS[0]}; export the mesh with its faces")


def _plain(path, element, properties, name) -> np.ndarray:
    if isinstance(properties[name], Lists):
        raise InputError(f"{path}: `{name}` of `{element}` is a list where one number belongs; export it again")
    return properties[name]


def _integers(path, element, name, values) -> np.ndarray:
    """(n,) int64 of any numbers that are whole, in an array of any shape."""
    if values.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            wrong = np.flatnonzero(~(np.abs(values) < 2.0**53) | (values != np.floor(values)))
        if len(wrong):
            shown = values.ravel()[wrong[0]]
            raise InputError(f"{path}: `{name}` of `{element}`: {shown:g} is no index; export it again")
    return values.astype(np.int64).reshape(-1)


def _points(path, elements) -> np.ndarray:
    vertex = elements.get("vertex", {})
    if not {"x", "y", "z"} <= set(vertex):
        raise InputError(f"{path}: no element `vertex` with x, y and z; export it again")
    points = np.empty((len(_plain(path, "vertex", vertex, "x")), 3))
    for i, c in enumerate("xyz"):
        points[:, i] = _plain(path, "vertex", vertex, c)
    return points


def _used(path, points, index, strength):
    """Points, indices and strengths without the points that are not finite and not used."""
    bad = ~(np.abs(points) <= LARGEST).all(axis=1)
    used = np.zeros(len(points), bool)
    used[index] = True
    wrong = np.flatnonzero(bad & used)
    if len(wrong):
        at = f"{path}: vertex {wrong[0]}: {points[wrong[0]]}"
        raise InputError(f"{at} is not finite or too large; remove the point or correct it")
    if strength is not None:
        wrong = np.flatnonzero(~(strength <= LARGEST) & used)
        if len(wrong):
            raise InputError(f"{path}: vertex {wrong[0]}: its curvature is not finite; correct it or remove it")
        strength = np.where(strength <= LARGEST, strength, 0.0)[~bad]
    if bad.any():
        points, index = points[~bad], (np.cumsum(~bad) - 1)[index]
    return points, index, strength


def _check_range(path, name, index, offsets, count):
    wrong = np.flatnonzero((index < 0) | (index >= count))
    if len(wrong):
        row = np.searchsorted(offsets, wrong[0], side="right") - 1
        raise InputError(f"{path}: {name} {row}: index {index[wrong[0]]} has no point, the file has {count}")


def _strips(index, offsets):
    """Triangles of strips as polygons: index -1 begins a new strip, and every second triangle runs the other way."""
    begin = np.zeros(len(index), bool)
    begin[offsets[:-1][np.diff(offsets) > 0]] = True
    begin[1:] |= index[:-1] == -1
    strip = np.cumsum(begin)
    at = np.arange(len(index))
    parity = (at - np.maximum.accumulate(np.where(begin, at, 0))) % 2
    k = np.arange(max(len(index) - 2, 0))
    k = k[(strip[k] == strip[k + 2]) & (index[k] != -1) & (index[k + 1] != -1) & (index[k + 2] != -1)]
    odd = parity[k] == 1
    triangles = np.stack([index[k], index[np.where(odd, k + 2, k + 1)], index[np.where(odd, k + 1, k + 2)]], axis=1)
    different = (triangles[:, 0] != triangles[:, 1]) & (triangles[:, 1] != triangles[:, 2])
    triangles = triangles[different & (triangles[:, 0] != triangles[:, 2])]
    return triangles.ravel(), np.arange(len(triangles) + 1) * 3
