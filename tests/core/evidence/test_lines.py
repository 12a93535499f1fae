# SPDX-License-Identifier: GPL-3.0-or-later
"""All of a straight line tells as much as a short stretch of it; curves tell all that they show."""

from __future__ import annotations

import numpy as np
import pytest

from core.evidence.lines import STRAIGHT, lines_once
from tests import naive
from tests.core.shapes import circle, line


def told(curves, spacing=1.0):
    """Edge lengths of each curve that tell, by curve."""
    points = np.concatenate(curves)
    tangents = np.concatenate([naive.directions(c) for c in curves])
    share = lines_once(points, tangents, np.ones(len(points), bool), spacing)
    return [spacing * part.sum() for part in np.split(share, np.cumsum([len(c) for c in curves])[:-1])]


def test_a_long_line_tells_a_stretch_of_it():
    assert told([line(120)])[0] == pytest.approx(STRAIGHT, rel=0.05)


def test_pieces_of_one_line_tell_as_much_as_the_line_and_others_their_own():
    first, second, beside = told([line(40), line(40, start=(90, 0, 0)), line(40, start=(0, 12, 0))])
    assert first + second == pytest.approx(STRAIGHT, rel=0.05)
    assert beside == pytest.approx(STRAIGHT, rel=0.05)


def test_a_ring_and_a_short_line_tell_all():
    assert told([circle(15.0, n=94)])[0] > 85
    assert told([line(20)])[0] == 20


def test_where_the_curves_lie_and_how_they_stand_does_not_matter(rng):
    curves = [line(60), circle(12.0, (20, 30, 0))]
    m = naive.rigid(naive.turn(rng.normal(size=3), 1.0), rng.normal(size=3) * 1e3)
    assert np.allclose(told(curves), told([naive.moved(m, c) for c in curves]), atol=1e-6)
