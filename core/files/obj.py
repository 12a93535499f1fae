# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: curves as `l` lines or as a graph of edges, and the faces of a surface."""

from __future__ import annotations

import io
import re

import numpy as np

from ..errors import InputError
from ..geometry.chains import chains_of_edges, split_paths
from .network import Reading, curves_of_chains
from .source import load, load_lines, parse_numbers


def read_obj(path) -> Reading:
    """Read the `l` lines of an OBJ file.

    Each `l` line is one curve, cut where others meet it inside; a closed one repeats its first index. Where every
    `l` line has two indices, the lines are the edges of a graph, which is split into curves at junctions and ends.
    """
    points, statements, numbers, before = _read(path, b"l")
    if not statements:
        hint = "it holds a surface; give it with --surface" if _read(path, b"f")[1] else "export edges or polylines"
        raise InputError(f"{path}: no `l` lines, so no curves; {hint}")
    index, offsets = _indices(path, statements, numbers, before, len(points))
    if (np.diff(offsets) == 2).all():
        chains = chains_of_edges(index.reshape(-1, 2))
    else:
        chains = split_paths(index, offsets)
    return curves_of_chains(path, points, chains)


def obj_content(path) -> tuple[bool, bool]:
    """Whether the file has `f` lines, and whether it has `l` lines."""
    data = load(path)
    return tuple(re.search(rb"^[ \t]*" + word + rb"[ \t]", data, re.MULTILINE) is not None for word in (b"f", b"l"))


def read_obj_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of the `f` lines; polygons are cut into fans."""
    points, statements, numbers, before = _read(path, b"f")
    if not statements:
        raise InputError(f"{path}: no faces, so no surface; give the scan that the curves come from")
    index, offsets = _indices(path, statements, numbers, before, len(points))
    return points, fans(index, offsets)


def fans(index, offsets) -> np.ndarray:
    """(m, 3) int64, each polygon ``index[offsets[i]:offsets[i + 1]]`` as triangles about its first corner."""
    count = np.maximum(np.diff(offsets) - 2, 0)
    first = np.repeat(offsets[:-1], count)
    step = np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count) + 1
    return np.stack([index[first], index[first + step], index[first + step + 1]], axis=1)


def _read(path, keyword):
    """Points, the statements that begin with `keyword` without it, their lines, and the points before each."""
    vertices, vertex_numbers, statements, numbers, before = [], [], [], [], []
    lines = load_lines(path)
    for number, line in enumerate(_continued(lines), 1):
        if line[:1].isspace():
            line = line.lstrip()
        head = line[:2]
        if head == b"v " or head == b"v\t":
            vertices.append(line)
            vertex_numbers.append(number)
        elif head[:1] == keyword and head[1:] in (b" ", b"\t"):
            statements.append(line[2:].split(b"#", 1)[0])
            numbers.append(number)
            before.append(len(vertices))
    if not vertices:
        raise InputError(f"{path}: no `v` lines; this is not an OBJ file or it was cut off")
    return _points(path, vertices, vertex_numbers), statements, numbers, before


def _continued(lines):
    """The lines, with one that ends in a backslash joined to the next; what is joined leaves an empty line behind."""
    if not any(line.endswith(b"\\") for line in lines):
        return lines
    lines, begin = list(lines), 0
    for i in range(1, len(lines)):
        if lines[begin].endswith(b"\\"):
            lines[begin], lines[i] = lines[begin][:-1] + b" " + lines[i], b""
        else:
            begin = i
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


def _indices(path, statements, numbers, before, count):
    """Vertex indices from 0, (n,) int64, and the offsets of the statements, (m + 1,) int64."""
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
    return index, np.r_[0, np.cumsum(lengths)]


def write_obj(path, polylines, closed, groups=None):
    """Write polylines as `v` and `l` lines; a closed one repeats its first index.

    Parameters
    ----------
    polylines : sequence of (k, 3) float64
    closed : sequence of bool
    groups : sequence of str or None, the object name of each; curves of one name must be consecutive
    """
    text, base, last = io.StringIO(), 1, None
    for i, (points, loop) in enumerate(zip(polylines, closed)):
        if groups is not None and groups[i] != last:
            last = groups[i]
            text.write(f"o {last}\n")
        for x, y, z in np.asarray(points, float).tolist():
            text.write(f"v {x:.9g} {y:.9g} {z:.9g}\n")
        index = list(range(base, base + len(points))) + ([base] if loop else [])
        text.write("l " + " ".join(map(str, index)) + "\n")
        base += len(points)
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(text.getvalue())
