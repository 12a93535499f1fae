# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines, arcs and circles read back out of the Bezier segments that stand for them.

Programs that know Bezier segments alone, as Blender, are given an arc as segments of at most a quarter turn. Here they
become the arc again, also after some of them were moved by hand: what is no arc any more stays a Bezier segment.
"""

from __future__ import annotations

import numpy as np

from .primitives import Arc, Bezier, Circle, Line

ROUNDING = 3e-5
"""How far control points may be off, as a share of the size of the path: some roundings of single precision."""

LARGEST = np.pi / 2 + 1e-3
"""Largest angle of one segment of an arc."""


def recognised(path, closed=False, *, tolerance=None) -> tuple:
    """The primitives of a path of Bezier segments; neighbours of one line or one circle are one.

    Parameters
    ----------
    path : (k, 4, 3) float64, control points, each segment begins where the last one ends
    closed : the last segment ends where the first begins
    tolerance : how far control points may be off, in the units of the path; from its size if None

    Notes
    -----
    O(k). Segments without a length are left out.
    """
    path = np.asarray(path, float).reshape(-1, 4, 3)
    path = path[(np.ptp(path, axis=1) > 0).any(axis=1)]
    if not len(path):
        return ()
    if tolerance is None:
        tolerance = ROUNDING * float(np.ptp(path.reshape(-1, 3), axis=0).max())
    pieces = [_one(segment, tolerance) for segment in path]
    if closed and _is_circle(pieces, tolerance):
        first = pieces[0]
        return (Circle(first.centre, first.normal, first.radius, first.start),)
    out = pieces[:1]
    for piece in pieces[1:]:
        joined = _joined(out[-1], piece, tolerance)
        if joined is None:
            out.append(piece)
        else:
            out[-1] = joined
    return tuple(out)


def _is_circle(pieces, tolerance) -> bool:
    """Whether pieces in a row go once around one circle."""
    if any(p.kind != "arc" for p in pieces) or abs(sum(p.angle for p in pieces) - 2 * np.pi) > 1e-2:
        return False
    return all(_is_same_circle(pieces[0], p, tolerance) for p in pieces[1:])


def _is_same_circle(a, b, tolerance) -> bool:
    loose = 30 * tolerance  # centre and radius come from the short rise of an arc, which magnifies rounding
    alike = abs(a.radius - b.radius) <= loose and np.linalg.norm(a.centre - b.centre) <= loose
    return bool(alike and a.normal @ b.normal > 1 - 1e-4)


def _one(segment, tolerance):
    """A single segment as a line or an arc where it is one."""
    start, first, second, end = segment
    chord = end - start
    size = np.linalg.norm(chord)
    if size > tolerance:
        off = segment[1:3] - start
        along = off @ chord / size
        if np.linalg.norm(off - along[:, None] * chord / size, axis=1).max() <= tolerance and (
            -tolerance <= along[0] <= along[1] + tolerance and along[1] <= size + tolerance
        ):
            return Line(start, end)
        middle = (start + 3 * first + 3 * second + end) / 8
        rise = middle - (start + end) / 2
        if np.linalg.norm(rise) > 0 and abs(rise @ chord) <= tolerance * size:
            arc = Arc(start, middle, end)
            reach = 4 / 3 * np.tan(arc.angle / 4) * arc.radius
            handles = np.array([start, end]) + reach * arc.tangents() * [[1.0], [-1.0]]
            if arc.angle <= LARGEST and np.abs(handles - segment[1:3]).max() <= tolerance:
                return arc
    return Bezier(start, first, second, end)


def _joined(before, after, tolerance):
    """Both as one line or one arc, None where they are not."""
    if before.kind != after.kind or before.kind == "bezier":
        return None
    if np.linalg.norm(before.end - after.start) > tolerance:
        return None
    turn = np.linalg.norm(before.tangents()[1] - after.tangents()[0])
    if before.kind == "line":
        return Line(before.start, after.end) if turn * min(before.length, after.length) <= tolerance else None
    if not _is_same_circle(before, after, tolerance) or turn > 1e-2 or before.angle + after.angle > 2 * np.pi - 1e-2:
        return None
    # Half way: the direction from the centre to the joint, turned by half of what one angle is more than the other.
    half = (after.angle - before.angle) / 2
    out = before.end - before.centre
    across = np.cross(before.normal, out)
    return Arc(before.start, before.centre + np.cos(half) * out + np.sin(half) * across, after.end)
