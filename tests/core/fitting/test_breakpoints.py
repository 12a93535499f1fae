# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from core.fitting.breakpoints import find_pieces
from tests.core.fitting import drawings, oracle

KINDS = ("line", "arc", "bezier")


def curves():
    rng = np.random.default_rng(1)
    yield "window", drawings.noisy(drawings.window(9), 0.01), 0.01
    yield "rectangle", drawings.noisy(drawings.rectangle(step=0.4), 0.02), 0.02
    yield "space", drawings.noisy(drawings.space_curve(30), 0.02), 0.02
    yield "walk", np.cumsum(rng.normal(size=(26, 3)), axis=0), 0.5
    yield "line", drawings.noisy(np.linspace([0, 0, 0], [3, 1, 2], 30), 0.01), 0.01
    yield "two", np.array([[0.0, 0, 0], [1, 0, 0]]), 0.1


@pytest.mark.parametrize("name, points, sigma", list(curves()), ids=lambda x: x if isinstance(x, str) else "")
@pytest.mark.parametrize("where, dimension", [("plane", 2), ("space", 3)])
def test_short_curves_get_the_cheapest_description_of_all(name, points, sigma, where, dimension):
    found = find_pieces(points, variance=sigma**2, dimension=dimension)
    cost, kinds, knots = oracle.cheapest(points, sigma**2, where)
    assert found.cost == pytest.approx(cost, rel=1e-6)
    assert [KINDS[k] for k in found.kinds] == kinds and found.knots.tolist() == knots


def test_longer_curves_get_one_nearly_as_cheap():
    points = drawings.noisy(drawings.window(16), 0.01)
    found = find_pieces(points, variance=1e-4, dimension=2)
    cost, kinds, _ = oracle.cheapest(points, 1e-4, "plane")
    assert cost - 1e-6 <= found.cost <= cost + 4 * np.log(len(points))
    assert [KINDS[k] for k in found.kinds] == kinds
