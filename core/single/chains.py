# SPDX-License-Identifier: GPL-3.0-or-later
"""Chains of pieces that continue each other, and the stretches of them that are worth more than nothing."""

from __future__ import annotations

import numpy as np


def chains_of(partner):
    """Lists of ends through which chains of pieces are entered, and whether each chain is closed.

    partner : (2 p,) int64, the end that each end is joined with, or -1. Each piece is in one chain.
    """
    seen, result = np.zeros(len(partner) // 2, bool), []
    starts = [e for e in range(len(partner)) if partner[e] < 0]
    for entry in starts + list(range(len(partner))):
        if seen[entry // 2]:
            continue
        chain, at = [], entry
        while not seen[at // 2]:
            seen[at // 2] = True
            chain.append(at)
            if partner[at ^ 1] < 0:
                break
            at = partner[at ^ 1]
        result.append((chain, bool(partner[chain[0]] >= 0)))
    return result


def best_stretches(chain, closed, odds, worth, least):
    """Stretches of a chain with the greatest sum of log odds: list of (ends, closed, log odds).

    odds : (p,) float64, of each piece; worth : (2 p,) float64, of the link at each end; least : what a stretch must
    be worth. A closed chain is kept whole or cut at its worst piece.

    Notes
    -----
    Maximal scoring segments by dynamic programming: each piece is in a stretch, which it begins or goes on with, or
    in none.
    """
    value = odds[[e // 2 for e in chain]]
    link = worth[[e ^ 1 for e in chain]]
    if closed:
        total = float(value.sum() + link.sum())
        if (value > least).all() or len(chain) == 1:
            return [(chain, True, total)] if total > least else []
        worst = int(np.argmin(value))
        if value[worst] + link[worst] + link[worst - 1] > 0:
            return [(chain, True, total)] if total > least else []
        chain = chain[worst:] + chain[:worst]
        value, link = np.roll(value, -worst), np.roll(link, -worst)
    within, without, path = -np.inf, 0.0, []
    for k in range(len(chain)):
        on = within + link[k - 1] if k else -np.inf
        begin = without - least
        after = max(within, without)
        path.append((on >= begin, within > without))
        within, without = max(on, begin) + value[k], after
    return _traced(chain, value, link, path, within > without)


def _traced(chain, value, link, path, inside):
    result, own, total = [], [], 0.0
    for k in range(len(chain) - 1, -1, -1):
        on, came_inside = path[k]
        if not inside:
            inside = came_inside
            continue
        own.append(chain[k])
        total += value[k]
        if on:
            total += link[k - 1]
        else:
            result.append((own[::-1], False, float(total)))
            own, total = [], 0.0
            inside = False
    return result[::-1]
