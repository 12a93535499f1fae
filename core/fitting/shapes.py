# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines, arcs and Bezier segments as functions of plain numbers, as least squares needs them.

A piece is a row q: its start A, its end B, and what is its own: the rise of an arc's middle over its chord (3 numbers,
of which those across the chord count), or the two handles of a Bezier segment (6). Rows may be stacked.
"""

from __future__ import annotations

import numpy as np

from .primitives import Arc, Bezier, Line, bernstein

OWN = (0, 3, 6)
"""Own numbers of a line, an arc and a Bezier segment."""


def at(kind, q, u):
    """(..., k, 3) float64, points of pieces q (..., p) at u (k,), 0 at the start and 1 at the end."""
    a, b = q[..., None, 0:3], q[..., None, 3:6]
    u = np.asarray(u)[:, None]
    if kind == 0:
        return a + (b - a) * u
    if kind == 2:
        return np.einsum("kc,...cd->...kd", bernstein(u[:, 0]), _control(q))
    foot, along, up, half, rise = _frame(q)
    radius = (half**2 + rise**2) / (2 * rise)
    widest = 2 * np.arctan2(rise, half)
    angle = (2 * u - 1) * widest
    height = 2 * radius * np.sin((widest + angle) / 2) * np.sin((widest - angle) / 2)
    return foot + radius * np.sin(angle) * along + height * up


def ends(kind, q):
    """(..., 2, 3) float64, unit tangents at the start and at the end."""
    if kind == 0:
        t = _unit(q[..., 3:6] - q[..., 0:3])
        return np.stack([t, t], axis=-2)
    if kind == 2:
        return np.stack([_unit(q[..., 6:9] - q[..., 0:3]), _unit(q[..., 3:6] - q[..., 9:12])], axis=-2)
    _, along, up, half, rise = (x[..., 0, :] for x in _frame(q))
    widest = 2 * np.arctan2(rise, half)
    return np.stack([np.cos(widest) * along + np.sin(widest) * up, np.cos(widest) * along - np.sin(widest) * up], -2)


def directions(kind, q, u):
    """(k, 3) float64, unit tangents of one piece at u."""
    if kind == 0:
        return np.broadcast_to(ends(0, q)[0], (len(u), 3))
    if kind == 2:
        c, s = np.diff(_control(q), axis=0), 1 - u
        return _unit(np.stack([s * s, 2 * s * u, u * u], axis=1) @ c)
    _, along, up, half, rise = (x[0] for x in _frame(q))
    angle = ((2 * u - 1) * 2 * np.arctan2(rise, half))[:, None]
    return np.cos(angle) * along - np.sin(angle) * up


def nearest(kind, q, points, before=None, rounds=2):
    """(k,) float64, where a piece is nearest to points; on a Bezier segment from `before` on, by Newton's method."""
    a, b = q[0:3], q[3:6]
    if kind == 0:
        chord = b - a
        return (points - a) @ chord / max(chord @ chord, 1e-300)
    if kind == 1:
        foot, along, up, half, rise = (x[0] for x in _frame(q))
        out = points - foot - up * (rise - (half**2 + rise**2) / (2 * rise))
        widest = 2 * np.arctan2(rise, half)[0]
        return (np.arctan2(out @ along, out @ up) / widest + 1) / 2
    c = _control(q)
    d, dd = 3 * np.diff(c, axis=0), 6 * np.diff(c, n=2, axis=0)
    u = before
    for _ in range(rounds):
        s = 1 - u
        gap = bernstein(u) @ c - points
        way = np.stack([s * s, 2 * s * u, u * u], axis=1) @ d
        turn = np.stack([s, u], axis=1) @ dd
        square = (way * way).sum(axis=1)
        slope = np.maximum(square + (gap * turn).sum(axis=1), 0.3 * square)
        u = np.clip(u - (gap * way).sum(axis=1) / np.maximum(slope, 1e-300), 0, 1)
    return u


