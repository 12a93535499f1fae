# SPDX-License-Identifier: GPL-3.0-or-later
"""Crest lines as text: those of CGAL's Ridges_3 [CP05] and those of CrestCODE [YBS05]; also what else a .txt may be.

Ridges_3, one curve a line: ``type strength sharpness x y z x y z ...``. The strength is the integral of the curvature
along the curve, so the average curvature is strength / length. The type is 1 to 6.

CrestCODE (`ridges.txt`, `ravines.txt`): the numbers V of points, E of edges and N of connected components, a line
each; V lines ``x y z component``; N lines ``ridgeness sphericalness cyclideness``, the ridgeness being the integral of
the curvature along the component; E lines ``point point triangle``, points counted from 0, triangle -1 for an edge
that only connects.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...detection import KINDS
from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import load_lines, numbers_of, parse_numbers
from .polylines import are_polylines, polylines_of_rows

TYPES = (1, 2, 3, 4, 5, 6)
CONVEX = (4, 5, 6)
"""Types of lines along convex edges; 1 to 3 run along concave ones."""


def read_text(path) -> Reading:
    """The lines of a .txt file: of Ridges_3, of CrestCODE or CGAL's polylines, told apart by their first rows."""
    lines = load_lines(path)
    numbers = [n for n, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith(b"#")]
    if not numbers:
        raise NoCurves(f"{path}: it holds nothing but comments; export it again")
    rows = [lines[n - 1] for n in numbers]
    words = [row.split() for row in rows[:3]]
    if len(words) == 3 and all(len(row) == 1 and row[0].isdigit() for row in words):
        return replace(_read_crest(path, rows, numbers), crossings=True)
    if len(words) < 3 and all(len(row) == 1 and row[0].isdigit() for row in words):
        raise InputError(f"{path}: the file was cut off after {len(rows)} lines; export it again")
    if are_polylines(words):
        return polylines_of_rows(path, rows, numbers)
    return replace(_read_cgal(path, rows, numbers), crossings=True)


def _read_cgal(path, rows, numbers) -> Reading:
    lengths = np.fromiter((len(row.split()) for row in rows), np.int64, len(rows))
    wrong = np.flatnonzero((lengths < 6) | (lengths % 3 != 0))
    if len(wrong):
        _refuse_cloud(path, rows)
        parse_numbers(path, rows[:1], numbers[:1])  # prose is named as such
        raise InputError(
            f"{path}: line {numbers[wrong[0]]}: {lengths[wrong[0]]} numbers; a curve is type, strength, sharpness and"
            " x y z of each point; was the file cut off?"
        )
    values = parse_numbers(path, rows, numbers).reshape(-1, 3)
    count = lengths // 3
    head = np.cumsum(count) - count
    types = values[head, 0]
    wrong = np.flatnonzero(~np.isin(types, TYPES))
    if len(wrong):
        _refuse_cloud(path, rows)
        raise InputError(
            f"{path}: line {numbers[wrong[0]]}: {types[wrong[0]]:g} is no type of a ridge line, those are 1 to 6; "
            "give the file that Ridges_3 wrote"
        )
    body = np.ones(len(values), bool)
    body[head] = False
    points, offsets = values[body], np.r_[0, np.cumsum(count - 1)]
    strength = np.repeat(_average(np.abs(values[head, 1]), _lengths(points, offsets)), count - 1)
    kind = np.repeat(np.where(np.isin(types, CONVEX), KINDS.index("ridge"), KINDS.index("valley")), count - 1)
    named = np.ones(len(count), bool)
    return lines_of_points(
        path, points, np.arange(len(points)), offsets, named=named, strength=strength, kind=kind
    )  # fmt: skip


def _refuse_cloud(path, rows):
    """Raise NoCurves where the rows are a table of numbers, at least three in each: points, and nothing joins them."""
    rows = [row.replace(b",", b" ").replace(b";", b" ").split() for row in rows[:1000]]
    while len(rows) > 2 and (len(rows[0]) < 3 or numbers_of(rows[0]) is None):  # a count, or the names of the columns
        rows = rows[1:]
    widths = {len(row) for row in rows}
    is_table = len(rows) > 1 and len(widths) == 1 and min(widths) >= 3
    if is_table and numbers_of([word for row in rows for word in row]) is not None:
        raise NoCurves(
            f"{path}: this is a point cloud, {min(widths)} numbers in each row: it has neither curves nor faces; "
            "make a mesh of it and give that as a scan"
        )


def _read_crest(path, rows, numbers) -> Reading:
    if len(rows) < 3:
        raise InputError(f"{path}: the file was cut off after {len(rows)} lines; export it again")
    n_points, n_edges, n_components = (int(k) for k in parse_numbers(path, rows[:3], numbers[:3], int)[:3])
    wanted = 3 + n_points + n_components + n_edges
    if min(n_points, n_edges, n_components) < 0 or len(rows) < wanted:
        raise InputError(f"{path}: the file was cut off, it has {len(rows)} of {wanted} lines; export it again")
    a, b = 3 + n_points, 3 + n_points + n_components
    points = _table(path, rows[3:a], numbers[3:a], 4)
    ridgeness = _table(path, rows[a:b], numbers[a:b], 3)[:, 0]
    edges = _table(path, rows[b:wanted], numbers[b:wanted], 3)[:, :2].astype(np.int64)
    wrong = np.flatnonzero(((edges < 0) | (edges >= n_points)).any(axis=1))
    if len(wrong):
        raise InputError(f"{path}: line {numbers[b + wrong[0]]}: no such point, the file has {n_points}")
    points, component = points[:, :3], points[:, 3].astype(np.int64)
    wrong = np.flatnonzero((component < 0) | (component >= n_components))
    if len(wrong):
        raise InputError(f"{path}: line {numbers[3 + wrong[0]]}: no such component, the file has {n_components}")
    edge_length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    length = np.bincount(component[edges[:, 0]], edge_length, n_components)
    strength = _average(np.abs(ridgeness), length)[component]
    return lines_of_points(
        path, points, edges.ravel(), np.arange(len(edges) + 1) * 2, named=np.zeros(len(edges), bool), strength=strength
    )


def _table(path, rows, numbers, width) -> np.ndarray:
    """(n, width) float64; more fields than `width` in a line are an error too."""
    for row, number in zip(rows, numbers):
        if len(row.split()) != width:
            raise InputError(f"{path}: line {number}: {len(row.split())} numbers where {width} belong; export it again")
    return parse_numbers(path, rows, numbers).reshape(-1, width)


def _lengths(points, offsets) -> np.ndarray:
    """(m,) float64, the length of each curve."""
    step = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=1)]
    along = np.cumsum(step)
    return along[offsets[1:] - 1] - along[offsets[:-1]]


def _average(integral, length) -> np.ndarray:
    return np.divide(integral, length, out=np.zeros_like(integral), where=length > 0)
