# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of one curve joined where they continue each other: a small gap that both ends point across."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..geometry.polylines import bend, bends, outward
from ..geometry.rows import distinct_rows


def join_paths(paths, *, gap=6.0, angle=35.0, most=np.inf, passed=None, parted=None, forced=()):
    """Join open paths end to end.

    Parameters
    ----------
    paths : list of (k, 3) float64, edge lengths
    gap : longest gap; angle : largest angle, in degrees, between an end's direction and the gap or the other end
    most : largest `bend` of two arms
    passed : (2 p, 2 p) int64 or None, how many curves are known to lead from one end to the other
        (`passages.Passages.pairs`, which may be of fewer paths, the first ones)
    parted : (2 p, 2 p) bool or None, ends that are known not to continue each other (`Passages.parted`)
    forced : (k, 2) int64, ends that are joined before all others

    Returns
    -------
    list of (points, closed), in the order of their first piece. Best fitting ends are joined first; an end is
    joined once. A path whose own ends fit becomes closed.
    """
    return [(points, closed) for points, closed, _ in linked_paths(
        paths, gap=gap, angle=angle, most=most, passed=passed, parted=parted, forced=forced
    )]  # fmt: skip


def linked_paths(paths, *, gap=6.0, angle=35.0, most=np.inf, passed=None, parted=None, forced=()):
    """As `join_paths`, with the indices of the paths that each chain is made of: (points, closed, list of int)."""
    if not paths:
        return []
    tip = np.concatenate([[p[0], p[-1]] for p in paths])
    arms = [part for p in paths for part in (p[:ARM], p[::-1][:ARM])]
    way = outward(arms)
    partner = match_ends(tip, way, arms, [len(p) for p in paths], gap, angle, most, passed, parted, forced)
    out, used = [], np.zeros(len(paths), bool)
    for i in range(len(paths)):
        if used[i]:
            continue
        chain, closed = _chain(i, partner)
        used[[end // 2 for end in chain]] = True
        line = np.concatenate([paths[e // 2] if e % 2 == 0 else paths[e // 2][::-1] for e in chain])
        out.append((line, closed, [e // 2 for e in chain]))
    return out


def match_ends(tip, way, arms, size, gap, angle, most=np.inf, passed=None, parted=None, forced=()):
    """(e,) int64, the end that each end is joined to, or -1; a matching that takes the smoothest pairs first.

    Ends that curves are known to lead between come before all others, and may meet at any angle.

    tip, way : (e, 3) float64, ends and the directions out of them; arms : e arrays (k, 3), samples from each end
    inwards; size : samples of each path, whose ends are 2 i and 2 i + 1
    """
    pair = cKDTree(tip).query_pairs(gap, output_type="ndarray").reshape(-1, 2)
    if passed is not None:
        known = np.argwhere(np.triu(passed >= PASSED))
        known = known[np.linalg.norm(tip[known[:, 0]] - tip[known[:, 1]], axis=1) < FAR]
        pair = distinct_rows(np.concatenate([pair, known]))[0]
    i, j = pair.T
    # A path closes on itself only if it is much longer than the gap.
    length = np.linalg.norm(tip[j] - tip[i], axis=1)
    fits = (i // 2 != j // 2) | (np.asarray(size)[i // 2] > 4 * np.maximum(length, 2))
    i, j = i[fits], j[fits]
    cost = continuation_cost(tip[i], way[i], [arms[k] for k in i], tip[j], way[j], [arms[k] for k in j], angle, most)
    known = np.zeros(len(i), np.int64)
    if passed is not None:
        counted = (i < len(passed)) & (j < len(passed))
        known[counted] = passed[i[counted], j[counted]]
        known[known < PASSED] = 0
    if parted is not None:
        counted = np.flatnonzero((i < len(parted)) & (j < len(parted)))
        cost[counted[parted[i[counted], j[counted]]]] = np.inf
    partner = np.full(len(tip), -1)
    for a, b in forced:
        partner[a], partner[b] = b, a
    for k in np.lexsort((j, i, cost, -known)):
        if (known[k] or np.isfinite(cost[k])) and partner[i[k]] < 0 and partner[j[k]] < 0:
            partner[i[k]], partner[j[k]] = j[k], i[k]
    return partner


def continuation_cost(tip_a, way_a, arms_a, tip_b, way_b, arms_b, angle, most=np.inf):
    """(k,) float64, how badly ends continue each other; infinite where they do not.

    Ends continue each other when both point across the gap and against each other, within `angle` degrees, and their
    arms `bend` by at most `most`.
    """
    across = tip_b - tip_a
    length = np.linalg.norm(across, axis=1)
    line = across / np.maximum(length, 1e-12)[:, None]
    facing = -(way_a * way_b).sum(1)
    out_a, out_b = (line * way_a).sum(1), -(line * way_b).sum(1)
    limit = np.cos(np.radians(angle))
    fits = (facing > limit) & ((length < 1.5) | ((out_a > limit) & (out_b > limit)))
    cost = np.full(len(length), np.inf)
    fits = np.flatnonzero(fits)
    bent = bends([(arms_a[k], arms_b[k]) for k in fits])
    cost[fits] = np.where(bent <= most, length[fits] / 4 + 4 * bent, np.inf)
    return cost


def continuations(paths, *, gap=6.0, angle=35.0):
    """(k, 2) int64, pairs of ends of different paths that continue each other; as in `join_paths`."""
    tip = np.array([end for p in paths for end in (p[0], p[-1])]).reshape(-1, 3)
    arms = [arm for p in paths for arm in (p[:ARM], p[::-1][:ARM])]
    way = outward(arms)
    pair = cKDTree(tip).query_pairs(gap, output_type="ndarray").reshape(-1, 2)
    pair = pair[pair[:, 0] // 2 != pair[:, 1] // 2]
    i, j = pair.T
    cost = continuation_cost(tip[i], way[i], [arms[k] for k in i], tip[j], way[j], [arms[k] for k in j], angle)
    return pair[np.isfinite(cost)]


def bend_of_ends(paths, a, b):
    """How badly end a continues end b, `bend` of their arms; the ends of path i are 2 i and 2 i + 1."""
    return bend(*(paths[e // 2][:: 1 - 2 * (e % 2)][:ARM] for e in (a, b)))


PASSED, FAR = 2, 20.0
"""Fewest curves that must lead from one end to another for both to be known as one curve, and the longest gap (edge
lengths) that is closed then."""

ARM = 9
"""Samples of an end that say how it goes on."""


def split_at_corners(path, *, arm=3, angle=60.0, least=4):
    """A line of samples one edge length apart, cut where it turns by more than `angle` degrees within 2 `arm`."""
    if len(path) < 2 * arm + 1:
        return [path]
    before, after = path[arm:-arm] - path[: -2 * arm], path[2 * arm :] - path[arm:-arm]
    size = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    cosine = (before * after).sum(1) / np.maximum(size, 1e-12)
    bounds = [0]
    for k in np.argsort(cosine, kind="stable"):
        if cosine[k] > np.cos(np.radians(angle)):
            break
        at = int(k) + arm
        if all(abs(at - b) >= least for b in [*bounds, len(path) - 1]):
            bounds.append(at)
    bounds = [*sorted(bounds), len(path) - 1]
    return [path[a : b + 1] for a, b in zip(bounds[:-1], bounds[1:])]


def _chain(start, partner):
    """Ends through which a chain of paths is entered, from its beginning, and whether it is closed."""
    end = 2 * start
    seen = {end // 2}
    while partner[end] >= 0:
        end = partner[end] ^ 1
        if end // 2 in seen:
            return _forward(2 * start, partner), True
        seen.add(end // 2)
    return _forward(end, partner), False


def _forward(entry, partner):
    chain, at = [entry], entry
    while True:
        nxt = partner[at ^ 1]
        if nxt < 0 or nxt == entry:
            return chain
        chain.append(nxt)
        at = nxt