def normal_equations(kind, q, points, before):
    """What least squares needs of one piece q (p,) and its samples (k, 3).

    Returns where they are on it (k,), how far off across it (k, 3), the matrix (p, p) and the pull (p,): the products
    of the slopes across the piece with each other and with what the samples are off.

    Notes
    -----
    A line and a Bezier segment are sums of their control points: each block of the matrix is a sum of weights times the
    projection across the piece, and the slopes themselves are never written down.
    """
    u = nearest(kind, q, points, before)
    way = directions(kind, q, u)
    gap = points - at(kind, q, u)
    if kind == 2:  # a sample beyond an end pulls at it, or the end would slip along the curve
        way = way * ((u > 0) & (u < 1))[:, None]
    gap = gap - (gap * way).sum(axis=1)[:, None] * way
    if kind == 1:
        slope = slopes(kind, q, u)
        slope = (slope - (slope * way).sum(axis=2)[:, :, None] * way).reshape(len(q), -1)
        return u, gap, slope @ slope.T, slope @ gap.ravel()
    weights = np.stack([1 - u, u], axis=1) if kind == 0 else bernstein(u)[:, [0, 3, 1, 2]]
    k, m = weights.shape
    across = (np.eye(3) - way[:, :, None] * way[:, None, :]).reshape(k, 9)
    pairs = (weights[:, :, None] * weights[:, None, :]).reshape(k, m * m)
    matrix = (pairs.T @ across).reshape(m, m, 3, 3).transpose(0, 2, 1, 3).reshape(3 * m, 3 * m)
    return u, gap, matrix, (weights.T @ gap).ravel()


def slopes(kind, q, u):
    """(p, k, 3) float64, how the points at u move with each number of one piece."""
    if kind == 1:
        size = 1e-6 * (np.linalg.norm(q[3:6] - q[0:3]) + np.linalg.norm(q[6:9]))
        change = np.eye(len(q)) * size
        return (at(1, q + change, u) - at(1, q - change, u)) / (2 * size)
    weights = np.stack([1 - u, u], axis=1) if kind == 0 else bernstein(u)[:, [0, 3, 1, 2]]
    return np.einsum("kw,cd->wckd", weights, np.eye(3)).reshape(-1, len(u), 3)


def end_slopes(kind, q):
    """(p, 2, 3) float64, how the end tangents of one piece turn with each of its numbers."""
    size = 1e-6 * np.linalg.norm(q[3:6] - q[0:3]) + 1e-300
    change = np.eye(len(q)) * size
    return (ends(kind, q + change) - ends(kind, q - change)) / (2 * size)


def first_guess(kind, points, a, b):
    """The row q of a piece from a to b near the points (k, 3), and where on it they are (k,)."""
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(np.concatenate([a[None], points, b[None]]), axis=0), axis=1))]
    u = along[1:-1] / along[-1]
    if kind == 0:
        return np.r_[a, b], u
    if kind == 1:
        k = len(points) // 2
        middle = points[[k - 1, k]].mean(axis=0) if len(points) % 2 == 0 else points[k]
        return np.r_[a, b, middle - (a + b) / 2], u
    weights = bernstein(u)
    handles, *_ = np.linalg.lstsq(weights[:, 1:3], points - weights[:, :1] * a - weights[:, 3:] * b, rcond=None)
    return np.r_[a, b, handles.ravel()], u


def primitive(kind, q):
    """The piece as a value."""
    a, b = q[0:3].copy(), q[3:6].copy()
    if kind == 0:
        return Line(a, b)
    if kind == 1:
        foot, _, up, _, rise = (x[0] for x in _frame(q))
        return Arc(a, foot + rise * up, b)
    return Bezier(a, q[6:9].copy(), q[9:12].copy(), b)


def _control(q):
    return q.reshape(*q.shape[:-1], -1, 3)[..., [0, 2, 3, 1], :]


def _frame(q):
    """Of arcs q (..., 9): middle of the chord, unit chord, unit rise, half chord and height, all (..., 1, 3 or 1)."""
    a, b, own = q[..., None, 0:3], q[..., None, 3:6], q[..., None, 6:9]
    half = np.linalg.norm(b - a, axis=-1, keepdims=True) / 2
    along = _unit(b - a)
    rise = own - (own * along).sum(axis=-1, keepdims=True) * along
    height = np.maximum(np.linalg.norm(rise, axis=-1, keepdims=True), 1e-9 * half)
    return (a + b) / 2, along, rise / height, half, height


def _unit(v):
    return v / np.maximum(np.sqrt((v * v).sum(axis=-1, keepdims=True)), 1e-300)
