# SPDX-License-Identifier: GPL-3.0-or-later
"""Curvature tensors and their derivative per vertex [Rus04], at a smoothing scale.

[Rus04] Rusinkiewicz, Estimating Curvatures and Their Derivatives on Triangle Meshes, 2004. Convex is positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..mesh.blocks import gather, parts, sums
from ..mesh.mesh import TriangleMesh
from .noise import noise_fold, noise_level
from .smoothing import Diffusion, corner_areas, corner_cotangents

_TINY = 1e-300


@dataclass(frozen=True)
class Curvature:
    """Principal curvatures and directions with their derivatives along themselves, per vertex.

    high, low : (n,) float64, principal curvatures, high >= low, 1 / length, convex positive
    high_direction, low_direction : (n, 3) float64, unit, in the tangent plane; the sign is arbitrary
    high_slope, low_slope : (n,) float64, derivative of each curvature along its own direction (extremality)
    points, normals : (n, 3) float64, the smoothed surface; the normals are unit
    width : (n,) float64, standard deviation of all smoothing that the curvatures went through, scene units
    scale : the standard deviation that was asked for, scene units
    noise : radians, the fold angle that the mesh's noise alone makes after this smoothing (noise.py)
    """

    high: np.ndarray
    low: np.ndarray
    high_direction: np.ndarray
    low_direction: np.ndarray
    high_slope: np.ndarray
    low_slope: np.ndarray
    points: np.ndarray
    normals: np.ndarray
    width: np.ndarray
    scale: float
    noise: float

    @property
    def strength(self) -> np.ndarray:
        """(n,) float64, the larger absolute principal curvature, 1 / length."""
        return np.maximum(np.abs(self.high), np.abs(self.low))


def curvature(mesh: TriangleMesh, scale: float, *, fine: float = 0.5, diffusion=None, tick=None) -> Curvature:
    """Fit the tensors of the surface smoothed by the standard deviation `scale` (scene units).

    The positions are diffused first, because a fit cannot undo noise that has entered the normals; the normals
    and the tensors are diffused by `fine` times as much again, so that the third derivatives are smooth too.
    diffusion : that of the mesh, if there is one already
    """
    tick = tick or (lambda: None)
    tick()
    diffusion = Diffusion.of(mesh, tick) if diffusion is None else diffusion
    tick()
    width = diffusion.width(scale)
    centre = mesh.vertices.mean(axis=0)  # keeps the digits of models far from the origin
    points = diffusion.smooth(mesh.vertices - centre, width, tick=tick)
    normals = vertex_normals(points, mesh, tick)
    if fine > 0:
        normals = _unit(diffusion.smooth(normals, fine * width, 2, tick))
    tick()
    noise = noise_fold(noise_level(mesh.vertices - centre, normals, mesh, tick), scale, mesh.edge_length)
    tensor = vertex_tensors(points, normals, mesh, tick)
    if fine > 0:
        tensor = _tangential(diffusion.smooth(tensor, fine * width, 2, tick), normals)
    u, v = tangent_frames(normals)
    tick()
    high, low, high_direction, low_direction = principal(tensor, u, v)
    tick()
    derivative = vertex_derivatives(points, tensor, mesh, tick)
    if fine > 0:
        derivative = diffusion.smooth(derivative, fine * width, 1, tick)
    tick()
    whole = width * np.sqrt(1 + 2 * fine**2)  # of the curvatures: variances of diffusions add up
    slopes = cubic(derivative, high_direction), cubic(derivative, low_direction)
    return Curvature(high, low, high_direction, low_direction, *slopes, points + centre, normals, whole, scale, noise)


def _unit(vectors):
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > _TINY)


def vertex_normals(points, mesh: TriangleMesh, tick=lambda: None) -> np.ndarray:
    """(n, 3) float64, unit normals weighted by area over squared lengths of the sides, exact on a sphere [Max 1999]."""
    total = sums(len(points), 3)
    for part in parts(len(mesh.faces)):
        faces = mesh.faces[part]
        p = points[faces]
        side = p[:, [1, 2, 0]] - p
        square = (side**2).sum(axis=2)
        normal = np.cross(side[:, 0], side[:, 1])
        # corner j lies between side j and side j-1
        weight = 1 / np.maximum(square * square[:, [2, 0, 1]], _TINY)
        gather(total, faces.ravel(), (normal[:, None] * weight[:, :, None]).reshape(-1, 3))
        tick()
    return _unit(np.ascontiguousarray(total))


def tangent_frames(normals) -> tuple[np.ndarray, np.ndarray]:
    """Two unit tangents (n, 3) at right angles to each normal, right-handed."""
    # branch-free frame: the sign keeps the denominator away from zero
    x, y, z = normals.T
    s = np.where(z >= 0, 1.0, -1.0)
    a = -1 / (s + z)
    b = x * y * a
    u = np.stack([1 + s * x * x * a, s * b, -s * x], axis=1)
    v = np.stack([b, s + y * y * a, -y], axis=1)
    return u, v


@dataclass(frozen=True)
class FaceShape:
    """Frames and sides of the faces: u, v, normal (m, 3) unit; side_u, side_v (m, 3), side j opposite corner j,
    in the frame; area (m,); weight (m, 3), the share of the area at each corner."""

    u: np.ndarray
    v: np.ndarray
    normal: np.ndarray
    side_u: np.ndarray
    side_v: np.ndarray
    area: np.ndarray
    weight: np.ndarray


def face_shape(points, faces) -> FaceShape:
    """Frame of each face: u along its first side, v at right angles in its plane."""
    p = points[faces]
    side = p[:, [2, 0, 1]] - p[:, [1, 2, 0]]
    normal = np.cross(side[:, 0], side[:, 1])
    area = 0.5 * np.linalg.norm(normal, axis=1)
    normal = _unit(normal)
    u = _unit(side[:, 0])
    v = np.cross(normal, u)
    side_u = np.einsum("ijk,ik->ij", side, u)
    side_v = np.einsum("ijk,ik->ij", side, v)
    return FaceShape(u, v, normal, side_u, side_v, area, corner_areas(side, corner_cotangents(side, area), area))


def face_tensors(shape: FaceShape, normals, faces) -> np.ndarray:
    """(m, 3) float64: a, b, c of the second form [[a, b], [b, c]] in the face's frame.

    Least squares over the three sides of (a, b; b, c) side = change of normal, [Rus04] section 3. Its normal
    equations [[A, B, 0], [B, A + C, B], [0, B, C]] have the determinant (A + C)(AC - B^2).
    """
    n = normals[faces]
    change = n[:, [2, 0, 1]] - n[:, [1, 2, 0]]
    du = np.einsum("ijk,ik->ij", change, shape.u)
    dv = np.einsum("ijk,ik->ij", change, shape.v)
    su, sv = shape.side_u, shape.side_v
    A, B, C = (su * su).sum(1), (su * sv).sum(1), (sv * sv).sum(1)
    ru, rm, rv = (su * du).sum(1), (sv * du + su * dv).sum(1), (sv * dv).sum(1)
    determinant = np.maximum((A + C) * (A * C - B * B), _TINY)
    A, C = np.maximum(A, _TINY), np.maximum(C, _TINY)
    b = (A * C * rm - B * C * ru - A * B * rv) / determinant
    return np.stack([(ru - B * b) / A, b, (rv - B * b) / C], axis=1)


def vertex_tensors(points, normals, mesh: TriangleMesh, tick=lambda: None) -> np.ndarray:
    """(n, 6) float64: xx, xy, xz, yy, yz, zz of the tensor at each vertex, the mean of its faces by area.

    Each face's tensor is first turned by the smallest rotation that takes the face's normal to the vertex's
    ([Rus04] section 3.1): projecting it would lose curvature where the surface bends.
    """
    total = sums(len(points), 7)
    for part in parts(len(mesh.faces)):
        faces = mesh.faces[part]
        shape = face_shape(points, faces)
        tensors = face_tensors(shape, normals, faces)
        tick()
        world = np.empty((len(faces), 3, 7))
        for j in range(3):
            u, v = _rotated((shape.u, shape.v), shape.normal, normals[faces[:, j]])
            world[:, j, :6] = _symmetric(tensors, u, v) * shape.weight[:, j, None]
        world[:, :, 6] = shape.weight
        gather(total, faces.ravel(), world.reshape(-1, 7))
        tick()
    return np.ascontiguousarray(total[:, :6] / np.maximum(total[:, 6:], _TINY))


def _rotated(vectors, start, end):
    """Vectors turned by the smallest rotation from unit `start` to unit `end`.

    R x = x - (x.(s + e)) / (1 + s.e) (s + e) + 2 (x.s) e, and x.s = 0 here.
    """
    middle = start + end
    factor = 1 / np.maximum(1 + np.einsum("ij,ij->i", start, end), 1e-6)
    return [x - (np.einsum("ij,ij->i", x, end) * factor)[:, None] * middle for x in vectors]


def _symmetric(t, u, v):
    """(m, 6) world components of a uu + b (uv + vu) + c vv."""
    a, b, c = t.T
    pairs = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    return np.stack(
        [a * u[:, i] * u[:, j] + b * (u[:, i] * v[:, j] + v[:, i] * u[:, j]) + c * v[:, i] * v[:, j] for i, j in pairs],
        axis=1,
    )


def _in_frame(t, u, v):
    """(n, 3): a, b, c of world tensors (n, 6) in the frames u, v."""

    def form(p, q):
        return (
            t[:, 0] * p[:, 0] * q[:, 0]
            + t[:, 3] * p[:, 1] * q[:, 1]
            + t[:, 5] * p[:, 2] * q[:, 2]
            + t[:, 1] * (p[:, 0] * q[:, 1] + p[:, 1] * q[:, 0])
            + t[:, 2] * (p[:, 0] * q[:, 2] + p[:, 2] * q[:, 0])
            + t[:, 4] * (p[:, 1] * q[:, 2] + p[:, 2] * q[:, 1])
        )

    return np.stack([form(u, u), form(u, v), form(v, v)], axis=1)


def _tangential(t, normals):
    """World tensors (n, 6) without their part along the normal."""
    u, v = tangent_frames(normals)
    return _symmetric(_in_frame(t, u, v), u, v)


def principal(tensor, u, v):
    """Principal curvatures high >= low (n,) and their unit directions (n, 3) of world tensors (n, 6)."""
    a, b, c = _in_frame(tensor, u, v).T
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    root = np.hypot(half, b)
    angle = 0.5 * np.arctan2(b, half)
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    return mean + root, mean - root, cos * u + sin * v, cos * v - sin * u


def face_derivatives(shape: FaceShape, tensor, faces) -> np.ndarray:
    """(m, 4) float64: the symmetric derivative of the tensor in each face's frame, [Rus04] section 4.

    Components uuu, uuv, uvv, vvv; least squares over the three sides, off-diagonal entries counted twice.
    """
    u, v, su, sv = shape.u, shape.v, shape.side_u, shape.side_v
    local = [_in_frame(tensor[faces[:, j]], u, v) for j in range(3)]
    matrix = np.zeros((len(faces), 4, 4))
    right = np.zeros((len(faces), 4))
    A, B, C = (su * su).sum(1), (su * sv).sum(1), (sv * sv).sum(1)
    matrix[:, 0, 0], matrix[:, 1, 1], matrix[:, 2, 2], matrix[:, 3, 3] = A, 2 * A + C, A + 2 * C, C
    matrix[:, 0, 1] = matrix[:, 1, 0] = matrix[:, 2, 3] = matrix[:, 3, 2] = B
    matrix[:, 1, 2] = matrix[:, 2, 1] = 2 * B
    for j in range(3):
        da, db, dc = (local[(j + 2) % 3] - local[(j + 1) % 3]).T
        s, t = su[:, j], sv[:, j]
        right[:, 0] += s * da
        right[:, 1] += t * da + 2 * s * db
        right[:, 2] += 2 * t * db + s * dc
        right[:, 3] += t * dc
    size = np.maximum(A + C, _TINY)
    matrix /= size[:, None, None]
    matrix[:, range(4), range(4)] += 1e-9  # needle faces only: the fit of a sound face changes by a billionth
    return np.linalg.solve(matrix, (right / size[:, None])[:, :, None])[:, :, 0]


_CUBIC = ((0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 0, 1), (0, 0, 2), (0, 1, 1), (1, 1, 2), (0, 2, 2), (1, 2, 2), (0, 1, 2))
_TIMES = np.array([1, 1, 1, 3, 3, 3, 3, 3, 3, 6.0])


def vertex_derivatives(points, tensor, mesh: TriangleMesh, tick=lambda: None) -> np.ndarray:
    """(n, 10) float64: independent entries of the symmetric cubic form in world axes, the mean of the faces by area."""
    total = sums(len(points), 11)
    for part in parts(len(mesh.faces)):
        faces = mesh.faces[part]
        shape = face_shape(points, faces)
        world = np.ones((len(faces), 11))
        world[:, :10] = _cubic_form(face_derivatives(shape, tensor, faces), shape.u, shape.v)
        tick()
        for j in range(3):
            gather(total, faces[:, j], world * shape.weight[:, j, None])
        tick()
    return np.ascontiguousarray(total[:, :10] / np.maximum(total[:, 10:], _TINY))


def _cubic_form(derivatives, u, v) -> np.ndarray:
    """(m, 10) float64, the entries `_CUBIC` of the derivatives (m, 4) in world axes."""
    p, q, r, s = derivatives.T
    world = np.empty((len(u), 10))
    for k, (a, b, c) in enumerate(_CUBIC):
        ua, ub, uc, va, vb, vc = u[:, a], u[:, b], u[:, c], v[:, a], v[:, b], v[:, c]
        world[:, k] = (
            p * ua * ub * uc
            + q * (ua * ub * vc + ua * vb * uc + va * ub * uc)
            + r * (ua * vb * vc + va * ub * vc + va * vb * uc)
            + s * va * vb * vc
        )
    return world


def cubic(form, direction) -> np.ndarray:
    """(n,) float64, the cubic form (n, 10) applied three times to a direction (n, 3)."""
    t = direction.T
    return sum(n * form[:, k] * t[a] * t[b] * t[c] for k, ((a, b, c), n) in enumerate(zip(_CUBIC, _TIMES)))
