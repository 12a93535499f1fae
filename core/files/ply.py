# SPDX-License-Identifier: GPL-3.0-or-later
"""Stanford PLY, ascii and binary of both byte orders: edges as curves, faces as a surface."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..geometry.chains import chains_of_edges
from .network import Reading, curves_of_chains
from .obj import fans
from .source import load

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8",
}  # fmt: skip


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str
    length: str | None  # the type of a list's length, None for one value


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: tuple[_Property, ...]


def read_ply(path) -> Reading:
    """Read vertices and edges; the vertex property `curvature`, where there is one, is the strength."""
    elements = _read(path)
    points = _points(path, elements)
    edge = elements.get("edge")
    if edge is None or "vertex1" not in edge or "vertex2" not in edge:
        hint = "it holds a surface; give it with --surface" if "face" in elements else "export its edges too"
        raise InputError(f"{path}: no element `edge` with vertex1 and vertex2, so no curves; {hint}")
    edges = np.stack([edge["vertex1"], edge["vertex2"]], axis=1).astype(np.int64)
    _check_range(path, "edge", edges, np.arange(len(edges) + 1) * 2, len(points))
    strength = elements["vertex"].get("curvature")
    if strength is not None:
        strength = np.abs(strength.astype(np.float64))
        wrong = np.flatnonzero(~np.isfinite(strength))
        if len(wrong):
            raise InputError(f"{path}: vertex {wrong[0]}: its curvature is not finite; correct it or remove it")
    return curves_of_chains(path, points, chains_of_edges(edges), strength)


def ply_content(path) -> tuple[bool, bool]:
    """Whether the header tells of faces, and whether it tells of edges."""
    counts = {element.name: element.count for element in _header(path, load(path))[1]}
    return counts.get("face", 0) > 0, counts.get("edge", 0) > 0


def read_ply_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64; polygons are cut into fans."""
    elements = _read(path)
    points = _points(path, elements)
    face = elements.get("face", {})
    corners = face.get("vertex_indices", face.get("vertex_index"))
    if corners is None:
        raise InputError(f"{path}: no element `face` with vertex_indices; give the scan that the curves come from")
    index, offsets = corners[0].astype(np.int64), corners[1]
    _check_range(path, "face", index, offsets, len(points))
    return points, fans(index, offsets)


def _points(path, elements) -> np.ndarray:
    vertex = elements.get("vertex", {})
    if not {"x", "y", "z"} <= set(vertex):
        raise InputError(f"{path}: no element `vertex` with x, y and z; export it again")
    points = np.stack([vertex[c] for c in "xyz"], axis=1).astype(np.float64)
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}: vertex {wrong[0]}: {points[wrong[0]]} is not finite; remove the point or correct it")
    return points


def _check_range(path, name, index, offsets, count):
    index = index.ravel()
    wrong = np.flatnonzero((index < 0) | (index >= count))
    if len(wrong):
        row = np.searchsorted(offsets, wrong[0], side="right") - 1
        raise InputError(f"{path}: {name} {row}: index {index[wrong[0]]} has no point, the file has {count}")


def _read(path) -> dict:
    """Element name -> property name -> (n,) array, or (values, offsets) of a list."""
    data = load(path)
    order, elements, body = _header(path, data)
    read = _read_ascii if order is None else _read_binary
    return read(path, data[body:], elements, order)


def _header(path, data):
    """Byte order (None for ascii), the elements, and where the body begins."""
    end = re.search(rb"^end_header[ \t]*\r?\n", data[: 1 << 20], re.MULTILINE)
    if not data.startswith(b"ply") or end is None:
        raise InputError(f"{path}: no PLY header; this is not a PLY file or it was cut off")
    order, elements = None, []
    for number, line in enumerate(data[: end.start()].decode("latin1").splitlines(), 1):
        words = line.split()
        try:
            match words:
                case ["format", name, *_]:
                    order = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}[name]
                case ["element", name, count]:
                    elements.append((name, int(count), []))
                case ["property", "list", length, kind, name]:
                    elements[-1][2].append(_Property(name, _TYPES[kind], _TYPES[length]))
                case ["property", kind, name]:
                    elements[-1][2].append(_Property(name, _TYPES[kind], None))
        except (KeyError, ValueError, IndexError):
            raise InputError(f"{path}: line {number}: {line[:60]!r} is not PLY; export it again") from None
    return order, [_Element(name, count, tuple(properties)) for name, count, properties in elements], end.end()


