# SPDX-License-Identifier: GPL-3.0-or-later
"""Distinct rows against sets of tuples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.rows import distinct_rows


@given(st.integers(0, 4), st.integers(0, 60), st.integers(0, 2**32 - 1))
def test_distinct_rows_are_those_of_a_set(width, count, seed):
    rows = np.random.default_rng(seed).integers(-2, 3, size=(count, width))
    distinct, first, index = distinct_rows(rows)
    tuples = [tuple(row) for row in rows.tolist()]
    assert [tuple(row) for row in distinct.tolist()] == sorted(set(tuples))
    assert first.tolist() == [tuples.index(row) for row in sorted(set(tuples))]
    assert [tuple(distinct[i]) for i in index] == tuples


@pytest.mark.parametrize("dtype", (np.float64, np.float32))
def test_rows_of_floats_with_a_negative_zero(dtype):
    rows = np.array([[0.0, 1.5], [-0.0, 1.5], [-1e-30, 1.5]], dtype)
    distinct, first, index = distinct_rows(rows)
    assert index.tolist() == [1, 1, 0] and first.tolist() == [2, 0] and distinct.dtype == dtype
