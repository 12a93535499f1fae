# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file gave: its curves as they stand there, and how many it names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError, NoCurves
from ..geometry.chains import Chains
from ..values import Curves

WELD = 1e-3
"""Ends this near are one, in edge lengths: far below any feature, far above the rounding of a drawing."""


UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm", 21: "ft (US survey)"}
"""Names of the units that drawings are in, by DXF's code."""


METRES = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0, 10: 0.9144, 14: 0.1, 21: 1200 / 3937}
"""How long they are."""


@dataclass(frozen=True)
class Shares:
    """Which part of which input curve became which curve, a row for each pair that shares a length.

    curve, line : (k,) int64, index of the curve and of the input curve
    length : (k,) float64, scene units
    """

    curve: np.ndarray
    line: np.ndarray
    length: np.ndarray


@dataclass(frozen=True)
class Reading:
    """Curves of one or more files.

    curves : `curves.source` counts the input curves that a file names; -1 is a single edge without a name, which
        becomes a part of one when edges are joined (`joining.join`)
    count : how many input curves the files name; some of them may have no length and leave no curve
    crossings : the points lie where the curves cross the edges of a mesh, so that segments are shorter than edges
    edge_length : mean edge length of the mesh that the curves come from, scene units; None where it is not known
    units : what one unit of the coordinates is, DXF's code: 4 millimetres, 6 metres; 0 where it is not known
    left_out : what of the file is no curve that can be read, in words; empty where all was read
    shares : where curves were joined, what became of each input curve; None where `curves.source` says it all
    """

    curves: Curves
    count: int
    crossings: bool = False
    edge_length: float | None = None
    shares: Shares | None = None
    left_out: str = ""
    units: int = 0


def lines_of_points(path, points, index, offsets, *, named, strength=None, kind=None) -> Reading:
    """Lines as a file holds them, nothing joined and nothing removed.

    Parameters
    ----------
    path : named in errors
    points : (n, 3) float64
    index : (k,) int64, the points of all lines; one that is closed repeats its first; None for all in their order
    offsets : (m + 1,) int64
    named : (m,) bool, whether a line is an input curve of its own, rather than a single edge of one
    strength, kind : (n,) or None, per point

    Raises NoCurves where no line has two different points.
    """
    named, offsets = np.asarray(named, bool), np.asarray(offsets, np.int64)
    index = slice(None) if index is None else index
    placed = points[index]
    inside = np.ones(max(len(placed) - 1, 0), bool)
    ends = offsets[1:-1]
    inside[ends[(ends > 0) & (ends < len(placed))] - 1] = False
    if not (inside & (placed[1:] != placed[:-1]).any(axis=1)).any():
        raise NoCurves(f"{path}: no curve has two different points; export edges or polylines")
    source = np.where(named, np.cumsum(named) - 1, -1)
    values = (None if x is None else x[index] for x in (strength, kind))
    strength, kind = values
    curves = Curves(placed, offsets, np.zeros(len(named), bool), strength, source, None, kind)
    return Reading(curves, int(named.sum()))


def curves_of_chains(path, points, chains: Chains, strength=None, normals=None, kind=None) -> Reading:
    """Curves of chains over shared points, with zero-length edges removed.

    Parameters
    ----------
    path : named in errors
    points : (n, 3) float64
    strength, normals, kind : (n,), (n, 3), (n,) or None, per point
    """
    values = (None if x is None else x[chains.vertices] for x in (strength, normals, kind))
    return curves_of_samples(path, points[chains.vertices], chains.offsets, chains.closed, chains.source, *values)


def curves_of_samples(path, points, offsets, closed, source, strength=None, normals=None, kind=None) -> Reading:
    """Curves of consecutive points: equal neighbours become one, a curve without length goes.

    A closed curve that is left with two points is open.

    Raises NoCurves where nothing is left.
    """
    count = int(np.max(source, initial=-1)) + 1
    curve = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    before = np.arange(len(points)) - 1
    begin = offsets[:-1][np.diff(offsets) > 0]
    before[begin] = begin
    keep = (points != points[before]).any(axis=1)
    keep[begin] = True
    # The last point of a closed curve must not repeat its first.
    end = offsets[1:][np.diff(offsets) > 0] - 1
    repeated = np.zeros(len(points), bool)
    repeated[end] = (points[end] == points[begin]).all(axis=1) & closed[curve[end]] & (end > begin)
    keep &= ~repeated
    lengths = np.bincount(curve[keep], minlength=len(offsets) - 1)
    usable = lengths >= 2
    if not usable.any():
        raise NoCurves(f"{path}: no curve has two different points; export edges or polylines")
    keep &= usable[curve]
    lengths = lengths[usable]
    curves = Curves(
        np.ascontiguousarray(points[keep], np.float64),
        np.r_[0, np.cumsum(lengths)].astype(np.int64),
        np.asarray(closed, bool)[usable] & (lengths > 2),
        None if strength is None else np.asarray(strength, np.float64)[keep],
        np.asarray(source, np.int64)[usable],
        None if normals is None else normals[keep],
        None if kind is None else kind[keep],
    )
    return Reading(curves, count)


def concatenate(readings) -> Reading:
    """All readings as one; strength and normals stay where all have them; edge lengths that are known are averaged."""
    readings = list(readings)
    if len(readings) == 1:
        return readings[0]
    sizes = np.cumsum([0] + [len(r.curves.points) for r in readings])
    counts = np.cumsum([0] + [r.count for r in readings])
    every = [r.curves for r in readings]
    known = all(c.strength is not None for c in every)
    normals, kind = (all(getattr(c, name) is not None for c in every) for name in ("normals", "kind"))
    curves = Curves(
        np.concatenate([c.points for c in every]),
        np.concatenate([[0]] + [c.offsets[1:] + n for c, n in zip(every, sizes)]).astype(np.int64),
        np.concatenate([c.closed for c in every]),
        np.concatenate([c.strength for c in every]) if known else None,
        np.concatenate([np.where(c.source < 0, -1, c.source + n) for c, n in zip(every, counts)]),
        np.concatenate([c.normals for c in every]) if normals else None,
        np.concatenate([c.kind for c in every]) if kind else None,
    )
    lengths = [(r.edge_length, len(r.curves.points)) for r in readings if r.edge_length]
    edge_length = _mean(lengths) if lengths else None
    units = {r.units for r in readings} - {0}
    if len(units) > 1:
        names = ", ".join(map(str, sorted(units)))
        raise InputError(f"the drawings have different units ($INSUNITS {names}); save them in one unit")
    crossings = all(r.crossings for r in readings)
    return Reading(curves, int(counts[-1]), crossings, edge_length, units=max(units, default=0))


def _mean(pairs) -> float:
    """Average of (value, weight)."""
    values, weights = np.transpose(pairs)
    return float(np.average(values, weights=weights))
