# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines as CGAL writes them: the number of points and then x y z of each, ``n x y z x y z ...``.

A polyline may go on over several lines. Words behind the last point of one, and lines that begin with #, are passed
over.
"""

from __future__ import annotations

import numpy as np

from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import numbers_of, parse_numbers, rows_of


def read_polylines(path) -> Reading:
    """The polylines of a file. Raises NoCurves where there is none."""
    return polylines_of_rows(path, rows_of(path))


def are_polylines(words) -> bool:
    """Whether rows (the first ones of a file, as lists of words) can be polylines."""
    if not words or not words[0][0].isdigit():
        return False
    if len(words[0]) == 1:
        return len(words) > 1 and len(words[1]) == 3
    return len(words[0]) == 1 + 3 * int(words[0][0])


def polylines_of_rows(path, blocks) -> Reading:
    """The polylines in blocks of rows, lists of lines and their numbers. Raises NoCurves where there is none."""
    found = _Polylines(path)
    for rows, numbers in blocks:
        found.add(rows, numbers)
    return found.reading()


class _Polylines:
    """The polylines of rows that come block by block; one may go on in the next block."""

    def __init__(self, path):
        self._path = path
        self._parts, self._sizes = [], []
        self._missing, self._line = 0, 0  # numbers that the last polyline lacks, and the line that it begins in

    def add(self, rows, numbers):
        """Take more rows."""
        kept = []
        for row, number in zip(rows, numbers):
            words = row.split()
            if not self._missing:
                count = self._count(words[0], number)
                self._sizes.append(count)
                self._missing, self._line, words = 3 * count, number, words[1:]
            kept.append(b" ".join(words[: self._missing]))
            spare = words[self._missing : self._missing + 1]
            if spare and numbers_of(spare) is not None:
                raise InputError(
                    f"{self._path}: line {number}: there are more numbers than the {self._sizes[-1]} points of line"
                    f" {self._line} have; a polyline is n and x y z of n points"
                )
            self._missing -= min(len(words), self._missing)
        self._parts.append(parse_numbers(self._path, kept, numbers))

    def reading(self) -> Reading:
        """All of them."""
        if self._missing:
            count = self._sizes[-1]
            raise InputError(
                f"{self._path}: line {self._line}: a polyline of {count} points has {count - -(-self._missing // 3)}; "
                "was the file cut off?"
            )
        if not self._sizes:
            raise NoCurves(f"{self._path}: no polyline in it; export it again")
        parts, self._parts = self._parts, []
        points = np.concatenate(parts).reshape(-1, 3)
        del parts
        offsets = np.r_[0, np.cumsum(self._sizes)]
        return lines_of_points(self._path, points, None, offsets, named=np.ones(len(self._sizes), bool))

    def _count(self, word, number) -> int:
        if not (word.isdigit() and len(word) < 10):
            shown = word[:40].decode("latin1")
            raise InputError(
                f"{self._path}: line {number}: {shown!r} is no number of points of a polyline; correct the line"
            )
        return int(word)
