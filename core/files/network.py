# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file gave: its curves, cleaned, and how many it named."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..geometry.chains import Chains
from ..values import Curves


@dataclass(frozen=True)
class Reading:
    """Curves of one or more files.

    count : how many input curves the files name; `curves.source` counts them, and those without length are left out
    crossings : the points lie where the curves cross the edges of a mesh, so that segments are shorter than edges
    edge_length : mean edge length of the mesh that the curves come from, scene units; None where it is not known
    """

    curves: Curves
    count: int
    crossings: bool = False
    edge_length: float | None = None


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

    Raises InputError where nothing is left.
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
        raise InputError(f"{path}: no curve has two different points; export edges or polylines")
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
        np.concatenate([c.source + n for c, n in zip(every, counts)]),
        np.concatenate([c.normals for c in every]) if normals else None,
        np.concatenate([c.kind for c in every]) if kind else None,
    )
    lengths = [(r.edge_length, len(r.curves.points)) for r in readings if r.edge_length]
    edge_length = _mean(lengths) if lengths else None
    return Reading(curves, int(counts[-1]), all(r.crossings for r in readings), edge_length)


def _mean(pairs) -> float:
    """Average of (value, weight)."""
    values, weights = np.transpose(pairs)
    return float(np.average(values, weights=weights))
