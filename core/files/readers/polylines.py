# SPDX-License-Identifier: GPL-3.0-or-later
"""CGAL's polylines: the number of points, then x y z of each, on one line or on as many as it takes."""

from __future__ import annotations

import numpy as np

from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import load_lines, numbers_of, parse_numbers


def read_polylines(path) -> Reading:
    """The polylines of a file; words behind the last point of one, and lines that begin with #, are passed over."""
    lines = load_lines(path)
    numbers = [n for n, line in enumerate(lines, 1) if line.strip()]
    return polylines_of_rows(path, [lines[n - 1] for n in numbers], numbers)


def are_polylines(words) -> bool:
    """Whether rows (the first ones of a file, as lists of words) can be polylines."""
    if not words or not words[0][0].isdigit():
        return False
    if len(words[0]) == 1:
        return len(words) > 1 and len(words[1]) == 3
    return len(words[0]) == 1 + 3 * int(words[0][0])


def polylines_of_rows(path, rows, numbers) -> Reading:
    """The polylines in rows of text that stand in lines `numbers` of the file. Raises NoCurves where there is none."""
    kept, kept_numbers, sizes, at = [], [], [], 0
    while at < len(rows):
        words = rows[at].split()
        if words[0].startswith(b"#"):
            at += 1
            continue
        count, line = _count(path, words[0], numbers[at]), numbers[at]
        words, missing = words[1:], 3 * count
        while True:
            kept.append(b" ".join(words[:missing]))
            kept_numbers.append(numbers[at])
            at += 1
            if len(words) >= missing:
                break
            missing -= len(words)
            if at == len(rows):
                raise InputError(
                    f"{path}: line {line}: a polyline of {count} points has {count - -(-missing // 3)}; "
                    "was the file cut off?"
                )
            words = rows[at].split()
        if len(words) > missing and numbers_of(words[missing : missing + 1]) is not None:
            raise InputError(
                f"{path}: line {kept_numbers[-1]}: there are more numbers than the {count} points of line {line} have; "
                "a polyline is n and x y z of n points"
            )
        sizes.append(count)
    if not sizes:
        raise NoCurves(f"{path}: no polyline in it; export it again")
    points = parse_numbers(path, kept, kept_numbers).reshape(-1, 3)
    offsets = np.r_[0, np.cumsum(sizes)]
    return lines_of_points(path, points, np.arange(len(points)), offsets, named=np.ones(len(sizes), bool))


def _count(path, word, number) -> int:
    if not (word.isdigit() and len(word) < 10):
        shown = word[:40].decode("latin1")
        raise InputError(f"{path}: line {number}: {shown!r} is no number of points of a polyline; correct the line")
    return int(word)
