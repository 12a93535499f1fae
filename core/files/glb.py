# SPDX-License-Identifier: GPL-3.0-or-later
"""Binary glTF 2.0 (.glb): the triangles of all meshes, placed by their nodes, as one surface.

glTF is y-up; the surface is z-up, (x, -z, y), as Blender's importer places it.
"""

from __future__ import annotations

import json

import numpy as np

from ..errors import InputError
from .text import load

_JSON, _BINARY = 0x4E4F534A, 0x004E4942
_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_UPRIGHT = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
_DEEPEST = 1000  # levels of nodes; deeper ones go in a circle


def read_glb_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of the file's scene.

    Raises InputError for damaged files, and for compressed or sparse data.
    """
    document, binary = _chunks(path, load(path))
    try:
        parts = list(_parts(path, document, binary))
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: its description is damaged ({error!r}); export it again") from None
    if not parts:
        raise InputError(f"{path}: no triangles, so no surface; export the mesh with its faces")
    first = np.cumsum([0] + [len(points) for points, _ in parts])
    points = np.concatenate([points for points, _ in parts])
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}: vertex {wrong[0]}: {points[wrong[0]]} is not finite; repair the mesh")
    return points, np.concatenate([triangles + at for (_, triangles), at in zip(parts, first)])


def _chunks(path, data):
    """The description and the binary chunk."""
    if data[:4] != b"glTF" or len(data) < 20:
        raise InputError(f"{path}: this is not a .glb file; export it as binary glTF")
    version, length = np.frombuffer(data, "<u4", 2, 4).tolist()
    if version != 2:
        raise InputError(f"{path}: glTF {version} cannot be read; export it as glTF 2.0")
    if length > len(data):
        raise InputError(f"{path}: the file was cut off, it has {len(data)} of {length} bytes; export it again")
    found, at = {}, 12
    while at + 8 <= length:
        size, kind = np.frombuffer(data, "<u4", 2, at).tolist()
        found.setdefault(kind, data[at + 8 : min(at + 8 + size, length)])
        at += 8 + size
    try:
        document = json.loads(found[_JSON])
        if not isinstance(document, dict):
            raise ValueError
    except (KeyError, ValueError, RecursionError):
        raise InputError(f"{path}: no description in it; the file is damaged, export it again") from None
    for name in document.get("extensionsRequired", ()):
        if "draco" in name or "meshopt" in name:
            raise InputError(f"{path}: the mesh is compressed ({name}); export it without compression")
    return document, found.get(_BINARY, b"")


def _parts(path, document, binary):
    """Points and triangles of each primitive of each mesh, at each of its nodes."""
    nodes, meshes = document.get("nodes", []), document.get("meshes", [])
    read = {}
    for node, matrix in _placed(path, document, nodes):
        mesh = nodes[node].get("mesh")
        if mesh is None:
            continue
        if mesh not in read:
            every = (_primitive(path, document, binary, p) for p in meshes[mesh]["primitives"])
            read[mesh] = [part for part in every if part is not None]
        for points, triangles in read[mesh]:
            mirrored = np.linalg.det(matrix[:3, :3]) < 0
            yield points @ matrix[:3, :3].T + matrix[:3, 3], triangles[:, ::-1] if mirrored else triangles


def _placed(path, document, nodes):
    """(node, (4, 4) its matrix in the z-up world) of all nodes of the scene."""
    scenes = document.get("scenes")
    if scenes:
        roots = scenes[document.get("scene", 0)].get("nodes", [])
    else:
        below = {child for node in nodes for child in node.get("children", ())}
        roots = [i for i in range(len(nodes)) if i not in below]
    waiting = [(root, _UPRIGHT, 0) for root in reversed(roots)]
    while waiting:
        node, above, depth = waiting.pop()
        if depth > _DEEPEST:
            raise InputError(f"{path}: node {node} is inside itself; export it again")
        matrix = above @ _matrix(nodes[node])
        yield node, matrix
        waiting += [(child, matrix, depth + 1) for child in reversed(nodes[node].get("children", ()))]


def _matrix(node):
    """(4, 4) float64, a node's own transform; files hold matrices by columns."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    made = np.eye(4)
    made[:3, 3] = node.get("translation", (0, 0, 0))
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    made[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), float)
    return made


def _primitive(path, document, binary, primitive):
    """Points and triangles of a primitive, None where it is none of triangles."""
    mode = primitive.get("mode", _TRIANGLES)
    if mode not in (_TRIANGLES, _STRIP, _FAN):
        return None
    points = _accessor(path, document, binary, primitive["attributes"]["POSITION"]).astype(np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError("POSITION")
    if "indices" in primitive:
        corners = _accessor(path, document, binary, primitive["indices"]).astype(np.int64).ravel()
    else:
        corners = np.arange(len(points))
    wrong = np.flatnonzero((corners < 0) | (corners >= len(points)))
    if len(wrong):
        raise InputError(f"{path}: index {corners[wrong[0]]} has no point, the mesh has {len(points)}; export it again")
    count = len(corners) // 3 if mode == _TRIANGLES else max(len(corners) - 2, 0)
    if not count:
        return None
    if mode == _TRIANGLES:
        return points, corners[: 3 * count].reshape(-1, 3)
    i = np.arange(count)
    if mode == _FAN:
        return points, np.stack([corners[i + 1], corners[i + 2], np.full(count, corners[0])], axis=1)
    odd = i % 2
    return points, np.stack([corners[i], corners[i + 1 + odd], corners[i + 2 - odd]], axis=1)


def _accessor(path, document, binary, index):
    """The values of an accessor, (n, width) or (n, 1); normalised integers as fractions."""
    a = document["accessors"][index]
    if "sparse" in a or "bufferView" not in a:
        raise InputError(f"{path}: accessor {index} is sparse, which is not read; export it without shape keys")
    view = document["bufferViews"][a["bufferView"]]
    if view.get("buffer", 0) != 0 or document["buffers"][0].get("uri"):
        raise InputError(f"{path}: its data is in another file; export it as one .glb")
    dtype, width = np.dtype(_DTYPES[a["componentType"]]), _WIDTHS[a["type"]]
    step = view.get("byteStride") or dtype.itemsize * width
    begin, count = view.get("byteOffset", 0) + a.get("byteOffset", 0), a["count"]
    end = begin + (step * (count - 1) + dtype.itemsize * width if count else 0)
    if begin < 0 or count < 0 or step < dtype.itemsize * width or end > len(binary):
        raise InputError(f"{path}: the data ends before accessor {index}; the file was cut off, export it again")
    values = np.ndarray((count, width), dtype, binary, begin, (step, dtype.itemsize))
    if a.get("normalized") and dtype.kind in "iu":
        return np.maximum(values / np.iinfo(dtype).max, -1.0)
    return values
