# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: curves as `l` lines, and the faces of a surface."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from ...errors import InputError, NoCurves
from ..polygons import triangles_of_polygons
from ..reading import Reading, lines_of_points
from ..text import load_text, parse_numbers

FREE_FORM = {
    b"curv": ("free-form curves", "convert them to polylines"),
    b"surf": ("free-form surfaces", "convert them to a mesh"),
}
"""Statements that are not read, what they are and what to do."""


@dataclass
class _Statements:
    """Statements of one keyword: their words without it, the line of each, and how many points stand before it."""

    rows: list[bytes] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    before: list[int] = field(default_factory=list)


def read_obj(path) -> Reading:
    """The `l` lines of an OBJ file and its faces of two corners, as they stand there.

    An `l` line is an input curve; one of two indices is a single edge, which becomes a part of one by joining.
    """
    points, found = _read(path, (b"l", b"f"))
    _refuse(path, found, b"curv")
    lines = [found[b"l"]]
    edges = _of_two(found[b"f"])
    if edges.rows:
        lines.append(edges)
    if not any(s.rows for s in lines):
        hint = "it holds a surface; give it with --surface" if found[b"f"].rows else "export edges or polylines"
        raise NoCurves(f"{path}: no `l` lines, so no curves; {hint}")
    index, offsets = _indices(path, lines, len(points))
    return lines_of_points(path, points, index, offsets, named=np.diff(offsets) != 2)


def obj_content(path) -> tuple[bool, bool]:
    """Whether the file has faces, and whether it has lines or faces of two corners, which are edges."""
    data = load_text(path)
    if b"\\" in data or b"\r" in data:
        data = b"\n".join(_continued(data))
    face = re.search(rb"^[ \t]*f(?:[ \t]+[^\s#]+){3}", data, re.MULTILINE) is not None
    line = re.search(rb"^[ \t]*(?:l[ \t]|f(?:[ \t]+[^\s#]+){2}[ \t]*(?:#|$))", data, re.MULTILINE) is not None
    return face, line


def read_obj_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of the `f` lines."""
    points, found = _read(path, (b"f",))
    _refuse(path, found, b"surf")
    if not found[b"f"].rows:
        raise InputError(f"{path}: no faces, so no surface; give the scan that the curves come from")
    index, offsets = _indices(path, [found[b"f"]], len(points))
    return points, triangles_of_polygons(points, index, offsets)


def _refuse(path, found, word):
    if found[word].rows:
        what, remedy = FREE_FORM[word]
        raise InputError(
            f"{path}: line {found[word].numbers[0]}: {what} (`{word.decode()}`) are not read; {remedy} and export again"
        )


def _of_two(statements) -> _Statements:
    """The statements of two indices."""
    rows = zip(statements.rows, statements.numbers, statements.before)
    return _Statements(*map(list, zip(*(row for row in rows if len(row[0].split(None, 2)) == 2))))


def _read(path, keywords):
    """Points, and the statements of each keyword; those that are free-form are always among them."""
    vertices, vertex_numbers = [], []
    found = {word: _Statements() for word in (*keywords, *FREE_FORM)}
    for number, line in enumerate(_continued(load_text(path)), 1):
        if line[:1].isspace():
            line = line.lstrip()
        if line[:2] in (b"v ", b"v\t"):
            vertices.append(line)
            vertex_numbers.append(number)
            continue
        statements = found.get(line[:5].split(None, 1)[0]) if line[:1] in (b"l", b"f", b"c", b"s") else None
        if statements is not None:
            words = line.split(b"#", 1)[0].split(None, 1)
            statements.rows.append(words[1] if len(words) > 1 else b"")
            statements.numbers.append(number)
            statements.before.append(len(vertices))
    if not vertices:
        raise InputError(f"{path}: no `v` lines; this is not an OBJ file or it was cut off")
    return _points(path, vertices, vertex_numbers), found


def _continued(data):
    """The lines, with one that ends in a backslash joined to the next; what is joined leaves an empty line behind."""
    lines = data.splitlines()
    if b"\\" not in data:
        return lines
    at = 0
    while at < len(lines):
        begin, parts = at, [lines[at]]
        while parts[-1].rstrip().endswith(b"\\") and b"#" not in parts[-1] and at + 1 < len(lines):
            parts[-1] = parts[-1].rstrip()[:-1]
            at += 1
            parts.append(lines[at])
            lines[at] = b""
        lines[begin] = b" ".join(parts)
        at += 1
    return lines


def _points(path, vertices, numbers):
    rows = [line[2:] for line in vertices]
    lengths = np.fromiter((len(row.split(None, 3)) for row in rows), np.int64, len(rows))
    short = np.flatnonzero(lengths < 3)
    if len(short):
        raise InputError(f"{path}: line {numbers[short[0]]}: a point has {lengths[short[0]]} numbers; it needs three")
    if (lengths > 3).any():  # a fourth number is a weight, more are a colour
        rows = [b" ".join(row.split(None, 3)[:3]) for row in rows]
    return parse_numbers(path, rows, numbers).reshape(-1, 3)


def _indices(path, parts, count):
    """Vertex indices from 0, (n,) int64, and the offsets of the statements, (m + 1,) int64."""
    statements, numbers, before = (
        [row for part in parts for row in getattr(part, name)] for name in ("rows", "numbers", "before")
    )
    if any(b"/" in row for row in statements):
        statements = [b" ".join(word.split(b"/", 1)[0] for word in row.split()) for row in statements]
    lengths = np.fromiter((len(row.split()) for row in statements), np.int64, len(statements))
    index = parse_numbers(path, statements, numbers, int)
    # A negative index counts back from the points that stand before its line.
    index = np.where(index < 0, index + np.repeat(before, lengths), index - 1)
    wrong = np.flatnonzero((index < 0) | (index >= count))
    if len(wrong):
        statement = np.searchsorted(np.cumsum(lengths), wrong[0], side="right")
        shown = statements[statement].split()[wrong[0] - (np.cumsum(lengths) - lengths)[statement]].decode()
        raise InputError(
            f"{path}: line {numbers[statement]}: index {shown} has no point, the file has {count}; was it cut off?"
        )
    return index, np.r_[0, np.cumsum(lengths)].astype(np.int64)
