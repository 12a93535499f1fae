# SPDX-License-Identifier: GPL-3.0-or-later
"""Long arrays a part at a time: less memory, more of it in the cache, and often a chance to stop."""

from __future__ import annotations

import numpy as np

_LEAST = 1 << 14
_MOST_PARTS = 16
"""Each part costs a pass over all vertices where face values are gathered at them, so there are not more."""


def parts(count: int):
    """Slices that cover `count` entries in order."""
    size = max(_LEAST, -(-count // _MOST_PARTS))
    return [slice(start, start + size) for start in range(0, count, size)]


def sums(count: int, columns: int) -> np.ndarray:
    """(count, columns) float64 zeros to `gather` in: each column lies in one piece."""
    return np.zeros((columns, count)).T


def gather(total: np.ndarray, at: np.ndarray, values: np.ndarray):
    """Add values (k, c) to the rows `at` (k,) of total (n, c), in place.

    Most meshes keep near things near each other, so that the rows of a part span few others.
    """
    low, high = int(at.min()), int(at.max()) + 1
    at = at - low
    for column in range(total.shape[1]):
        total[low:high, column] += np.bincount(at, values[:, column], high - low)
