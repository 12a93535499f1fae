# SPDX-License-Identifier: GPL-3.0-or-later
"""STL, binary and ascii: triangles without shared vertices, as a surface. All solids of a file are taken."""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ...geometry.rows import distinct_rows
from ..text import MARKS, blocks, load, load_text, parse_numbers

_HEADER = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_UNKNOWN = (0, 2**32 - 1)  # counts of writers that do not know how many will follow


def read_stl_surface(path):
    """Points (n, 3) float64, equal ones made one, and triangles (m, 3) int64."""
    data = load(path)
    if _is_text(data):
        del data
        corners = _ascii(path)
    else:
        corners = _binary(path, data)
        del data
    if not len(corners):
        raise InputError(f"{path}: no facets, so no surface; export it again")
    wrong = np.flatnonzero(~np.isfinite(corners).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}: facet {wrong[0] // 3}: a coordinate is not finite; repair the mesh")
    points, _, index = distinct_rows(corners)
    return points.astype(np.float64), index.reshape(-1, 3)


def _is_text(data) -> bool:
    """Whether the file is ascii. That begins with "solid", but so do some binary headers: their size decides."""
    if len(data) >= _HEADER and len(data) == _HEADER + _count(data, 0) * _FACET.itemsize:
        return False
    if any(data.startswith(mark) for mark, _ in MARKS):
        return True
    return data.lstrip()[:5].lower() == b"solid" and b"\0" not in data[:512]


def _count(data, at) -> int:
    return int.from_bytes(data[at + 80 : at + 84], "little")


def _binary(path, data) -> np.ndarray:
    """(k, 3) float32, corners of all facets of all solids; spare bytes behind them are passed over."""
    if len(data) < _HEADER:
        raise InputError(f"{path}: {len(data)} bytes are too few for an STL file; it was cut off, export it again")
    at, parts = 0, []
    while len(data) - at >= _HEADER:
        count, room = _count(data, at), (len(data) - at - _HEADER) // _FACET.itemsize
        whole = (len(data) - at - _HEADER) % _FACET.itemsize == 0
        if count in _UNKNOWN and whole:
            count = room
        if count > room or (count == 0 and room):
            if at:  # what stands behind the last solid is none
                break
            raise InputError(
                f"{path}: {len(data)} bytes do not fit an STL file of {count} facets, there is room for {room}; "
                "it was cut off, export it again"
            )
        found = np.frombuffer(data, _FACET, count, at + _HEADER)
        at += _HEADER + count * _FACET.itemsize
        if whole and room > count:
            more = np.frombuffer(data, _FACET, room - count, at)
            if _are_facets(more, found):  # the header tells of too few
                found, at = np.concatenate([found, more]), len(data)
        with np.errstate(invalid="ignore"):  # NaN of any kind is named later
            parts.append(found["corners"].astype(np.float32).reshape(-1, 3))
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _are_facets(more, found) -> bool:
    """Whether bytes behind the facets are facets as well: finite, and where the others are."""
    corners, known = more["corners"].reshape(-1, 3), found["corners"].reshape(-1, 3)
    if not np.isfinite(corners).all() or not corners.any():
        return False
    size = np.abs(known).max(initial=0.0)
    return bool(np.abs(corners).max() <= 10 * size and np.abs(corners).max() > 1e-6 * size)


def _ascii(path) -> np.ndarray:
    """(k, 3) float64, corners of all facets; the text becomes numbers block by block."""
    parts, line, corner = [np.zeros((0, 3))], 0, 0
    for block in blocks(load_text(path)):
        lines = block.splitlines()
        rows, numbers, corner = _vertices(path, lines, line, corner)
        line += len(lines)
        if rows:
            parts.append(parse_numbers(path, rows, numbers).reshape(-1, 3))
    corners = np.concatenate(parts)
    if len(corners) % 3:
        raise InputError(
            f"{path}: {len(corners)} vertices are no whole number of facets; it was cut off, export it again"
        )
    return corners


def _vertices(path, lines, number, corner):
    """The coordinates of vertices as words, the line of each, and how many the last facet has so far.

    number, corner : the lines before these, and how many vertices the facet has that they begin in
    """
    rows, numbers = [], []
    for at, line in enumerate(lines, number + 1):
        words = line.lower().split()
        if not words or (words[0] in (b"solid", b"endsolid") and not {b"facet", b"endloop"} <= set(words)):
            continue
        here = [i for i, word in enumerate(words) if word == b"vertex"]
        for i in here:
            coordinates = words[i + 1 : i + 4]
            if len(coordinates) < 3 or (len(here) == 1 and i == 0 and len(words) != 4):
                raise InputError(f"{path}: line {at}: a vertex needs three coordinates; was the file cut off?")
            rows.append(b" ".join(coordinates))
            numbers.append(at)
        corner += len(here)
        if b"endloop" in words:
            if corner % 3 or (not here and corner != 3):
                raise InputError(f"{path}: line {at}: a facet of {corner} vertices; export triangles, was it cut off?")
            corner = 0
    return rows, numbers, corner
