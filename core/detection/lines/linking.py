# SPDX-License-Identifier: GPL-3.0-or-later
"""Joining pieces that continue each other across a gap, along the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..chains import Chains
from ..curvature.tensor import Curvature
from .extremality import fold_angle
from .lines import Lines, travelled
from .surface import Surface

REACH = 3.0
"""Length in edges over which the direction of a piece at its end is taken: a single segment of a
line traced across faces points anywhere."""

_CLEARANCE = 0.75
"""A bridge that comes nearer than this many edges to a third piece crosses it."""

_NEAR = 1.0
"""Ends nearer than this many edges continue each other whatever the direction from one to the other."""


@dataclass(frozen=True)
class Ends:
    """The two ends of each open piece: node (e,), chain (e,), place (e,) in the chains' nodes, point, outward direction
    and normal (e, 3), length (e,) of the piece. Ends 2k and 2k + 1 belong to one piece."""

    node: np.ndarray
    chain: np.ndarray
    place: np.ndarray
    point: np.ndarray
    outward: np.ndarray
    normal: np.ndarray
    length: np.ndarray


def piece_ends(lines: Lines, pieces: Chains, reach: float) -> Ends:
    """Ends of the open pieces, with directions taken over the arc length `reach`."""
    open_ = np.flatnonzero(~pieces.closed)
    first, last = pieces.offsets[open_], pieces.offsets[open_ + 1] - 1
    points = lines.points[pieces.nodes]
    arc = travelled(pieces, lines.points)
    length = arc[last] - arc[first]
    # arc positions rise along the array, so one search finds the node `reach` away within the piece
    ahead = np.clip(np.searchsorted(arc, arc[first] + reach), first, last)
    back = np.clip(np.searchsorted(arc, arc[last] - reach, side="right") - 1, first, last)
    at = np.stack([first, last], axis=1).ravel()
    inner = np.stack([ahead, back], axis=1).ravel()
    outward = points[at] - points[inner]
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-300)
    node = pieces.nodes[at]
    return Ends(node, np.repeat(open_, 2), at, points[at], outward, lines.normals[node], np.repeat(length, 2))


def candidate_links(ends: Ends, gap: float, turn: float, edge_length: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of ends (c, 2) that may continue each other, and their cost, lower is better.

    The turn from each piece into the gap is at most `turn` (radians), the gap at most `gap` and, so that
    specks do not draw lines of their own, at most the shorter piece or two edges.
    """
    pairs = cKDTree(ends.point).query_pairs(gap, output_type="ndarray") if len(ends.point) else np.zeros((0, 2), int)
    pairs = np.sort(pairs, axis=1).astype(np.int64)
    a, b = pairs.T
    between = ends.point[b] - ends.point[a]
    distance = np.linalg.norm(between, axis=1)
    near = distance <= _NEAR * edge_length
    direction = between / np.maximum(distance, 1e-300)[:, None]
    out_a = np.einsum("ij,ij->i", direction, ends.outward[a])
    out_b = -np.einsum("ij,ij->i", direction, ends.outward[b])
    through = -np.einsum("ij,ij->i", ends.outward[a], ends.outward[b])
    facing = np.einsum("ij,ij->i", ends.normal[a], ends.normal[b])
    least = np.cos(turn)
    straight = np.where(near, through >= least, (out_a >= least) & (out_b >= least) & (through >= np.cos(2 * turn)))
    shorter = np.minimum(ends.length[a], ends.length[b])
    fits = distance <= np.maximum(shorter, 2 * edge_length)
    own = ends.chain[a] == ends.chain[b]
    fits &= ~own | (ends.length[a] >= 3 * gap)
    keep = straight & fits & (facing > 0.5)
    bend = np.where(near, 2 * (1 - through), 2 - out_a - out_b)
    cost = (distance + 0.25 * edge_length) * (1 + 2 * bend)
    return pairs[keep], cost[keep]


def best_pairs(pairs: np.ndarray, cost: np.ndarray, count: int) -> np.ndarray:
    """A matching (k, 2) of ends: pairs that are each other's cheapest, again among the rest until none is left."""
    order = np.lexsort((pairs[:, 1], pairs[:, 0], cost))
    pairs = pairs[order]
    taken = [np.zeros((0, 2), np.int64)]
    while len(pairs):
        rank = np.arange(len(pairs))
        best = np.full(count, len(pairs))
        np.minimum.at(best, pairs.ravel(), np.repeat(rank, 2))
        mutual = (best[pairs[:, 0]] == rank) & (best[pairs[:, 1]] == rank)
        taken.append(pairs[mutual])
        used = np.zeros(count, bool)
        used[taken[-1]] = True
        pairs = pairs[~used[pairs].any(axis=1)]
    return np.concatenate(taken)


