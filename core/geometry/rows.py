# SPDX-License-Identifier: GPL-3.0-or-later
"""Distinct rows. numpy's own np.unique(axis=0) sorts them without releasing the GIL, which a window feels."""

from __future__ import annotations

import numpy as np


def distinct_rows(rows):
    """Distinct rows of an array in lexicographic order.

    rows : (n, k) numbers, none of them NaN; k may be 0

    Returns the distinct rows (m, k), the first place of each (m,) int64, and the distinct row of each row (n,) int64.
    """
    order = np.lexsort(rows.T[::-1]) if rows.shape[1] else np.arange(len(rows))
    there = rows[order]
    new = np.ones(len(rows), bool)
    new[1:] = (there[1:] != there[:-1]).any(axis=1)
    distinct = there[new]
    del there  # rows may be most of the memory that there is
    run = np.cumsum(new)
    run -= 1
    index = np.empty(len(rows), np.int64)
    index[order] = run
    return distinct, order[new], index
