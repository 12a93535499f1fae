# SPDX-License-Identifier: GPL-3.0-or-later
"""The shortest description of a curve by trying every knot, one piece at a time; shares no code with the core."""

import math

import numpy as np

PRICE = {"plane": {"line": 4, "arc": 5, "bezier": 8}, "space": {"line": 5, "arc": 7, "bezier": 11}}


def line_left(p):
    singular = np.linalg.svd(p - p.mean(axis=0), compute_uv=False)
    return float((singular[1:] ** 2).sum())


def arc_left(p):
    """Kasa's circle in the best plane: |q|^2 = 2 c q + k by least squares, over the diameter squared."""
    q = p - p.mean(axis=0)
    _, s, axes = np.linalg.svd(q, full_matrices=False)
    xy = q @ axes[:2].T
    square = (q * q).sum(axis=1)
    solved, *_ = np.linalg.lstsq(np.c_[2 * xy, np.ones(len(p))], square, rcond=None)
    left = square - np.c_[2 * xy, np.ones(len(p))] @ solved
    return float((left**2).sum() / (4 * (solved[2] + solved[0] ** 2 + solved[1] ** 2)) + s[2] ** 2)


def cubic_left(p):
    t = np.linspace(-1, 1, len(p))
    basis = np.stack([t**0, t, t**2, t**3], axis=1)
    return float(((p - basis @ np.linalg.lstsq(basis, p, rcond=None)[0]) ** 2).sum())


def cheapest(p, variance, where):
    """The least cost, the kinds and the knots of the pieces of a polyline (n, 3)."""
    n = len(p)
    best = [0.0] + [math.inf] * n
    came = [None] * (n + 1)
    for end in range(2, n + 1):
        for start in range(end - 1):
            if best[start] == math.inf:
                continue
            part = p[start:end]
            tries = [("line", line_left(part))]
            if len(part) >= 4:
                tries.append(("arc", arc_left(part)))
            if len(part) >= 6:
                tries.append(("bezier", cubic_left(part)))
            for kind, left in tries:
                cost = best[start] + left / variance + PRICE[where][kind] * math.log(n)
                if cost < best[end]:
                    best[end], came[end] = cost, (start, kind)
    kinds, knots, at = [], [n], n
    while at:
        at, kind = came[at]
        kinds.append(kind)
        knots.append(at)
    return best[n], kinds[::-1], knots[::-1]