def linked(
    lines: Lines, surface: Surface, curvature: Curvature, *, gap: float, turn: float, value=None, least=0.0,
    tick=lambda: None,
) -> Lines:  # fmt: skip
    """Lines with the gaps between pieces that continue each other bridged by points on the surface.

    Parameters
    ----------
    gap : scene units
    turn : radians
    value : (n,) float64, the curvature of the lines' kind, None asks for nothing
    least : radians, the fold that it must stand for on average along a bridge
    """
    h = surface.mesh.edge_length
    pieces = lines.chains()
    tick()
    ends = piece_ends(lines, pieces, REACH * h)
    pairs, cost = candidate_links(ends, gap, turn, h)
    pairs = best_pairs(pairs, cost, len(ends.node))
    tick()
    if not len(pairs):
        return lines
    return _bridged(lines, pieces, surface, curvature, ends, pairs, value, least, tick)


def _bridged(lines, pieces, surface, curvature, ends, pairs, value, least, tick) -> Lines:
    """Points about every edge length along a cubic between the two ends, brought onto the surface."""
    h = surface.mesh.edge_length
    a, b = pairs.T
    distance = np.linalg.norm(ends.point[b] - ends.point[a], axis=1)
    inner = np.maximum(np.round(distance / h).astype(np.int64) - 1, 0)
    link = np.repeat(np.arange(len(pairs)), inner)
    step = np.arange(len(link)) - np.repeat(np.cumsum(inner) - inner, inner) + 1
    t = (step / (inner[link] + 1))[:, None]
    p, q = ends.point[a][link], ends.point[b][link]
    m, n = (ends.outward[a] * distance[:, None])[link], (-ends.outward[b] * distance[:, None])[link]
    wanted = (2 * t**3 - 3 * t**2 + 1) * p + (t**3 - 2 * t**2 + t) * m + (3 * t**2 - 2 * t**3) * q + (t**3 - t**2) * n
    mesh = surface.mesh
    if len(wanted):
        face, weight, off = surface.closest(wanted, tick=tick)
    else:
        face, weight, off = np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0)
    # a bridge through the air is none, and one across another line takes the wrong turn at a junction
    good = np.ones(len(pairs), bool)
    good[link[off > 1.5 * h]] = False
    good[link[_crosses(lines, pieces, wanted, ends.chain[pairs][link], _CLEARANCE * h)]] = False
    corner = mesh.faces[face]

    def mix(values):
        return np.einsum("ij,ij...->i...", weight, values[corner])

    strength, width = mix(curvature.strength), mix(curvature.width)
    fold = fold_angle(strength, width, h)
    if value is not None:
        # two things that face each other across a flat wall are no one line
        bent = np.bincount(link, fold_angle(mix(value), width, h), len(pairs)) / np.maximum(inner, 1)
        good[(inner > 1) & (bent < least)] = False
    first = len(lines.points)
    before = np.where(step == 1, ends.node[a][link], first + np.arange(len(link)) - 1)
    ending = step == inner[link]
    segments = np.concatenate(
        [
            np.stack([before, first + np.arange(len(link))], axis=1)[good[link]],
            np.stack([first + np.arange(len(link)), ends.node[b][link]], axis=1)[ending & good[link]],
            np.stack([ends.node[a], ends.node[b]], axis=1)[(inner == 0) & good],
        ]
    )
    return lines.extended(mix(mesh.vertices), mix(curvature.normals), strength, fold, segments)


def _crosses(lines, pieces, points, own, clearance) -> np.ndarray:
    """(k,) bool, points within `clearance` of a piece that is neither of the two `own` (k, 2)."""
    if not len(points):
        return np.zeros(0, bool)
    tree = cKDTree(lines.points[pieces.nodes])
    # the nearest nodes can all be of the own pieces only near their ends, where nothing is crossed yet
    distance, at = tree.query(points, min(4, len(pieces.nodes)))
    distance, at = distance.reshape(len(points), -1), at.reshape(len(points), -1)
    other = (pieces.label[at][:, :, None] != own[:, None, :]).all(axis=2)
    return (other & (distance <= clearance)).any(axis=1)