def _read_binary(path, body, elements, order) -> dict:
    out, at = {}, 0
    for element in elements:
        if any(p.length for p in element.properties):
            out[element.name], at = _lists(path, body, element, order, at)
            continue
        row = np.dtype([(p.name, order + p.kind) for p in element.properties])
        if at + element.count * row.itemsize > len(body):
            _cut_off(path, element, (len(body) - at) // max(row.itemsize, 1))
        values = np.frombuffer(body, row, element.count, at)
        out[element.name] = {p.name: values[p.name] for p in element.properties}
        at += element.count * row.itemsize
    return out


def _lists(path, body, element, order, at):
    """Rows with lists. Where all lists are as long as the first row's, the rows have one layout and one read does."""
    layout, fits = [], 0
    for p in element.properties:
        if p.length is None:
            layout.append((p.name, order + p.kind))
            continue
        size = np.dtype(layout).itemsize if layout else 0
        width = np.dtype(p.length).itemsize
        if at + size + width > len(body):
            fits = -1
            break
        length = int(np.frombuffer(body, order + p.length, 1, at + size)[0])
        layout += [("count of " + p.name, order + p.length), (p.name, order + p.kind, (max(length, 0),))]
    if fits == 0:
        row = np.dtype(layout)
        if at + element.count * row.itemsize <= len(body):
            values = np.frombuffer(body, row, element.count, at)
            lists = [p for p in element.properties if p.length]
            if all((values["count of " + p.name] == row[p.name].shape[0]).all() for p in lists):
                out = {p.name: values[p.name] for p in element.properties if not p.length}
                for p in lists:
                    offsets = np.arange(element.count + 1) * row[p.name].shape[0]
                    out[p.name] = values[p.name].reshape(-1), offsets
                return out, at + element.count * row.itemsize
    return _rows(path, body, element, order, at)


def _rows(path, body, element, order, at):
    """Rows with lists of different lengths, one after the other."""
    kinds = [
        (p, np.dtype(order + p.kind), np.dtype(order + p.length) if p.length else None) for p in element.properties
    ]
    values, lengths = [[] for _ in kinds], [[] for _ in kinds]
    for row in range(element.count):
        for column, (_, kind, length) in enumerate(kinds):
            count = 1
            if length is not None:
                if at + length.itemsize > len(body):
                    _cut_off(path, element, row)
                count = int(np.frombuffer(body, length, 1, at)[0])
                at += length.itemsize
            if count < 0 or at + count * kind.itemsize > len(body):
                _cut_off(path, element, row)
            values[column].append(np.frombuffer(body, kind, count, at))
            lengths[column].append(count)
            at += count * kind.itemsize
    return _columns(element, values, lengths), at


def _columns(element, values, lengths) -> dict:
    out = {}
    for p, column, length in zip(element.properties, values, lengths):
        joined = np.concatenate(column) if column else np.zeros(0, p.kind)
        out[p.name] = (joined, np.r_[0, np.cumsum(length)].astype(np.int64)) if p.length else joined
    return out


def _read_ascii(path, body, elements, order) -> dict:
    lines = [line.split() for line in body.splitlines() if line.strip()]
    out, at = {}, 0
    for element in elements:
        rows = lines[at : at + element.count]
        if len(rows) < element.count:
            _cut_off(path, element, len(rows))
        at += element.count
        try:
            out[element.name] = _ascii_element(element, rows)
        except (ValueError, IndexError, OverflowError):
            raise InputError(f"{path}: element `{element.name}`: a row does not fit its properties; export it again") \
                from None  # fmt: skip
    return out


def _ascii_element(element, rows) -> dict:
    if not any(p.length for p in element.properties):
        width = len(element.properties)
        if any(len(row) < width for row in rows):
            raise ValueError
        table = np.array([row[:width] for row in rows], dtype=bytes).reshape(-1, width).astype(np.float64)
        return {p.name: table[:, i] for i, p in enumerate(element.properties)}
    values, lengths = [[] for _ in element.properties], [[] for _ in element.properties]
    for row in rows:
        at = 0
        for column, p in enumerate(element.properties):
            count = int(row[at]) if p.length else 1
            at += bool(p.length)
            if count < 0 or at + count > len(row):
                raise ValueError
            values[column].append(np.array(row[at : at + count], dtype=bytes).astype(np.float64))
            lengths[column].append(count)
            at += count
    return _columns(element, values, lengths)


def _cut_off(path, element, found):
    raise InputError(
        f"{path}: the file was cut off, it has {found} of {element.count} rows of `{element.name}`; export it again"
    )
