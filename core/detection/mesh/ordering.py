# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorting by whole numbers from a known range, in linear time."""

from __future__ import annotations

import numpy as np
from scipy import sparse


def order_by(*keys: np.ndarray, count: int, tick=lambda: None) -> np.ndarray:
    """(k,) int64: the stable order by the first key, then the second and so on.

    Parameters
    ----------
    keys : (k,) int each, from 0 to `count`, exclusive
    tick : called after each pass

    Notes
    -----
    O(k + count) for each key: bringing a matrix with one entry a row into column order is a counting sort.
    """
    order = np.arange(len(keys[0]))
    for key in reversed(keys):
        k = len(key)
        matrix = sparse.csr_matrix((order, key[order], np.arange(k + 1)), (k, count))
        order = matrix.tocsc().data
        tick()
    return order


def group_starts(*keys: np.ndarray) -> np.ndarray:
    """(k,) bool: where a new group of equal entries begins in sorted keys."""
    new = np.ones(len(keys[0]), bool)
    new[1:] = False
    for key in keys:
        new[1:] |= key[1:] != key[:-1]
    return new
