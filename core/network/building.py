# SPDX-License-Identifier: GPL-3.0-or-later
"""From curves to the network: samples an edge length apart, in a frame that the input's pose does not change.

The origin is the centroid, the axes are the principal axes, the unit is the edge length, curves are sorted by what
they are and each runs the way its own shape says.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..errors import InputError
from ..geometry.polylines import resample_curves, segments, smooth_curves
from ..values import Curves
from .network import CurveNetwork


def build_network(curves: Curves, *, edge_length: float, smoothing: float = 1.5) -> CurveNetwork:
    """Samples of the curves, smoothed along each curve and one edge length apart.

    Parameters
    ----------
    curves : scene units, any pose
    edge_length : scene units
    smoothing : standard deviation along the curve, in edge lengths; 0 leaves the curves as they are

    Notes
    -----
    O(n) time and memory in the total length. Curves without length are left out.
    """
    _check(curves, edge_length)
    rotation, centre = _frame(curves, edge_length)
    points = (curves.points - centre) @ rotation / edge_length
    normals, kind = None if curves.normals is None else curves.normals @ rotation, curves.kind
    curves = Curves(points, curves.offsets, curves.closed, curves.strength, curves.source)
    strength = _average_strength(curves) * edge_length
    fine, offsets, closed, kept = resample_curves(curves, 0.5)
    if smoothing > 0:
        fine = smooth_curves(fine, offsets, closed, smoothing / 0.5)
    smooth = Curves(fine, offsets, closed)
    points, offsets, closed, again = resample_curves(smooth, 1.0)
    kept = kept[again]
    points, offsets, closed, order = _canonical(points, offsets, closed)
    # Rounding errors of another pose, scale or order end here: from here on the numbers are the same bit by bit.
    points, kept = np.round(points, 6), kept[order]
    curve_of = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    tangents, weights = _tangents(points, offsets, closed, curve_of)
    if normals is not None or kind is not None:
        nearest = cKDTree(curves.points).query(points)[1]
        normals, kind = (None if values is None else values[nearest] for values in (normals, kind))
    return CurveNetwork(
        points, tangents, weights, offsets, closed, curve_of, strength[kept], kept, rotation, centre,
        float(edge_length), normals, kind,
    )  # fmt: skip


USUAL, USUAL_NOISE, LEAST = 2.0, 0.22, 0.75
"""The smoothing (edge lengths) at which noise and lost bends weigh the same where places lie so far (edge lengths, each
coordinate) from the curve smoothed over 3; and the least one. Numerical: measured on scenes of known truth."""


def faithful_smoothing(curves: Curves, *, edge_length: float, most: float) -> float:
    """Smoothing (edge lengths, at most `most`) that leaves the bends of curves as noise lets them be.

    What noise adds to the square of an error falls with the width s of the smoothing, what lost bends add grows with
    s^4: the best width goes with the noise to the power of 2 / 5. Matching wants more, drawing no more.
    """
    if most <= LEAST:
        return most
    local = Curves(curves.points / edge_length, curves.offsets, curves.closed)
    fine, offsets, closed, _ = resample_curves(local, 0.5)
    smooth = smooth_curves(fine, offsets, closed, 6.0)
    count = np.diff(offsets)
    gap = np.linalg.norm(fine - smooth, axis=1)[np.repeat(count, count) > 24]
    # The median length of a vector across a line is 1.18 times the spread of its coordinates.
    noise = float(np.median(gap)) / 1.18 if len(gap) else USUAL_NOISE
    return float(np.clip(round(USUAL * (noise / USUAL_NOISE) ** 0.4, 3), LEAST, most))


def _check(curves: Curves, edge_length: float) -> None:
    if not np.isfinite(edge_length) or edge_length <= 0:
        raise InputError(f"the edge length is {edge_length!r}: give a length above 0")
    bad = ~np.isfinite(curves.points).all(axis=1)
    if bad.any():
        i = int(np.argmax(bad))
        c = int(np.searchsorted(curves.offsets, i, side="right") - 1)
        raise InputError(f"curve {c} has the coordinates {curves.points[i].tolist()}: remove or repair that point")
    if len(curves) == 0:
        raise InputError("there is no curve: give at least one polyline of two points")
    _, steps = segments(curves)
    total = steps.sum()
    if not total > 0:
        raise InputError("no curve has a length: give curves of at least two different points")
    if total / edge_length > 5e7:
        raise InputError(f"the edge length {edge_length:g} makes over 50 million samples: give a longer one")


def _frame(curves: Curves, edge_length: float):
    """Rotation (columns are the axes) and centre of the frame, from length-weighted moments."""
    anchor = curves.points.min(axis=0)
    step, length = segments(curves)
    middle = curves.points - anchor + step / 2
    total = length.sum()
    centre = length @ middle / total
    local = (middle - centre) / edge_length
    second = (local * length[:, None]).T @ local + (step * length[:, None]).T @ step / (12 * edge_length**2)
    _, axes = np.linalg.eigh(second)
    axes = axes[:, ::-1].copy()
    skew = ((local @ axes) ** 3 * length[:, None]).sum(axis=0)
    axes[:, skew < 0] *= -1
    if np.linalg.det(axes) < 0:
        axes[:, np.argmin(np.abs(skew))] *= -1
    return axes, anchor + centre


def _average_strength(curves: Curves) -> np.ndarray:
    if curves.strength is None:
        return np.full(len(curves), np.nan)
    count = np.diff(curves.offsets)
    total = np.bincount(np.repeat(np.arange(len(curves)), count), np.abs(curves.strength), minlength=len(curves))
    return total / np.maximum(count, 1)


def _canonical(points, offsets, closed):
    """Direct each curve by its own shape and sort the curves by length and place."""
    lists, keys = [], []
    for i in range(len(offsets) - 1):
        p = points[offsets[i] : offsets[i + 1]]
        if closed[i]:
            p = np.roll(p, -int(np.argmax(np.round(p @ np.array([1.0, 0.31, 0.17]), 6))), axis=0)
            if np.round((p[1] - p[-1]) @ np.array([0.23, 1.0, 0.41]), 6) < 0:
                p = np.concatenate([p[:1], p[:0:-1]])
        else:
            if np.round((p[-1] - p[0]) @ np.array([1.0, 0.31, 0.17]), 6) < 0:
                p = p[::-1]
        lists.append(p)
        keys.append((-len(p), *np.round(p[0], 6), *np.round(p[-1], 6)))
    order = np.array(sorted(range(len(keys)), key=keys.__getitem__), np.int64)
    count = np.diff(offsets)[order]
    points = np.concatenate([lists[i] for i in order])
    return points, np.concatenate([[0], np.cumsum(count)]), closed[order], order


def _tangents(points, offsets, closed, curve_of):
    first, last = offsets[:-1][curve_of], offsets[1:][curve_of] - 1
    here, ring = np.arange(len(points)), closed[curve_of]
    before = np.where(here > first, here - 1, np.where(ring, last, here))
    after = np.where(here < last, here + 1, np.where(ring, first, here))
    step = points[after] - points[before]
    size = np.linalg.norm(step, axis=1)
    gap_before = np.linalg.norm(points - points[before], axis=1)
    gap_after = np.linalg.norm(points[after] - points, axis=1)
    # A loop of two samples, and a curve that folds back onto itself, have the way to the next sample as their tangent.
    for other in (points[after] - points, points - points[before], np.array([[1.0, 0, 0]])):
        step = np.where((size > 1e-9)[:, None], step, other)
        size = np.linalg.norm(step, axis=1)
    return step / size[:, None], (gap_before + gap_after) / 2
