# SPDX-License-Identifier: GPL-3.0-or-later
"""Log odds of pieces against clutter."""

import numpy as np
import pytest

from core.single.clutter import bounded, concentration, departures, fit_mixture, log_concentrated
from core.single.pieces import Piece
from tests.core import shapes


def piece(points, closed=False):
    return Piece(np.asarray(points, float), closed, 0, len(points) - 1.0)


def jagged(points, rng, noise=0.15):
    return piece(points + rng.normal(scale=noise, size=points.shape))


def clutter(rng, n):
    """A walk that turns at random, smoothed as the network's curves are."""
    return piece(shapes.wiggle(rng, n, bend=0.8))


def drawn_angles(rng, k, n):
    """Cosines of n directions after von Mises and Fisher, by inversion."""
    u = rng.random(n)
    return 1 + np.log(u + (1 - u) * np.exp(-2 * k)) / k


@pytest.mark.parametrize("points, closed", [(shapes.line(40), False), (shapes.circle(9), True)])
def test_lines_and_circles_do_not_depart(points, closed):
    turn, angle = departures(points, closed, 4)
    assert len(angle) == (len(points) if closed else len(points) - 12)
    # A circle's samples are not a whole number of steps; what rounding leaves of an arc cosine is its root.
    assert angle.max() < 1e-3
    if not closed:
        assert np.abs(turn).max() < 1e-9


def test_a_corner_departs_by_its_angle():
    line = np.concatenate([shapes.line(20)[:-1], shapes.line(20, [19, 0, 0], [0, 1, 0])])
    assert departures(line, False, 4)[1].max() == pytest.approx(np.pi / 2)


def test_a_piece_shorter_than_three_steps_says_nothing():
    assert len(departures(shapes.line(12), False, 4)[1]) == 0
    assert len(departures(shapes.line(13), False, 4)[1]) == 1


@pytest.mark.parametrize("k", [1.0, 4.0, 60.0])
def test_the_concentration_of_drawn_angles_is_found(rng, k):
    cosine = drawn_angles(rng, k, 40_000)
    assert concentration(cosine, np.ones(len(cosine)), k, 1e-9) == pytest.approx(k, rel=0.05)
    grid = np.linspace(-1, 1, 200_001)
    total = 2 * np.pi * np.exp(log_concentrated(grid, k)).mean() * 2
    assert total == pytest.approx(1, abs=1e-3), "a density on the sphere"


def test_no_respect_speaks_without_end_against_a_curve():
    assert bounded(np.array([-1e6]))[0] == pytest.approx(np.log(0.02))
    assert bounded(np.array([30.0]))[0] == pytest.approx(30.0, abs=0.03)


def test_curves_and_clutter_are_told_apart(rng):
    curves = [jagged(shapes.line(n, way=rng.normal(size=3)), rng) for n in rng.integers(20, 80, 25)]
    walks = [clutter(rng, n) for n in rng.integers(14, 40, 40)]
    odds = fit_mixture([*curves, *walks], [], step=4).log_odds
    assert (odds[:25] > 0).mean() >= 0.95
    assert (odds[25:] < 0).mean() >= 0.95


def test_a_scene_without_clutter_loses_nothing(rng):
    waves = [shapes.line(60) + np.c_[np.zeros(60), 2 * np.sin(np.arange(60) / w), np.zeros(60)] for w in (2.5, 3, 4)]
    smooth = [piece(shapes.line(n)) for n in range(12, 90, 6)] + [piece(w) for w in waves]
    assert (fit_mixture(smooth, [], step=4).log_odds > 0).all()


def test_clutter_alone_is_seen_as_such_beside_curves_that_recur(rng):
    walks = [clutter(rng, n) for n in rng.integers(14, 40, 30)]
    known = [jagged(shapes.line(60), rng) for _ in range(30)]
    mixture = fit_mixture(walks, known, step=4)
    assert (mixture.log_odds < 0).mean() >= 0.9 and mixture.share < 0.2


def test_sharper_pieces_are_rather_curves(rng):
    pieces = [jagged(shapes.line(20), rng, 0.5) for _ in range(20)] + [clutter(rng, 20) for _ in range(20)]
    strength = np.r_[np.full(20, 5.0), np.full(20, 1.0)] * np.exp(rng.normal(scale=0.2, size=40))
    plain, sharp = (fit_mixture(pieces, [], step=4, strength=s).log_odds for s in (None, strength))
    assert (sharp[:20] - sharp[20:]).mean() > (plain[:20] - plain[20:]).mean()
