# SPDX-License-Identifier: GPL-3.0-or-later
"""The edge length of the mesh that curves came from, estimated from the curves; for drawings, one that suits them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..geometry.chains import chains_of_edges
from ..geometry.polylines import segments
from ..geometry.rows import distinct_rows
from ..values import Curves

CROSSING = np.pi * np.sqrt(3) / 12
"""Mean length of a random chord of an equilateral triangle of edge 1 (pi x area / perimeter)."""

DRAWN = 4.0
"""Lengths of segments that differ by more are no lengths of edges of a scan, but of lines that were drawn."""

FEW = 8
"""Segments of a typical curve. One with fewer was drawn from corner to corner; on a scan it would be noise."""

SHARE = 1 / 50
"""Edge length of a drawing, as a share of the size of its outlines. An outline is then strong (25 edges), and what lies
further apart than a 25th of it stays apart."""

SAMPLES = 50_000
"""A drawing gets no more samples than this, however small most of its outlines are."""

SAME = 1e-6
"""Ends that are nearer are one, as a share of the extent; estimated is before lines are joined."""


@dataclass(frozen=True)
class Estimate:
    """An edge length in scene units, and what it was estimated from.

    spread : lengths between which most segments lie, where they are so different that the estimate is coarse; else None
    outline : the size of a typical outline, where the length is a share of it; else None
    """

    length: float
    spread: tuple[float, float] | None = None
    outline: float | None = None


def estimate_edge_length(curves: Curves, *, crossings: bool = False) -> float:
    """`estimate(...).length`, scene units."""
    return estimate(curves, crossings=crossings).length


def estimate(curves: Curves, *, crossings: bool = False) -> Estimate:
    """Edge length of the mesh that the curves came from, in scene units.

    Curves along mesh edges show it as their median segment. Crest lines cut through triangles
    (`crossings`): a random chord of an equilateral triangle is `CROSSING` of its edge long.

    Lines of a drawing run from corner to corner, and their lengths say nothing of a mesh. There the edge length, the
    step at which curves are sampled and half of what is told apart, is a `SHARE` of the size of the outlines, unless
    the median segment is shorter. An outline is a chain of lines between junctions or ends, its size the distance of
    its furthest corners, and the median of these counts: it is that of what is there many times.

    Raises InputError where no curve has a length.
    """
    _, steps = segments(curves)
    used = np.flatnonzero(steps > 0)
    if not len(used):
        raise InputError("no curve has a length: give curves of at least two different points")
    steps = steps[used]
    if crossings:
        return Estimate(float(np.mean(steps) / CROSSING))
    middle = float(np.median(steps))
    spread = tuple(np.quantile(steps, (0.1, 0.9)).tolist())
    differ = spread[1] > DRAWN * spread[0]
    owner = np.repeat(np.arange(len(curves)), np.diff(curves.offsets))[used]
    if not differ and _typical(np.bincount(owner), np.bincount(owner, steps)) >= FEW:
        return Estimate(middle)
    sizes, counts, lengths = _outlines(curves, used, steps)
    few = _typical(counts, lengths) < FEW
    if not differ and not few:
        return Estimate(middle)
    outline = float(np.median(sizes))
    least = min(float(steps.sum()) / SAMPLES, 0.1 * float(sizes.max())) if few else 0.0
    if max(SHARE * outline, least) < max(middle, least):
        return Estimate(max(SHARE * outline, least), spread, outline)
    return Estimate(max(middle, least), spread)


def _typical(counts, lengths) -> int:
    """The number of segments of the curve that the middle of all length is on."""
    order = np.argsort(counts, kind="stable")
    run = np.cumsum(lengths[order])
    return int(counts[order][np.searchsorted(run, 0.5 * run[-1])])


def _outlines(curves, used, steps):
    """Size, number of segments and length of each chain between the junctions and ends of all segments `used`."""
    points = curves.points
    after = np.arange(len(points)) + 1
    full = np.diff(curves.offsets) > 0
    after[curves.offsets[1:][full] - 1] = curves.offsets[:-1][full]
    low = points.min(axis=0)
    extent = float(np.ptp(points, axis=0).max())
    _, _, place = distinct_rows(np.rint((points - low) / (SAME * extent)))
    edges = np.stack([place[used], place[after[used]]], axis=1)
    chains = chains_of_edges(edges)
    if not len(chains):
        return np.array([extent]), np.array([len(used)]), np.array([steps.sum()])
    at = np.empty((place.max() + 1, 3))
    at[place] = points
    corners = Curves(at[chains.vertices], chains.offsets, chains.closed)
    _, lengths = segments(corners)
    return _sizes(corners), np.diff(chains.offsets) - ~chains.closed, np.add.reduceat(lengths, chains.offsets[:-1])


def _sizes(curves) -> np.ndarray:
    """The distance of the furthest points of each curve, found as that from the point furthest from the first one.

    It may be less than the true one, by half at most, and does not depend on how a curve is turned.
    """
    first, owner = curves.offsets[:-1], np.repeat(np.arange(len(curves)), np.diff(curves.offsets))
    away = np.linalg.norm(curves.points - curves.points[first][owner], axis=1)
    furthest = np.flatnonzero(away == np.maximum.reduceat(away, first)[owner])
    start = furthest[np.searchsorted(owner[furthest], np.arange(len(curves)))]
    return np.maximum.reduceat(np.linalg.norm(curves.points - curves.points[start][owner], axis=1), first)
