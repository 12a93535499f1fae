# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a principal curvature is extremal along its own direction: crest points on edges [OBS04], [YBS05].

[OBS04] Ohtake, Belyaev, Seidel, Ridge-valley lines on meshes via implicit surface fitting.
[YBS05] Yoshizawa, Belyaev, Seidel, Fast and robust detection of crest lines on meshes.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from ..curvature.tensor import Curvature
from ..mesh.mesh import TriangleMesh
from ..values import RIDGE
from .lines import Lines

_PROMINENT = 0.01
"""Least fall of the curvature beside a crest, see `_fall`. On spheres, cylinders and tori every point is extremal but
for rounding and sampling; that stays below this at the details in use, and real creases are near 1."""

MESH = 0.8
"""Edge lengths: the fit of the tensors smooths by itself. Measured on creases of 20 to 60 degrees at details to 1."""

_DOMINANT = 0.5
"""A crest's curvature must be above this share of the other's, absolutely. [YBS05] ask for all of it, which breaks
the outline of an opening wherever the surface is saddle-like."""


@dataclass(frozen=True)
class Extremality:
    """One principal curvature as seen by crest lines: a valley is a ridge of the surface turned inside out.

    value, other : (n,) float64, the curvature that must be maximal, and the second one
    direction : (n, 3) float64, unit, sign arbitrary
    slope : (n,) float64, derivative of `value` along `direction`; changes sign with it
    """

    value: np.ndarray
    other: np.ndarray
    direction: np.ndarray
    slope: np.ndarray

    @classmethod
    def of(cls, curvature: Curvature, kind: int) -> Extremality:
        if kind == RIDGE:
            return cls(curvature.high, curvature.low, curvature.high_direction, curvature.high_slope)
        return cls(-curvature.low, -curvature.high, curvature.low_direction, -curvature.low_slope)


def fold_angle(value: np.ndarray, width: np.ndarray, edge_length: float) -> np.ndarray:
    """Fold angle in radians that a curvature stands for.

    A fold by the angle w smoothed with a Gaussian of deviation s has the curvature w / (s sqrt(2 pi)) at its top.
    """
    return np.maximum(value, 0) * np.sqrt(_squared(width, edge_length)) * sqrt(2 * pi)


def _squared(width, edge_length):
    """The squared deviation of all smoothing, that of the fit of the tensors included."""
    return width**2 + (MESH * edge_length) ** 2


def crest_lines(
    mesh: TriangleMesh, curvature: Curvature, kind: int, least_fold: float, tick=lambda: None
) -> tuple[Lines, np.ndarray, np.ndarray]:
    """Zero crossings of the extremality along edges, joined through faces.

    Along an edge the direction of one end is turned to agree with the other's, so the crossing belongs to
    the edge alone and both faces share it. A face whose three directions agree in pairs has no crossing or
    two; where they do not (about an umbilic) one edge is left over: it ends the line, or of three
    the weakest is dropped. Edges with a fold below `least_fold` (radians) at both ends are not looked at.

    Returns
    -------
    lines : one point for each crossing, on the mesh's own edge
    sound : (p,) bool, a maximum (not a minimum) that is not small against the other curvature
    vertex : (p,) int64, the nearer end of each point's edge
    """
    field = Extremality.of(curvature, kind)
    fold = fold_angle(field.value, curvature.width, mesh.edge_length)
    i, j = mesh.edges.T
    looked_at = np.flatnonzero((fold[i] >= least_fold) | (fold[j] >= least_fold))
    i, j = i[looked_at], j[looked_at]
    same = np.einsum("ij,ij->i", field.direction[i], field.direction[j]) >= 0
    # an exact zero counts as positive in its own frame, so that all edges of the vertex agree on it
    slope = np.where(field.slope == 0, 1e-300, field.slope)
    end = np.where(same, slope[j], -slope[j])
    crossing = (slope[i] > 0) != (end > 0)
    looked_at, i, j, end = looked_at[crossing], i[crossing], j[crossing], end[crossing]
    share = np.abs(slope[i]) / (np.abs(slope[i]) + np.abs(end))
    tick()
    point_of = np.full(len(mesh.edges), -1)
    point_of[looked_at] = np.arange(len(looked_at))

    def between(values):
        weight = share if values.ndim == 1 else share[:, None]
        return (1 - weight) * values[i] + weight * values[j]

    strength, other = between(field.value), between(field.other)
    faces, segments = _through_faces(point_of[mesh.face_edges], strength)
    tick()
    maximal = np.zeros(len(i), bool)
    maximal[segments[_fall(mesh, curvature, field, faces) > _PROMINENT]] = True
    tick()
    normals = between(curvature.normals)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sound = maximal & (strength > _DOMINANT * np.abs(other))
    largest = np.maximum(np.abs(strength), np.abs(other))  # on a faint stretch the line's own may have the wrong sign
    lines = Lines(between(mesh.vertices), normals, largest, between(fold), segments)
    return lines, sound, np.where(share < 0.5, i, j)


def _through_faces(points, strength):
    """Faces that a line passes through, and the two crest points (s, 2) on its edges."""
    count = (points >= 0).sum(axis=1)
    faces = np.flatnonzero(count >= 2)
    points = points[faces]
    weight = np.where(points >= 0, strength[points], -np.inf)
    two = np.sort(np.argsort(-weight, axis=1, kind="stable")[:, :2], axis=1)
    return faces, np.take_along_axis(points, two, axis=1)


def _fall(mesh, curvature, field, faces) -> np.ndarray:
    """(s,) float64: how sharply the curvature is maximal in these faces; negative where it is minimal.

    It is the fall of the slope along the direction, times the squared smoothing width, over the curvature: the share
    of the curvature that is lost about one and a half widths away. 1 on a smoothed fold, 0 on a cylinder.

    The slope is linear in the face, with the signs of the corners turned to agree with the first; its
    gradient is the sum of the corner values times (normal x opposite side) / (2 area).
    """
    corner = mesh.faces[faces]
    direction = field.direction[corner]
    sign = np.where(np.einsum("ijk,ik->ij", direction, direction[:, 0]) >= 0, 1.0, -1.0)
    slope = field.slope[corner] * sign
    along = (direction * sign[:, :, None]).sum(axis=1)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    p = curvature.points[corner]
    side = p[:, [2, 0, 1]] - p[:, [1, 2, 0]]
    normal = np.cross(side[:, 0], side[:, 1])  # its length is twice the area
    gradient = (
        np.cross(normal[:, None], side) / np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)[:, None, None]
    )
    fall = -np.einsum("ij,ijk,ik->i", slope, gradient, along)
    square = _squared(curvature.width[corner].mean(axis=1), mesh.edge_length)
    return fall * square / np.maximum(np.abs(field.value[corner].mean(axis=1)), 1e-300)
