# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends that nearly reach another line are led on to it: corners, and where one edge runs into another.

At such places the direction of a crest is not defined, and lines end a few edges short of each other.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ...geometry.rows import distinct_rows
from ..curvature.tensor import Curvature
from ..values import RIDGE, VALLEY
from .extremality import Extremality, fold_angle
from .lines import Lines, travelled
from .linking import REACH, piece_ends
from .surface import Surface

_TARGETS = 24
"""Points of lines looked at ahead of an end. They lie about half an edge apart, so all within the reach are seen but
where several lines crowd; the nearest ones matter."""

_AWAY = 4.0
"""A line meets itself only where at least this many times the reach lies between, along the line."""

_OFF = 1.5
"""A way that leaves the surface by more than this many edges leads through the air."""


def met(
    found: list[Lines], kinds: list[int], surface: Surface, curvature: Curvature, *, reach: float, turn: float,
    fold: float, tick=lambda: None,
) -> list[Lines]:  # fmt: skip
    """Lines with the free ends led on to a line ahead of them, of whatever kind.

    The line that is met stays whole: the end gets a point of its own in the same place.

    Parameters
    ----------
    found, kinds : the lines of each kind, ridges and valleys among them
    reach : scene units, inclusive
    turn : radians, between the direction of the end and the way on
    fold : radians, least fold on the way on, of the kind of the end
    """
    h = surface.mesh.edge_length
    pieces = [lines.chains() for lines in found]
    ends = [piece_ends(x, c, REACH * h) for x, c in zip(found, pieces)]
    free = np.concatenate([np.full(len(e.node), k in (RIDGE, VALLEY)) for e, k in zip(ends, kinds)])
    if not free.any() or reach <= 0:
        return found
    tick()
    # one numbering for all kinds
    shift = np.cumsum([0] + [len(c) for c in pieces])
    targets = np.concatenate([x.points[c.nodes] for x, c in zip(found, pieces)])
    normals = np.concatenate([x.normals[c.nodes] for x, c in zip(found, pieces)])
    owner = np.concatenate([c.label + first for c, first in zip(pieces, shift)])
    arcs = [travelled(c, x.points) for x, c in zip(found, pieces)]
    arc, end_arc = np.concatenate(arcs), np.concatenate([a[e.place] for a, e in zip(arcs, ends)])
    of_kind = np.repeat(np.arange(len(kinds)), [len(e.node) for e in ends])
    chain = np.concatenate([e.chain + first for e, first in zip(ends, shift)])
    node, point, outward, normal = (
        np.concatenate([getattr(e, name) for e in ends]) for name in ("node", "point", "outward", "normal")
    )
    tick()
    # an end's own line comes first among its neighbours: look from a little ahead
    near = cKDTree(targets).query(point + 0.5 * reach * outward, min(_TARGETS, len(targets)))[1]
    near = near.reshape(len(point), -1)
    own = (owner[near] == chain[:, None]) & (np.abs(arc[near] - end_arc[:, None]) < _AWAY * reach)
    aim = _aim(point, outward, normal, near, targets[near], normals[near], ~own, h, reach, turn)
    tick()
    some = np.flatnonzero((aim >= 0) & free)
    some = some[_first_of_mutual(point[some], targets[aim[some]])]
    out = list(found)
    for i, kind in enumerate(kinds):
        mine, at = some[of_kind[some] == i], aim[some[of_kind[some] == i]]
        if len(mine):
            way = node[mine], point[mine], targets[at], normals[at]
            out[i] = _led(found[i], *way, kind, surface, curvature, fold)
        tick()
    return out


def _aim(point, outward, normal, near, targets, normals, allowed, edge_length, reach, turn) -> np.ndarray:
    """(e,) int64: of the targets near each end (e, k) the one reached on the shortest and straightest way, -1 for none.

    What is nearer than an edge may lie anywhere: the end has passed it.
    """
    way = targets - point[:, None]
    distance = np.linalg.norm(way, axis=2)
    ahead = np.einsum("ijk,ik->ij", way, outward) / np.maximum(distance, 1e-300)
    facing = np.einsum("ijk,ik->ij", normals, normal)
    fits = allowed & (distance <= reach) & (facing > 0) & ((ahead >= np.cos(turn)) | (distance <= edge_length))
    cost = np.where(fits, distance * (3 - 2 * ahead), np.inf)
    best = cost.argmin(axis=1)
    rows = np.arange(len(point))
    return np.where(np.isfinite(cost[rows, best]), near[rows, best], -1)


def _first_of_mutual(start, end) -> np.ndarray:
    """(k,) bool, without the ways back: of two ends that aim at each other the second stays where it is."""
    way = np.round(np.concatenate([start, end]), 12)
    _, _, name = distinct_rows(way)
    a, b = name[: len(start)], name[len(start) :]
    key, back = a * (len(way) + 1) + b, b * (len(way) + 1) + a
    return ~np.isin(back, key) | (a < b)


def _led(lines, node, start, end, end_normal, kind, surface, curvature, fold) -> Lines:
    """Straight ways brought onto the surface, a point about every half edge, and the last one where the line is met."""
    mesh = surface.mesh
    h = mesh.edge_length
    distance = np.linalg.norm(end - start, axis=1)
    inner = np.maximum(np.ceil(2 * distance / h).astype(np.int64) - 1, 0)
    way = np.repeat(np.arange(len(node)), inner + 1)
    step = np.arange(len(way)) - np.repeat(np.cumsum(inner + 1) - inner - 1, inner + 1) + 1
    t = (step / (inner[way] + 1))[:, None]
    face, weight, off = surface.closest((1 - t) * start[way] + t * end[way])
    corner = mesh.faces[face]

    def mix(values):
        return np.einsum("ij,ij...->i...", weight, values[corner])

    bend = fold_angle(mix(Extremality.of(curvature, kind).value), mix(curvature.width), h)
    good = np.ones(len(node), bool)
    last = step == inner[way] + 1
    good[way[(off > _OFF * h) | (bend < fold) & ~last]] = False
    points, normals = mix(mesh.vertices), mix(curvature.normals)
    points[last], normals[last] = end, end_normal
    first = len(lines.points)
    new = first + np.arange(len(way))
    before = np.where(step == 1, node[way], new - 1)
    segments = np.stack([before, new], axis=1)[good[way]]
    return lines.extended(points, normals, mix(curvature.strength), bend, segments)
