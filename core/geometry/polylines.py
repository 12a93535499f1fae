# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines: even spacing, smoothing, tangents, and how two of them bend into each other."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import correlate1d

from ..values import Curves


def segments(curves: Curves):
    """Segment vectors' start curve and their lengths, the closing segment of closed curves included."""
    step = np.diff(curves.points, axis=0, append=curves.points[:1]) if len(curves.points) else np.zeros((0, 3))
    last = curves.offsets[1:] - 1
    full = np.diff(curves.offsets) > 0
    first, last, closed = curves.offsets[:-1][full], last[full], curves.closed[full]
    step[last] = np.where(closed[:, None], curves.points[first] - curves.points[last], 0)
    return step, np.linalg.norm(step, axis=1)


def resample_curves(curves: Curves, step: float):
    """Points evenly along each curve about `step` apart; closed curves do not repeat the first point."""
    _, length = segments(curves)
    run = np.concatenate([[0.0], np.cumsum(length)])
    start, end = run[curves.offsets[:-1]], run[curves.offsets[1:]]
    total = end - start
    kept = np.flatnonzero(total > 1e-9)
    closed = curves.closed & (total > 4 * step)
    pieces = np.maximum(np.rint(total / step).astype(np.int64), np.where(closed, 4, 1))
    count = (pieces + ~closed)[kept]
    offsets = np.concatenate([[0], np.cumsum(count)])
    curve = np.repeat(kept, count)
    k = np.arange(offsets[-1]) - np.repeat(offsets[:-1], count)
    at = k * (total / np.maximum(pieces, 1))[curve]
    # Zero-length steps between curves leave `run` flat there, so that one search serves all curves.
    first, last = curves.offsets[:-1][curve], curves.offsets[1:][curve] - 1
    position = start[curve] + at
    i = np.clip(np.searchsorted(run, position, side="right") - 1, first, np.where(curves.closed[curve], last, last - 1))
    nxt = np.where(i == last, first, i + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        u = np.clip(np.nan_to_num((position - run[i]) / length[i]), 0, 1)[:, None]
    points = (1 - u) * curves.points[i] + u * curves.points[nxt]
    return points, offsets.astype(np.int64), closed[kept], kept


def smooth_curves(points, offsets, closed, sigma, order=2):
    """Points smoothed along each curve, bends kept. Open ends stay.

    With G the Gaussian mean, 1 - (1 - G)^2 = 2 G - G^2 leaves every parabola as it is; G alone would shrink a circle
    of radius r by sigma^2 / (2 r). Each order more keeps two degrees more.
    """
    smooth, left = np.zeros_like(points), points
    for _ in range(order):
        mean = _gaussian_mean(left, offsets, closed, sigma)
        smooth, left = smooth + mean, left - mean
    return smooth


def _gaussian_mean(points, offsets, closed, sigma):
    """Gaussian mean along each curve; open ends are reflected through the end point."""
    radius = int(np.ceil(3 * sigma))
    taps = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    taps /= taps.sum()
    out = np.empty_like(points)
    for first, stop, ring in zip(offsets[:-1], offsets[1:], closed):
        p = points[first:stop]
        if ring:
            padded = p[np.arange(-radius, len(p) + radius) % len(p)]
        else:
            k = np.minimum(np.arange(1, radius + 1), len(p) - 1)
            padded = np.concatenate([2 * p[0] - p[k[::-1]], p, 2 * p[-1] - p[len(p) - 1 - k]])
        out[first:stop] = correlate1d(padded, taps, axis=0, mode="nearest")[radius : radius + len(p)]
    return out


def resample_polyline(points, step, closed):
    """(k, 3) float64, points of one polyline about `step` apart; the first is not repeated on a closed one."""
    one = Curves(points, np.array([0, len(points)]), np.array([closed]))
    return resample_curves(one, step)[0]


def smooth_polyline(points, sigma, closed, order=2):
    """(k, 3) float64, a polyline smoothed over about `sigma` samples, bends kept; ends stay."""
    if sigma <= 0:
        return points
    return smooth_curves(points, np.array([0, len(points)]), np.array([closed]), sigma, order)


def steady_polyline(points, closed, *, off=0.6, most=1.5, widest=24.0):
    """(k, 3) float64, a polyline with samples one edge apart, smoothed as far as it stays what it is.

    What is seen once has no other occurrence to average with. It is smoothed over 3, 6, 12, ... samples as long as
    that moves it by at most `off` on average (RMS) and `most` anywhere: noise does not need more, a corner does.
    """
    best, sigma = points, 3.0
    while sigma <= min(widest, len(points) / 3):
        line = smooth_polyline(points, sigma, closed, order=3)
        way = np.linalg.norm(line - points, axis=1)
        if np.sqrt((way**2).mean()) > off or way.max() > most:
            break
        best, sigma = line, 2 * sigma
    return best


def directions(curve) -> np.ndarray:
    """(k, 3) float64, unit tangents of a polyline."""
    step = np.gradient(curve, axis=0)
    return step / np.maximum(np.linalg.norm(step, axis=1), 1e-12)[:, None]


def outward(arms):
    """(e, 3) float64, unit directions in which paths leave through their ends.

    arms : e arrays (k, 3), samples from each end inwards. The direction is the slope at the end of a parabola through
    the arm.
    """
    way = np.array([arm[0] - arm[-1] for arm in arms]).reshape(-1, 3)
    for own, lines in _of_one_length(arms, 4):
        s = _travelled(lines)
        own, s, lines = own[s[:, -1] > 0], s[s[:, -1] > 0], lines[s[:, -1] > 0]
        way[own] = -_fitted(s, lines, 2)[1][:, 1]
    return way / np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]


def bend(a, b):
    """RMS distance of two arms, each from its end inwards, from one parabola through both (edge lengths)."""
    return float(bends([(a, b)])[0])


def bends(pairs):
    """(k,) float64, the `bend` of each pair of arms."""
    result = np.zeros(len(pairs))
    for own, lines in _of_one_length([np.concatenate([a[::-1], b]) for a, b in pairs]):
        s = _travelled(lines)
        fit, _ = _fitted(s / np.maximum(s[:, -1:], 1e-12), lines, 2)
        result[own] = np.sqrt(((fit - lines) ** 2).sum(2).mean(1))
    return result


def _of_one_length(lines, least=0):
    """Arrays (k, 3) of a list as stacks (m, k, 3) of those of one length, with their indices (m,)."""
    size = np.array([len(line) for line in lines], np.int64)
    for length in np.unique(size[size >= least]):
        own = np.flatnonzero(size == length)
        yield own, np.stack([lines[i] for i in own])


def _travelled(lines):
    """(m, k) float64, distance along each of (m, k, 3) lines from its start."""
    step = np.linalg.norm(np.diff(lines, axis=1), axis=2)
    return np.concatenate([np.zeros((len(lines), 1)), np.cumsum(step, axis=1)], axis=1)


def _fitted(s, lines, degree):
    """Least squares polynomials through lines (m, k, 3) at the parameters (m, k): their values (m, k, 3) and their
    coefficients (m, degree + 1, 3). All at once: small steps with LAPACK in each leave a window no time."""
    basis = s[:, :, None] ** np.arange(degree + 1)
    coefficients = np.linalg.pinv(basis) @ lines
    return basis @ coefficients, coefficients
