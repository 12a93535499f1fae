# SPDX-License-Identifier: GPL-3.0-or-later
"""STL, binary and ascii: triangles without shared vertices, as a surface."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from ..geometry.rows import distinct_rows
from .source import load, load_lines, parse_numbers

_HEADER = 84
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl_surface(path):
    """Points (n, 3) float64, equal ones made one, and triangles (m, 3) int64."""
    data = load(path)
    # an ascii file begins with "solid", but so do some binary ones: the facet count in the header decides
    count = int.from_bytes(data[80:84], "little") if len(data) >= _HEADER else -1
    if len(data) == _HEADER + count * _FACET.itemsize:
        corners = np.frombuffer(data, _FACET, count, _HEADER)["corners"].astype(np.float64).reshape(-1, 3)
    elif data[:5].lower() == b"solid" and b"\0" not in data[:512]:
        corners = _ascii(path)
    else:
        told = f"{count} facets" if count >= 0 else "no header"
        raise InputError(f"{path}: {len(data)} bytes do not fit an STL file of {told}; it was cut off, export it again")
    if not len(corners):
        raise InputError(f"{path}: no facets, so no surface; export it again")
    wrong = np.flatnonzero(~np.isfinite(corners).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}: facet {wrong[0] // 3}: a coordinate is not finite; repair the mesh")
    points, _, index = distinct_rows(corners)
    return points, index.reshape(-1, 3)


def _ascii(path) -> np.ndarray:
    rows, numbers = [], []
    for number, line in enumerate(load_lines(path), 1):
        fields = line.split()
        if fields and fields[0].lower() == b"vertex":
            if len(fields) != 4:
                raise InputError(f"{path}: line {number}: a vertex needs three coordinates; correct the line")
            rows.append(b" ".join(fields[1:]))
            numbers.append(number)
    if len(rows) % 3:
        raise InputError(f"{path}: {len(rows)} vertices are no whole number of facets; it was cut off, export it again")
    if not rows:
        return np.zeros((0, 3))
    return parse_numbers(path, rows, numbers).reshape(-1, 3)
