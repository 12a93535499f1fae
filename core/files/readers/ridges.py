# SPDX-License-Identifier: GPL-3.0-or-later
"""Crest lines as text: those of CGAL's Ridges_3 [CP05] and those of CrestCODE [YBS05]; also what else a .txt may be.

Ridges_3, one curve a line: ``type strength sharpness x y z x y z ...``. The strength is the integral of the curvature
along the curve, so the average curvature is strength / length. The type is 1 to 6.

The text becomes numbers block by block, as words take many times its memory.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

import numpy as np

from ...detection import KINDS
from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import numbers_of, parse_numbers, rows_of
from .crest import average, read_crest
from .polylines import are_polylines, polylines_of_rows

TYPES = (1, 2, 3, 4, 5, 6)
CONVEX = (4, 5, 6)
"""Types of lines along convex edges; 1 to 3 run along concave ones."""


FIRST = 1000
"""Rows that are looked at to tell what a file is."""


def read_text(path) -> Reading:
    """The lines of a .txt file: of Ridges_3, of CrestCODE or CGAL's polylines, told apart by their first rows."""
    first, blocks = _begun(rows_of(path))
    if not first:
        raise NoCurves(f"{path}: it holds nothing but comments; export it again")
    words = [row.split() for row in first[:3]]
    if all(len(row) == 1 and row[0].isdigit() for row in words):
        if len(words) < 3:
            raise InputError(f"{path}: the file was cut off after {len(words)} lines; export it again")
        return replace(read_crest(path, blocks), crossings=True)
    if are_polylines(words):
        return _read_polylines(path, blocks, first)
    return replace(_read_cgal(path, blocks, first), crossings=True)


def _begun(blocks):
    """The first rows, up to FIRST, and all blocks from the first on."""
    first, begun = [], []
    for block in blocks:
        begun.append(block)
        first += block[0][: FIRST - len(first)]
        if len(first) >= 3:
            break
    return first, chain(begun, blocks)


def _read_polylines(path, blocks, first) -> Reading:
    try:
        return polylines_of_rows(path, blocks)
    except InputError as error:  # the first row of a point cloud can look like a polyline
        if isinstance(error, NoCurves) or len({row.split(None, 1)[0] for row in first}) > 1:
            _refuse_cloud(path, first)
        raise


def _read_cgal(path, blocks, first) -> Reading:
    points, sizes, strengths, kinds = [], [], [], []
    for rows, numbers in blocks:
        lengths = np.fromiter((len(row.split()) for row in rows), np.int64, len(rows))
        _check_lengths(path, rows, numbers, lengths, first)
        if rows[0] is first[0] and numbers_of(rows[0].split()) is None:
            _refuse_cloud(path, first)  # the names of its columns come first
        values = parse_numbers(path, rows, numbers).reshape(-1, 3)
        count = lengths // 3
        head = np.cumsum(count) - count
        types, integral = values[head, 0], np.abs(values[head, 1])
        wrong = np.flatnonzero(~np.isin(types, TYPES))
        if len(wrong):
            _refuse_cloud(path, first)
            raise InputError(
                f"{path}: line {numbers[wrong[0]]}: {types[wrong[0]]:g} is no type of a ridge line, those are 1 to 6; "
                "give the file that Ridges_3 wrote"
            )
        body = np.ones(len(values), bool)
        body[head] = False
        points.append(values[body])
        sizes.append(count - 1)
        strengths.append(average(integral, _lengths(points[-1], np.r_[0, np.cumsum(count - 1)])))
        kinds.append(np.where(np.isin(types, CONVEX), KINDS.index("ridge"), KINDS.index("valley")))
    size, strength, kind = (np.concatenate(parts) for parts in (sizes, strengths, kinds))
    offsets = np.r_[0, np.cumsum(size)]
    whole = np.concatenate(points)
    del points
    return lines_of_points(
        path, whole, None, offsets, named=np.ones(len(size), bool), strength=np.repeat(strength, size),
        kind=np.repeat(kind, size),
    )  # fmt: skip


def _check_lengths(path, rows, numbers, lengths, first):
    """Raise InputError where a row is not type, strength, sharpness and points."""
    wrong = np.flatnonzero((lengths < 6) | (lengths % 3 != 0))
    if len(wrong):
        _refuse_cloud(path, first)
        parse_numbers(path, rows[:1], numbers[:1])  # prose is named as such
        raise InputError(
            f"{path}: line {numbers[wrong[0]]}: {lengths[wrong[0]]} numbers; a curve is type, strength, sharpness and"
            " x y z of each point; was the file cut off?"
        )


def _refuse_cloud(path, rows):
    """Raise NoCurves where the rows are a table of numbers, at least three in each: points, and nothing joins them."""
    rows = [row.replace(b",", b" ").replace(b";", b" ").split() for row in rows]
    while len(rows) > 2 and (len(rows[0]) < 3 or numbers_of(rows[0]) is None):  # a count, or the names of the columns
        rows = rows[1:]
    widths = {len(row) for row in rows}
    is_table = len(rows) > 1 and len(widths) == 1 and min(widths) >= 3
    if is_table and numbers_of([word for row in rows for word in row]) is not None:
        raise NoCurves(
            f"{path}: this is a point cloud, {min(widths)} numbers in each row: it has neither curves nor faces; "
            "make a mesh of it and give that as a scan"
        )


def _lengths(points, offsets) -> np.ndarray:
    """(m,) float64, the length of each curve."""
    step = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=1)]
    along = np.cumsum(step)
    return along[offsets[1:] - 1] - along[offsets[:-1]]
