# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: curves as `l` lines, and the faces of a surface."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, fields

import numpy as np

from ...errors import InputError, NoCurves
from ..polygons import triangles_of_polygons
from ..reading import Reading, lines_of_points
from ..text import blocks, load_text, parse_numbers

FREE_FORM = {
    b"curv": ("free-form curves", "convert them to polylines"),
    b"surf": ("free-form surfaces", "convert them to a mesh"),
}
"""Statements that are not read, what they are and what to do."""


@dataclass(frozen=True)
class _Statements:
    """Statements of one keyword: all their indices, and of each how many it has, its line and the points before it.

    An index is as the file has it; what stands behind a slash is left out.
    """

    index: np.ndarray
    lengths: np.ndarray
    numbers: np.ndarray
    before: np.ndarray

    def __len__(self):
        return len(self.lengths)

    def where(self, kept):
        """Those of the statements that are `kept`, (m,) bool."""
        every = (self.lengths[kept], self.numbers[kept], self.before[kept])
        return _Statements(self.index[np.repeat(kept, self.lengths)], *every)


@dataclass
class _Rows:
    """Statements as words, of one block of text: what stands behind the keyword, the line, the points before it."""

    rows: list[bytes] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    before: list[int] = field(default_factory=list)


def read_obj(path) -> Reading:
    """The `l` lines of an OBJ file and its faces of two corners, as they stand there.

    An `l` line is an input curve; one of two indices is a single edge, which becomes a part of one by joining.
    """
    points, found = _read(path, (b"l", b"f"))
    _refuse(path, found, b"curv")
    lines = [found[b"l"], found[b"f"].where(found[b"f"].lengths == 2)]
    if not any(map(len, lines)):
        if not len(found[b"f"]):
            _refuse(path, found, b"surf")
        hint = "it holds a surface; give it with --surface" if len(found[b"f"]) else "export edges or polylines"
        raise NoCurves(f"{path}: no `l` lines, so no curves; {hint}")
    index, offsets = _indices(path, lines, len(points))
    return lines_of_points(path, points, index, offsets, named=np.diff(offsets) != 2)


def obj_content(path) -> tuple[bool, bool]:
    """Whether the file has faces, and whether it has lines or faces of two corners, which are edges."""
    data = load_text(path)
    if b"\\" in data:
        data = b"\n".join(_continued(data))
    elif b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    face = re.search(rb"^[ \t]*f(?:[ \t]+[^\s#]+){3}", data, re.MULTILINE) is not None
    line = re.search(rb"^[ \t]*(?:l[ \t]|f(?:[ \t]+[^\s#]+){2}[ \t]*(?:#|$))", data, re.MULTILINE) is not None
    return face, line


def read_obj_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of the `f` lines."""
    points, found = _read(path, (b"f",))
    _refuse(path, found, b"surf")
    if not len(found[b"f"]):
        raise InputError(f"{path}: no faces, so no surface; give the scan that the curves come from")
    index, offsets = _indices(path, [found[b"f"]], len(points))
    return points, triangles_of_polygons(points, index, offsets)


def _refuse(path, found, word):
    if len(found[word]):
        what, remedy = FREE_FORM[word]
        raise InputError(
            f"{path}: line {found[word].numbers[0]}: {what} (`{word.decode()}`) are not read; {remedy} and export again"
        )


def _read(path, keywords):
    """Points, and the statements of each keyword; those that are free-form are always among them.

    The text becomes numbers block by block, as words take many times its memory.
    """
    parts, count, number = [], 0, 0
    found = {word: [] for word in (*keywords, *FREE_FORM)}
    for block in blocks(load_text(path)):
        lines = _continued(block)
        rows = {word: _Rows() for word in found}
        vertices, vertex_numbers = _sort(lines, number, count, rows)
        if vertices:
            parts.append(_points(path, vertices, vertex_numbers))
            count += len(vertices)
        number += len(lines)
        for word, some in rows.items():
            if some.rows:
                found[word].append(_parsed(path, some, word in FREE_FORM))
    if not count:
        raise InputError(f"{path}: no `v` lines; this is not an OBJ file or it was cut off")
    return np.concatenate(parts), {word: _whole(some) for word, some in found.items()}


def _sort(lines, number, count, rows):
    """Put the lines into `rows` of their keywords; those of points, and the numbers of these lines.

    number, count : lines and points before these lines
    """
    vertices, vertex_numbers = [], []
    for at, line in enumerate(lines, number + 1):
        if line[:1].isspace():
            line = line.lstrip()
        if line[:2] in (b"v ", b"v\t"):
            vertices.append(line)
            vertex_numbers.append(at)
            continue
        some = rows.get(line[:5].split(None, 1)[0]) if line[:1] in (b"l", b"f", b"c", b"s") else None
        if some is not None:
            words = line.split(b"#", 1)[0].split(None, 1)
            some.rows.append(words[1] if len(words) > 1 else b"")
            some.numbers.append(at)
            some.before.append(count + len(vertices))
    return vertices, vertex_numbers


def _parsed(path, some, is_refused) -> _Statements:
    rows, numbers, before = some.rows, some.numbers, some.before
    if is_refused:  # only where they stand is asked
        rows = [b""] * len(rows)
    if any(b"/" in row for row in rows):
        rows = re.sub(rb"/\S*", b"", b"\n".join(rows)).split(b"\n")
    lengths = np.fromiter((len(row.split()) for row in rows), np.int32, len(rows))
    index = parse_numbers(path, rows, numbers, int)
    if len(index) and np.abs(index).max() < 2**31:
        index = index.astype(np.int32)
    return _Statements(index, lengths, np.array(numbers, np.int32), np.array(before, np.int32))


def _whole(parts) -> _Statements:
    none = np.zeros(0, np.int32)
    return _Statements(*(np.concatenate([none, *(getattr(p, f.name) for p in parts)]) for f in fields(_Statements)))


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
    lengths, numbers, before, raw = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("lengths", "numbers", "before", "index")
    )
    # A negative index counts back from the points that stand before its line.
    index = raw - np.int64(1)
    back = np.flatnonzero(raw < 0)
    if len(back):
        index[back] = raw[back] + np.repeat(before, lengths)[back].astype(np.int64)
    offsets = np.zeros(len(lengths) + 1, np.int64)
    np.cumsum(lengths, out=offsets[1:])
    wrong = np.flatnonzero((index < 0) | (index >= count))
    if len(wrong):
        statement = np.searchsorted(offsets, wrong[0], side="right") - 1
        raise InputError(
            f"{path}: line {numbers[statement]}: index {raw[wrong[0]]} has no point, the file has {count}; "
            "was it cut off?"
        )
    return index, offsets
