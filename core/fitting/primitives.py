# SPDX-License-Identifier: GPL-3.0-or-later
"""What curves are drawn with: lines, circular arcs, circles and cubic Bezier segments.

Each is frozen and says of itself: `start`, `end`, `length`, `beziers()` (handles, as Blender and SVG take them),
`points()` (as dense as asked for), `moved()` and `reversed()`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ARC_PIECE = np.pi / 2
"""Largest angle of one Bezier segment of an arc; it is off the arc by less than 2.8e-4 radii."""


@dataclass(frozen=True)
class Line:
    """start, end : (3,) float64."""

    start: np.ndarray
    end: np.ndarray

    kind = "line"

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    def tangents(self) -> np.ndarray:
        """(2, 3) float64, the unit directions at the start and at the end."""
        return np.tile(_unit(self.end - self.start), (2, 1))

    def beziers(self) -> np.ndarray:
        """(1, 4, 3) float64, the control points of its one Bezier segment."""
        return np.linspace(self.start, self.end, 4)[None]

    def points(self, step: float) -> np.ndarray:
        """(k, 3) float64, points at most `step` apart, both ends included."""
        return np.linspace(self.start, self.end, _count(self.length, step))

    def moved(self, motion) -> Line:
        """Under a (4, 4) rigid motion."""
        return Line(*_apply(motion, self.start, self.end))

    def reversed(self) -> Line:
        return Line(self.end, self.start)


@dataclass(frozen=True)
class Arc:
    """Part of a circle. start, middle, end : (3,) float64, `middle` lies on it half way."""

    start: np.ndarray
    middle: np.ndarray
    end: np.ndarray

    kind = "arc"

    @property
    def _frame(self):
        """Middle of the chord, unit chord, unit direction to the middle of the arc, half chord and rise."""
        foot = (self.start + self.end) / 2
        chord, rise = self.end - self.start, self.middle - foot
        return foot, _unit(chord), _unit(rise), np.linalg.norm(chord) / 2, np.linalg.norm(rise)

    @property
    def angle(self) -> float:
        """The angle it spans in radians, above 0 and below 2 pi."""
        *_, half, rise = self._frame
        return float(4 * np.arctan2(rise, half))

    @property
    def radius(self) -> float:
        *_, half, rise = self._frame
        return float((half**2 + rise**2) / (2 * rise))

    @property
    def centre(self) -> np.ndarray:
        """(3,) float64."""
        return self.middle - self._frame[2] * self.radius

    @property
    def normal(self) -> np.ndarray:
        """(3,) float64, the unit vector about which it turns to the left from start to end."""
        _, along, up, *_ = self._frame
        return np.cross(up, along)

    @property
    def length(self) -> float:
        return self.radius * self.angle

    def at(self, angle) -> np.ndarray:
        """(k, 3) float64, the points at angles (k,) measured from the middle, rising towards the end."""
        _, along, up, *_ = self._frame
        angle = np.asarray(angle, float)[:, None]
        return self.centre + self.radius * (np.sin(angle) * along + np.cos(angle) * up)

    def tangents(self) -> np.ndarray:
        _, along, up, *_ = self._frame
        half = self.angle / 2
        return np.array([np.cos(half) * along + np.sin(half) * up, np.cos(half) * along - np.sin(half) * up])

    def beziers(self) -> np.ndarray:
        """(k, 4, 3) float64, segments of at most a quarter turn."""
        _, along, up, *_ = self._frame
        count = max(1, int(np.ceil(self.angle / ARC_PIECE - 1e-9)))
        angles = np.linspace(-self.angle / 2, self.angle / 2, count + 1)
        knots = self.at(angles)
        knots[0], knots[-1] = self.start, self.end
        reach = 4 / 3 * np.tan(self.angle / count / 4) * self.radius
        way = reach * (np.cos(angles)[:, None] * along - np.sin(angles)[:, None] * up)
        return np.stack([knots[:-1], knots[:-1] + way[:-1], knots[1:] - way[1:], knots[1:]], axis=1)

    def points(self, step: float) -> np.ndarray:
        half = self.angle / 2
        points = self.at(np.linspace(-half, half, max(_count(self.length, step), 3)))
        points[0], points[-1] = self.start, self.end
        return points

    def moved(self, motion) -> Arc:
        return Arc(*_apply(motion, self.start, self.middle, self.end))

    def reversed(self) -> Arc:
        return Arc(self.end, self.middle, self.start)


@dataclass(frozen=True)
class Circle:
    """A whole circle. centre : (3,); normal : (3,) unit; radius; start : (3,) float64, the point where it begins."""

    centre: np.ndarray
    normal: np.ndarray
    radius: float
    start: np.ndarray

    kind = "circle"

    @property
    def end(self) -> np.ndarray:
        return self.start

    @property
    def length(self) -> float:
        return 2 * np.pi * self.radius

    def at(self, angle) -> np.ndarray:
        """(k, 3) float64, the points at angles (k,) from the start, to the left about the normal."""
        x = _unit(self.start - self.centre)
        y = np.cross(self.normal, x)
        angle = np.asarray(angle, float)[:, None]
        return self.centre + self.radius * (np.cos(angle) * x + np.sin(angle) * y)

    def tangents(self) -> np.ndarray:
        return np.tile(np.cross(self.normal, _unit(self.start - self.centre)), (2, 1))

    def beziers(self) -> np.ndarray:
        """(4, 4, 3) float64, the last one ends where the first begins."""
        angles = np.arange(5) * np.pi / 2
        knots = self.at(angles)
        knots[-1] = knots[0]
        way = 4 / 3 * np.tan(np.pi / 8) * np.cross(self.normal, knots - self.centre)
        return np.stack([knots[:-1], knots[:-1] + way[:-1], knots[1:] - way[1:], knots[1:]], axis=1)

    def points(self, step: float) -> np.ndarray:
        """(k, 3) float64, the first point is not repeated at the end."""
        count = max(_count(self.length, step) - 1, 8)
        return self.at(np.arange(count) * 2 * np.pi / count)

    def moved(self, motion) -> Circle:
        centre, start = _apply(motion, self.centre, self.start)
        return Circle(centre, motion[:3, :3] @ self.normal, self.radius, start)

    def reversed(self) -> Circle:
        return Circle(self.centre, -self.normal, self.radius, self.start)


@dataclass(frozen=True)
class Bezier:
    """A cubic Bezier segment. start, first, second, end : (3,) float64, its control points."""

    start: np.ndarray
    first: np.ndarray
    second: np.ndarray
    end: np.ndarray

    kind = "bezier"

    @property
    def control(self) -> np.ndarray:
        """(4, 3) float64."""
        return np.array([self.start, self.first, self.second, self.end])

    @property
    def length(self) -> float:
        return float(np.linalg.norm(np.diff(self.at(np.linspace(0, 1, 65)), axis=0), axis=1).sum())

    def at(self, t) -> np.ndarray:
        """(k, 3) float64, the points at parameters (k,) from 0 to 1."""
        return bernstein(np.asarray(t, float)) @ self.control

    def tangents(self) -> np.ndarray:
        c = self.control
        return np.array([_unit(c[1] - c[0], c[2] - c[0], c[3] - c[0]), _unit(c[3] - c[2], c[3] - c[1], c[3] - c[0])])

    def beziers(self) -> np.ndarray:
        return self.control[None]

    def points(self, step: float) -> np.ndarray:
        points = self.at(np.linspace(0, 1, max(_count(self.length, step), 4)))
        points[0], points[-1] = self.start, self.end
        return points

    def moved(self, motion) -> Bezier:
        return Bezier(*_apply(motion, *self.control))

    def reversed(self) -> Bezier:
        return Bezier(*self.control[::-1])


def bernstein(t) -> np.ndarray:
    """(k, 4) float64, the weights of the four control points at parameters (k,)."""
    s = 1 - t
    return np.stack([s**3, 3 * s * s * t, 3 * s * t * t, t**3], axis=-1)


def dense(primitives, step: float, closed: bool) -> np.ndarray:
    """(k, 3) float64, a chain of primitives as points at most `step` apart; a closed one does not repeat the first."""
    parts = [p.points(step) for p in primitives]
    if len(primitives) == 1 and primitives[0].kind == "circle":
        return parts[0]
    return np.concatenate([part[:-1] for part in parts] + ([] if closed else [parts[-1][-1:]]))


def _apply(motion, *points):
    return tuple(motion[:3, :3] @ p + motion[:3, 3] for p in points)


def _count(length, step):
    return int(np.ceil(length / step - 1e-9)) + 1 if length > 0 else 2


def _unit(*candidates):
    """The first of some vectors that has a length, as a unit vector."""
    for v in candidates:
        size = np.linalg.norm(v)
        if size > 0:
            return v / size
    return np.zeros(3)
