# SPDX-License-Identifier: GPL-3.0-or-later
"""Which ends continue each other: log odds of a smooth continuation against chance, and the pairs that are taken."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree
from scipy.special import expit

from ..network.network import CurveNetwork
from .ends import ARM, Ends

NEAREST = 16
"""Other ends that each end is asked with; bounds the work."""
GOES_ON, LOOSE, FIRM, ROUNDS = 0.3, 6.0, 10.0, 8
"""What is believed of ends before any is seen: the share whose curve goes on within the largest gap, by how much
continuations vary more than the noise of their arms says, what these beliefs weigh (ends); and rounds of the fit."""
CUT, TAIL = 3.0, 3.0
"""Mean length of half of the gaps (edge lengths; the other half has any length), and the degrees of freedom of
Student's distribution of a continuation about what is foretold."""
BESIDE, COVERED = 2.0, 1.0
"""Distance (edge lengths) of a curve that runs along a gap, and the log odds that each edge of it takes."""


def continuation(network: CurveNetwork, pieces, ends: Ends, belief, *, noise, turning, gap):
    """Pairs of ends (k, 2) int64 and the log odds (k,) that a curve goes on from one to the other.

    network : all curves; what runs along a gap contradicts it. belief : (p,) float64, that each piece is no clutter;
    noise, turning, gap : as in `ends_of`

    Notes
    -----
    How many ends go on, and how loosely, is fitted to the pairs that are found (EM).
    """
    pair = candidates(pieces, ends, gap)
    if not len(pair):
        return pair, np.zeros(0)
    i, j = pair.T
    sway, turn, v_sway, v_turn, line, size = _foretold(ends, i, j, noise, turning)
    chance = _directions(ends, i, j, line)
    g = np.maximum(size, 1.0)
    length = (np.exp(-g / CUT) / CUT + 1 / gap) / 2
    many = np.sqrt(ends.density[i] * ends.density[j]) * 2 * g / gap**2
    fixed = np.log(length / many) - chance + np.log(4)
    loose, goes_on, both = LOOSE, GOES_ON, belief[i // 2] * belief[j // 2]
    for _ in range(ROUNDS):
        odds = fixed + np.log(goes_on) + _log_student(sway, loose * v_sway) + _log_student(turn, loose * v_turn)
        partner, _ = matched(pair, odds, np.zeros(len(ends.tip)), len(ends.tip))
        taken = partner[i] == j
        w = np.where(taken, expit(odds) * both, 0.0)
        goes_on = (2 * w.sum() + FIRM * GOES_ON) / (2 * belief.sum() + FIRM)
        pull = _pull(sway, v_sway, loose) + _pull(turn, v_turn, loose)
        loose = (w @ pull + FIRM * LOOSE) / (2 * w.sum() + FIRM)
    odds -= COVERED * covered(network, pieces, ends, i, j, size, floor=odds)
    return pair, odds


def _foretold(ends: Ends, i, j, noise, turning):
    """How far pairs of ends are from what their arms foretell, and with what variance.

    Returns (k, 3) sway and turn (radians), (k,) variance of each coordinate of both, (k, 3) unit lines across the gap
    and (k,) its size.

    Notes
    -----
    With d from foot to foot, a and b how far the ways in and out turn off d, and a curvature that changes evenly:
    a + b = (bend_b - bend_a) |d| / 6 and b - a = (bend_a + bend_b) |d| / 2.
    """
    across = ends.foot[j] - ends.foot[i]
    size = np.linalg.norm(across, axis=1)
    g = np.maximum(size, 1.0)
    # Where two ends touch, noise decides on the direction between them: there it is the mean of their ways.
    mean = (ends.way[i] - ends.way[j]) / 2
    across = across + mean * np.clip(8 * noise**2 / np.maximum(size, 0.1), 0, 4)[:, None]
    line = across / np.maximum(np.linalg.norm(across, axis=1), 1e-9)[:, None]
    out, into = _off(ends.way[i], line), _off(-ends.way[j], line)
    bend_i, bend_j = ends.bend[i], ends.bend[j]
    sway = out + into - (bend_j - bend_i) * g[:, None] / 6
    turn = into - out - (bend_i + bend_j) * g[:, None] / 2
    v_way, v_bend = ends.v_way[i] + ends.v_way[j], ends.v_bend[i] + ends.v_bend[j]
    v_sway = v_way + 4 * (ends.v_foot[i] + ends.v_foot[j]) / g**2 + v_bend * g**2 / 36
    v_turn = v_way + v_bend * g**2 / 4 + (turning / ARM) ** 2 * g**4 / 12
    return sway, turn, v_sway, v_turn, line, size


def candidates(pieces, ends: Ends, gap):
    """(k, 2) int64, i < j, pairs of near ends; a piece's own only where it is much longer than its gap."""
    q = len(ends.tip)
    if q < 2:
        return np.zeros((0, 2), np.int64)
    distance, near = cKDTree(ends.tip).query(ends.tip, k=min(NEAREST + 1, q), distance_upper_bound=gap)
    i, slot = np.nonzero(np.isfinite(distance) & (near != np.arange(q)[:, None]))
    j = near[i, slot]
    length = np.array([p.length for p in pieces])
    good = (i // 2 != j // 2) | (length[i // 2] > np.pi * np.maximum(distance[i, slot], 2))
    pair = np.stack([np.minimum(i, j), np.maximum(i, j)], axis=1)[good]
    return np.unique(pair, axis=0)


def _off(way, line):
    """How far unit vectors turn off lines: the part across, as long as the angle."""
    along = (way * line).sum(1)
    across = way - along[:, None] * line
    size = np.linalg.norm(across, axis=1)
    return across * (np.arctan2(size, along) / np.maximum(size, 1e-12))[:, None]


def _log_student(vector, variance):
    """Log density of vectors across a line after Student's distribution in two dimensions; as wide as the sphere allows
    at most."""
    variance = np.minimum(variance, 1.0)
    square = (vector**2).sum(1) / variance
    return -np.log(2 * np.pi * variance) - (TAIL + 2) / 2 * np.log1p(square / TAIL)


def _pull(vector, variance, loose):
    """What each vector says of `loose`: half its square over its variance, far ones counting less (EM of Student)."""
    square = (vector**2).sum(1) / (2 * variance)
    return square * (TAIL + 2) / (TAIL + 2 * square / loose)


def _directions(ends: Ends, i, j, line):
    """Log density of the direction of the gap and of the other end's way, for ends that meet by chance.

    Ends lie in no order, but nearly in a plane where curves do: the density falls off from the plane with the
    thickness that the ends around show.
    """
    total = np.zeros(len(i))
    for at, other in ((i, j), (j, i)):
        for direction in (line, ends.way[other]):
            sine = (ends.normal[at] * direction).sum(1)
            m = ends.thickness[at]
            total += 0.5 * (-0.5 * (sine / m) ** 2 - np.log(m * np.sqrt(2 * np.pi)) - np.log(2 * np.pi))
    return total


def covered(network: CurveNetwork, pieces, ends: Ends, i, j, size, *, floor):
    """(k,) float64, length of each gap along which another curve runs; 0 where the odds are below 0 anyway."""
    result = np.zeros(len(i))
    ask = np.flatnonzero((size > 3) & (floor > 0))
    if not len(ask):
        return result
    many = np.maximum(np.rint(size[ask]).astype(np.int64) - 1, 1)
    row = np.repeat(np.arange(len(ask)), many)
    t = (np.arange(len(row)) - np.repeat(np.cumsum(many) - many, many) + 1.0) / (many[row] + 1)
    a, b = i[ask][row], j[ask][row]
    at, way = bridge(ends, a, b, t)
    distance, near = cKDTree(network.points).query(at, k=4, distance_upper_bound=BESIDE)
    found = np.isfinite(distance)
    near = np.where(found, near, 0)
    along = np.abs((network.tangents[near] * way[:, None]).sum(-1)) > 0.8
    # The arms themselves come near both ends of the gap.
    curve = np.array([p.curve for p in pieces])
    mine = network.curve_of[near]
    own = (mine == curve[a // 2][:, None]) | (mine == curve[b // 2][:, None])
    hit = (found & along & ~own).any(axis=1)
    result[ask] = np.bincount(row, hit, minlength=len(ask))
    return result


def bridge(ends: Ends, a, b, t):
    """Points (k, 3) and unit tangents (k, 3) at t (k,), 0 to 1, of the cubics from ends a to ends b."""
    p, q = ends.tip[a], ends.tip[b]
    size = np.linalg.norm(q - p, axis=1)[:, None]
    u, v = ends.way[a] * size, -ends.way[b] * size
    t = t[:, None]
    point = (2 * t**3 - 3 * t**2 + 1) * p + (t**3 - 2 * t**2 + t) * u + (3 * t**2 - 2 * t**3) * q + (t**3 - t**2) * v
    way = (6 * t**2 - 6 * t) * (p - q) + (3 * t**2 - 4 * t + 1) * u + (3 * t**2 - 2 * t) * v
    return point, way / np.maximum(np.linalg.norm(way, axis=1), 1e-9)[:, None]


def matched(pair, odds, weakness, count):
    """(q,) int64, the end that each of `count` ends is joined with, or -1, and (q,) float64, with what log odds.

    Best pairs first; each end once. weakness : (q,) float64, at most 0, log odds of the piece of each end where
    these speak against it
    """
    partner, worth = np.full(count, -1), np.zeros(count)
    good = np.flatnonzero(odds > 0)
    a, b = pair[good].T
    value = np.round(odds[good] + weakness[a] + weakness[b], 6)
    for k in good[np.lexsort((b, a, -value))]:
        a, b = pair[k]
        if partner[a] < 0 and partner[b] < 0:
            partner[a], partner[b] = b, a
            worth[a] = worth[b] = odds[k]
    return partner, worth
