# SPDX-License-Identifier: GPL-3.0-or-later
"""Crest lines of CrestCODE [YBS05], `ridges.txt` and `ravines.txt`.

The numbers V of points, E of edges and N of connected components, a line each; V lines ``x y z component``; N lines
``ridgeness sphericalness cyclideness``, the ridgeness being the integral of the curvature along the component; E lines
``point point triangle``, points counted from 0, triangle -1 for an edge that only connects.
"""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ..reading import Reading, lines_of_points
from ..text import parse_numbers


def read_crest(path, blocks) -> Reading:
    """The lines in blocks of rows, lists of lines and their numbers."""
    rows = _Rows(path, blocks)
    n_points, n_edges, n_components = (int(k) for k in rows.take(3, 1, int)[:, 0])
    if min(n_points, n_edges, n_components) < 0:
        raise InputError(f"{path}: a number of points, edges or components is below 0; export it again")
    rows.wanted = 3 + n_points + n_components + n_edges
    points = rows.take(n_points, 4)
    line_of_point = rows.numbers
    ridgeness = rows.take(n_components, 3)[:, 0].copy()
    edges = rows.take(n_edges, 3)[:, :2].astype(np.int64)
    rows.close()
    wrong = np.flatnonzero(((edges < 0) | (edges >= n_points)).any(axis=1))
    if len(wrong):
        raise InputError(f"{path}: line {rows.numbers[wrong[0]]}: no such point, the file has {n_points}")
    component, points = points[:, 3].astype(np.int64), np.ascontiguousarray(points[:, :3])
    wrong = np.flatnonzero((component < 0) | (component >= n_components))
    if len(wrong):
        raise InputError(f"{path}: line {line_of_point[wrong[0]]}: no such component, the file has {n_components}")
    edge_length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    length = np.bincount(component[edges[:, 0]], edge_length, n_components)
    strength = average(np.abs(ridgeness), length)[component]
    del component, edge_length
    offsets = np.arange(len(edges) + 1) * 2
    named = np.zeros(len(edges), bool)
    return lines_of_points(path, points, edges.ravel(), offsets, named=named, strength=strength)


class _Rows:
    """Rows that are taken as tables, one after the other; `numbers` are the lines that the last table stands in."""

    def __init__(self, path, blocks):
        self._path, self._blocks, self._next = path, blocks, next(blocks, None)
        self._rows, self._lines, self._at, self._taken = [], [], 0, 0
        self.numbers = np.zeros(0, np.int32)
        self.wanted = 3

    def take(self, count, width, dtype=float) -> np.ndarray:
        """(count, width) float64, or int64: the next rows."""
        parts, lines, left = [np.zeros((0, width), dtype)], [self.numbers[:0]], count
        while left:
            if self._at == len(self._rows):
                self._fill()
            end = min(self._at + left, len(self._rows))
            rows, numbers = self._rows[self._at : end], self._lines[self._at : end]
            if len(rows) < left and self._next is None:
                had = self._taken + count - left + len(rows)
                raise InputError(
                    f"{self._path}: the file was cut off, it has {had} of {self.wanted} lines; export it again"
                )
            for row, number in zip(rows, numbers):
                if len(row.split()) != width:
                    raise InputError(
                        f"{self._path}: line {number}: {len(row.split())} numbers where {width} belong; export it again"
                    )
            parts.append(parse_numbers(self._path, rows, numbers, dtype).reshape(-1, width))
            lines.append(np.array(numbers, np.int32))
            left, self._at = left - len(rows), end
        self._taken += count
        self.numbers = np.concatenate(lines)
        return np.concatenate(parts)

    def close(self):
        """Let the text go; what is left of it is passed over."""
        self._rows, self._lines, self._next, self._blocks = [], [], None, iter(())

    def _fill(self):
        self._rows, self._lines = self._next or ([], [])
        self._at, self._next = 0, next(self._blocks, None)


def average(integral, length) -> np.ndarray:
    """(n,) float64, integrals over lengths, 0 where there is no length."""
    return np.divide(integral, length, out=np.zeros_like(integral), where=length > 0)
