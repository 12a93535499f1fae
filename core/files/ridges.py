# SPDX-License-Identifier: GPL-3.0-or-later
"""Crest lines as text: those of CGAL's Ridges_3 [CP05] and those of CrestCODE [YBS05].

CGAL, one curve a line: ``type strength sharpness x y z x y z ...``. The strength is the integral of the curvature
along the curve, so the average curvature is strength / length.

CrestCODE (`ridges.txt`, `ravines.txt`): the numbers V of points, E of edges and N of connected components, a line
each; V lines ``x y z component``; N lines ``ridgeness sphericalness cyclideness``, the ridgeness being the integral of
the curvature along the component; E lines ``point point triangle``, points counted from 0, triangle -1 for an edge
that only connects.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..detection import KINDS
from ..errors import InputError
from ..geometry.chains import chains_of_edges
from .network import Reading, curves_of_chains, curves_of_samples
from .source import load_lines, parse_numbers

CONVEX = (4, 5, 6)
"""CGAL's types of lines along convex edges; 1 to 3 run along concave ones."""


def read_ridges(path) -> Reading:
    """Read either format; they are told apart by the first line, which holds one number in CrestCODE's files."""
    lines = load_lines(path)
    numbers = [n for n, line in enumerate(lines, 1) if line.strip()]
    rows = [lines[n - 1] for n in numbers]
    first = rows[0].split()
    read = _read_crest if len(first) == 1 and first[0].isdigit() else _read_cgal
    return replace(read(path, rows, numbers), crossings=True)


def _read_cgal(path, rows, numbers) -> Reading:
    lengths = np.fromiter((len(row.split()) for row in rows), np.int64, len(rows))
    wrong = np.flatnonzero((lengths < 6) | (lengths % 3 != 0))
    if len(wrong):
        parse_numbers(path, rows[:1], numbers[:1])  # prose is named as such
        raise InputError(
            f"{path}: line {numbers[wrong[0]]}: {lengths[wrong[0]]} numbers; a curve is type, strength, sharpness and"
            " x y z of each point; was the file cut off?"
        )
    values = parse_numbers(path, rows, numbers).reshape(-1, 3)
    count = lengths // 3
    head = np.cumsum(count) - count
    body = np.ones(len(values), bool)
    body[head] = False
    points, offsets = values[body], np.r_[0, np.cumsum(count - 1)]
    strength = np.repeat(_average(np.abs(values[head, 1]), _lengths(points, offsets)), count - 1)
    convex = np.isin(values[head, 0].astype(np.int64), CONVEX)
    kind = np.repeat(np.where(convex, KINDS.index("ridge"), KINDS.index("valley")), count - 1)
    return curves_of_samples(
        path, points, offsets, np.zeros(len(count), bool), np.arange(len(count)), strength, kind=kind
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
    return curves_of_chains(path, points, chains_of_edges(edges), strength)


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
