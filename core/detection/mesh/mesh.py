# SPDX-License-Identifier: GPL-3.0-or-later
"""A triangle mesh made fit for detection: cleaned, consistently oriented, with its edges."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...errors import InputError
from .blocks import parts
from .edges import edge_table
from .memory import room_for
from .ordering import group_starts, order_by
from .orientation import oriented

_DEGENERATE = 1e-12
"""A face is dropped when twice its area is below this share of its longest edge squared: rounding alone
makes normals of such faces meaningless in double precision."""


@dataclass(frozen=True)
class TriangleMesh:
    """Vertices in scene units and oriented triangles over them; every vertex is used, no face is degenerate.

    vertices : (n, 3) float64
    faces : (m, 3) int64, counter-clockwise seen from outside
    vertex_source : (n,) int64, the first input vertex at this place
    face_source : (m,) int64, the input face (polygon) that this triangle came from
    edges : (e, 2) int64, lower vertex first, in order
    face_edges : (m, 3) int64, column j is the edge opposite corner j

    Make one with `TriangleMesh.of`; the constructor itself checks nothing.
    """

    vertices: np.ndarray
    faces: np.ndarray
    vertex_source: np.ndarray
    face_source: np.ndarray
    edges: np.ndarray
    face_edges: np.ndarray

    @classmethod
    def of(cls, vertices, faces, *, progress=None) -> TriangleMesh:
        """Clean input of any kind.

        Parameters
        ----------
        vertices : (n, 3) array of finite numbers; duplicates and vertices without a face are allowed
        faces : (m, k) int array, or a sequence of polygons of at least 3 vertex indices each
        progress : called as progress("mesh", fraction), may raise Cancelled

        Raises
        ------
        InputError
            no faces, indices out of range, coordinates that are not finite, only zero-area faces, too little memory

        Notes
        -----
        Equal points are made one vertex, polygons become fans, faces of zero area and repeated faces go,
        neighbours are turned to agree, and closed outer shells face outwards. Near linear.
        """
        done = 0

        def tick():
            nonlocal done
            done += 1
            if progress is not None:
                progress("mesh", done / (done + 10))

        with room_for(0 if faces is None else len(faces)):
            made = cls._cleaned(vertices, faces, tick)
        if progress is not None:
            progress("mesh", 1.0)
        return made

    @classmethod
    def _cleaned(cls, vertices, faces, tick) -> TriangleMesh:
        tick()
        vertices = _checked_vertices(vertices)
        triangles, source = triangulate(faces)
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            bad = int(triangles.min() if triangles.min() < 0 else triangles.max())
            raise InputError(f"a face names vertex {bad}, but there are {len(vertices)}: the mesh is damaged")
        tick()
        used = _named(triangles, len(vertices))
        if not np.isfinite(vertices[used]).all():
            bad = int(used[~np.isfinite(vertices[used]).all(axis=1)][0])
            raise InputError(f"vertex {bad} has a coordinate that is not a finite number: remove or repair it")
        tick()
        first, position = _distinct(vertices[used])
        tick()
        index = np.zeros(len(vertices), np.int64)
        index[used] = position
        points, faces = vertices[used[first]], index[triangles]
        tick()
        keep = np.flatnonzero(_has_area(points, faces, tick))
        keep = keep[_first_of_each(faces[keep], len(points), tick)]
        if not len(keep):
            raise InputError("all faces have zero area: give a mesh with a surface")
        tick()
        inside = _named(faces[keep], len(points))
        index = np.zeros(len(points), np.int64)
        index[inside] = np.arange(len(inside))
        points, faces = points[inside], index[faces[keep]]
        tick()
        edges, face_edges = edge_table(faces, len(points), tick)
        turn = oriented(points, faces, face_edges, tick)
        faces[turn], face_edges[turn] = faces[turn][:, [0, 2, 1]], face_edges[turn][:, [0, 2, 1]]
        return cls(points, faces, used[first][inside], source[keep], edges, face_edges)

    @cached_property
    def edge_faces(self) -> np.ndarray:
        """(e,) int64, number of faces at each edge: 1 on a boundary, above 2 where not manifold."""
        return np.bincount(self.face_edges.ravel(), minlength=len(self.edges))

    @cached_property
    def edge_lengths(self) -> np.ndarray:
        """(e,) float64, scene units."""
        return np.linalg.norm(np.diff(self.vertices[self.edges], axis=1)[:, 0], axis=1)

    @cached_property
    def edge_length(self) -> float:
        """Mean edge length, scene units: the unit of every length parameter."""
        return float(self.edge_lengths.mean())

    @cached_property
    def boundary_vertices(self) -> np.ndarray:
        """(n,) bool, on an edge that has one face only."""
        mask = np.zeros(len(self.vertices), bool)
        mask[self.edges[self.edge_faces == 1]] = True
        return mask


def triangulate(faces) -> tuple[np.ndarray, np.ndarray]:
    """Cut polygons into fans of triangles.

    Returns
    -------
    triangles : (t, 3) int64
    source : (t,) int64, polygon of each triangle
    """
    if faces is None or len(faces) == 0:
        raise InputError("the mesh has no faces: give a surface, or complete its curves directly")
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        corners = faces.ravel()
        sizes = np.full(len(faces), faces.shape[1])
    else:
        sizes = np.fromiter((len(f) for f in faces), np.int64, len(faces))
        corners = np.concatenate([np.asarray(f).ravel() for f in faces])
    if corners.dtype.kind not in "iu":
        raise InputError(f"face indices are of type {corners.dtype}: give whole numbers")
    if sizes.min() < 3:
        raise InputError(f"face {int(sizes.argmin())} has {int(sizes.min())} vertices: a face needs at least 3")
    starts = np.cumsum(sizes) - sizes
    source = np.repeat(np.arange(len(sizes)), sizes - 2)
    step = np.arange(len(source)) - np.repeat(np.cumsum(sizes - 2) - (sizes - 2), sizes - 2)
    base = starts[source]
    at = np.stack([base, base + step + 1, base + step + 2], axis=1)
    return corners[at].astype(np.int64), source


def _checked_vertices(vertices) -> np.ndarray:
    try:
        vertices = np.asarray(vertices, np.float64)
    except (TypeError, ValueError):
        raise InputError("the vertices are not numbers: give an (n, 3) array of coordinates") from None
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise InputError(f"the vertices have shape {vertices.shape}: give an (n, 3) array of coordinates")
    return vertices


def _named(faces, count) -> np.ndarray:
    """The vertices out of `count` that faces name, in order."""
    mask = np.zeros(count, bool)
    mask[faces.ravel()] = True
    return np.flatnonzero(mask)


def _distinct(points):
    """First index of each distinct point in order of appearance, and (n,) the distinct point of each."""
    points = points + 0.0  # makes -0 and 0 the same to the bit
    mixed = _mixed(points.view(np.uint64))
    order = np.argsort(mixed, kind="stable")
    new = group_starts(*points[order].T)
    if (new & ~group_starts(mixed[order])).any():  # unequal points were mixed to the same number
        order = np.lexsort(points.T)
        new = group_starts(*points[order].T)
    group = np.empty(len(points), np.int64)
    group[order] = np.cumsum(new) - 1
    first = order[new]  # the sort is stable: the first of each group has the lowest index
    mask = np.zeros(len(points), bool)
    mask[first] = True
    place = (np.cumsum(mask) - 1)[first]
    return np.flatnonzero(mask), place[group]


def _mixed(bits) -> np.ndarray:
    """(n,) uint64 that differ, but for rare accidents, where the rows of bits (n, 3) uint64 differ."""
    out = np.zeros(len(bits), np.uint64)
    for column in bits.T:
        out ^= column ^ (column >> np.uint64(32))
        out *= np.uint64(0x9E3779B97F4A7C15)
        out ^= out >> np.uint64(29)
    return out


def _has_area(points, faces, tick) -> np.ndarray:
    out = np.empty(len(faces), bool)
    for part in parts(len(faces)):
        p = points[faces[part]]
        sides = p[:, [1, 2, 0]] - p
        longest = (sides**2).sum(axis=2).max(axis=1)
        out[part] = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) > _DEGENERATE * longest
        tick()
    return out


def _first_of_each(faces, count, tick) -> np.ndarray:
    """Indices of the faces left when repeats of the same three of `count` vertices go, in order."""
    corners = np.sort(faces, axis=1).T
    order = order_by(*corners, count=count, tick=tick)
    return np.sort(order[group_starts(*corners[:, order])])
