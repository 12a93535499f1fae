# SPDX-License-Identifier: GPL-3.0-or-later
"""Halves that meet become one thing; cells beside each other do not."""

from __future__ import annotations

import numpy as np
import pytest

from core.parameters import Parameters
from core.pipeline import complete
from core.values import Curves
from tests import naive


def rectangle(width, height):
    """A closed rectangle (n, 3) with points about one apart, its last point its first."""
    corners = np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0], [0, 0, 0]], float)
    sides = [np.linspace(a, b, int(np.linalg.norm(b - a)) + 1)[:-1] for a, b in zip(corners, corners[1:])]
    return np.concatenate([*sides, corners[:1]])


@pytest.mark.parametrize("count", [4, 6])
def test_outlines_in_a_row_stay_whole_and_closed(rng, count):
    curves = []
    for k in range(count):
        for curve in (rectangle(60, 90), rectangle(36, 20) + [12, 50, 0]):
            curves.append(curve + [85.0 * k, 0, 0] + 0.1 * rng.normal(size=curve.shape) * [1, 1, 0.3])
    m = naive.about([1, 2, 0.5], 0.7, [5, -3, 8])
    got = complete(Curves.from_list([naive.moved(m, c) for c in curves]), edge_length=1.0, parameters=Parameters())
    assert [len(t.occurrences) for t in got.templates] == [count]
    assert [t.kind for t in got.transformations] == ["translation"]
    (template,) = got.templates
    assert len(template.curves) == 2 and all(c.closed for c in template.curves)
