# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.errors import InputError
from core.fitting import Circle, dense, fit_curve, fit_curves
from tests.core.fitting import drawings

SIGMAS = [0.01, 0.0]


def kinds(fitted):
    return [p.kind for p in fitted.primitives]


def furthest(points, fitted, step=0.002):
    """Largest distance of points from a fitted curve, by dense sampling alone."""
    return cKDTree(dense(fitted.primitives, step, fitted.closed)).query(points)[0].max()


def assert_joined(fitted):
    after = fitted.primitives[1:] + (fitted.primitives[:1] if fitted.closed else ())
    for p, q in zip(fitted.primitives, after):
        assert (p.end == q.start).all()


def corners(fitted):
    return np.array(sorted(p.start.round(6).tolist() for p in fitted.primitives))


@pytest.mark.parametrize("sigma", SIGMAS)
@pytest.mark.parametrize("first", [0, 13])
def test_a_rectangle_is_four_lines_that_share_their_corners(sigma, first):
    points = drawings.noisy(np.roll(drawings.rectangle(), first, axis=0), sigma, first)
    fitted = fit_curve(points, True)
    assert kinds(fitted) == ["line"] * 4
    assert_joined(fitted)
    expected = np.array([[0, 0, 0], [0, 2, 0], [3, 0, 0], [3, 2, 0.0]])
    assert cKDTree(corners(fitted)).query(expected)[0].max() <= 1.5 * sigma + 1e-5


@pytest.mark.parametrize("sigma", SIGMAS)
def test_a_roundel_is_one_circle(sigma):
    fitted = fit_curve(drawings.noisy(drawings.circle(1.5), sigma), True)
    (circle,) = fitted.primitives
    assert isinstance(circle, Circle)
    assert circle.radius == pytest.approx(1.5, abs=sigma + 1e-5)
    assert circle.centre == pytest.approx(np.zeros(3), abs=sigma + 1e-5)


def test_a_circle_whose_ends_only_meet_is_one_too():
    assert kinds(fit_curve(drawings.arc(1.0, 0, 2 * np.pi, 101))) == ["circle"]


@pytest.mark.parametrize("sigma", SIGMAS)
def test_a_pointed_arch_is_two_arcs(sigma):
    fitted = fit_curve(drawings.noisy(drawings.pointed_arch(), sigma))
    assert kinds(fitted) == ["arc", "arc"]
    assert_joined(fitted)
    assert fitted.primitives[0].end == pytest.approx([0, np.sqrt(3), 0], abs=3 * sigma + 1e-5)
    assert [p.radius for p in fitted.primitives] == pytest.approx([2, 2], abs=6 * sigma + 1e-4)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_sides_that_go_on_into_an_arch_are_tangent_to_it(sigma):
    fitted = fit_curve(drawings.noisy(drawings.window(), sigma))
    assert kinds(fitted) == ["line", "arc", "arc", "line"]
    assert_joined(fitted)
    for i in (0, 2):
        end, start = fitted.primitives[i].tangents()[1], fitted.primitives[i + 1].tangents()[0]
        assert np.arccos(min(1.0, end @ start)) < 1e-4


@pytest.mark.parametrize("sigma", SIGMAS)
def test_a_cubic_in_space_is_one_bezier(sigma):
    assert kinds(fit_curve(drawings.noisy(drawings.space_curve(), sigma))) == ["bezier"]


@pytest.mark.parametrize(
    "points, closed",
    [
        (drawings.noisy(drawings.window(), 0.01), False),
        (drawings.noisy(drawings.rectangle(), 0.01), True),
        (drawings.noisy(drawings.space_curve(), 0.01), False),
        (np.cumsum(np.random.default_rng(2).normal(size=(24, 3)), axis=0), False),
        (np.cumsum(np.random.default_rng(4).normal(size=(24, 3)), axis=0), True),
    ],
)
@pytest.mark.parametrize("sigma", [0.02, None])
def test_the_deviation_is_what_it_says_and_never_above_the_noise(points, closed, sigma):
    fitted = fit_curve(points, closed, sigma=sigma)
    assert fitted.deviation <= fitted.noise
    assert furthest(points, fitted) <= fitted.deviation + 0.002
    assert sigma is None or fitted.noise <= max(5 * sigma, 5e-5 * np.ptp(points, axis=0).max()) * (1 + 1e-9)


@pytest.mark.parametrize("name", ["window", "space_curve"])
def test_a_rigid_motion_moves_the_curve(name):
    points, m = drawings.noisy(getattr(drawings, name)(), 0.01), drawings.motion()
    here, there = fit_curve(points), fit_curve(drawings.moved(points, m))
    assert kinds(here) == kinds(there)
    expected = [p.moved(m) for p in here.primitives]
    for p, q in zip(expected, there.primitives):
        assert p.beziers() == pytest.approx(q.beziers(), abs=1e-3)


@pytest.mark.parametrize("name", ["window", "pointed_arch"])
def test_the_other_way_round_it_is_the_same_curve(name):
    points = drawings.noisy(getattr(drawings, name)(), 0.005)
    here, back = fit_curve(points), fit_curve(points[::-1])
    assert kinds(here) == kinds(back)[::-1]
    for p, q in zip(here.primitives, reversed(back.primitives)):
        assert p.beziers() == pytest.approx(q.reversed().beziers(), abs=0.02)


def test_scale_changes_nothing():
    points = drawings.noisy(drawings.window(), 0.01)
    assert kinds(fit_curve(points)) == kinds(fit_curve(points * 1e4)) == kinds(fit_curve(points * 1e-4))


def test_corners_that_smoothing_rounded_are_corners_again():
    from scipy.ndimage import gaussian_filter1d

    rounded = gaussian_filter1d(drawings.rectangle(step=0.05), 3, axis=0, mode="wrap")
    fitted = fit_curve(drawings.noisy(rounded, 0.005), True, sigma=0.005, blur=0.15)
    assert kinds(fitted) == ["line"] * 4
    assert cKDTree(corners(fitted)).query([[0, 0, 0], [3, 2, 0.0]])[0].max() < 0.01
    assert fitted.deviation <= fitted.noise <= 0.15


def test_curves_that_meet_within_the_noise_share_their_point():
    arms = [np.linspace([0, 0, 0], end, 60) + off for end, off in
            [([2, 0, 0], [0, 0.01, 0]), ([0, 2, 0], [0.01, 0, 0]), ([0, 0, 2.0], [0, 0.012, 0])]]  # fmt: skip
    apart = np.linspace([0.5, 0.5, 0], [2, 2, 0.0], 60)
    fitted = fit_curves([*(drawings.noisy(a, 0.01, i) for i, a in enumerate(arms)), apart], [False] * 4, sigma=0.01)
    starts = [f.primitives[0].start for f in fitted]
    assert (starts[0] == starts[1]).all() and (starts[0] == starts[2]).all()
    assert not np.allclose(starts[3], starts[0])
    assert all(f.deviation <= f.noise for f in fitted)


@pytest.mark.parametrize(
    "points, closed, expected",
    [
        (np.zeros((0, 3)), False, []),
        (np.zeros((1, 3)), False, []),
        (np.zeros((5, 3)), True, []),
        ([[0, 0, 0], [1, 0, 0]], False, ["line"]),
        ([[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0]], False, ["line"]),
        ([[0, 0, 0], [1, 0, 0], [1, 3, 0]], False, ["line", "line"]),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], True, ["line"] * 4),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]], True, ["line"] * 4),
        (np.linspace([0, 0, 0], [1, 2, 3], 500), False, ["line"]),
    ],
)
def test_small_and_repeated_points(points, closed, expected):
    fitted = fit_curve(np.array(points, float), closed)
    assert kinds(fitted) == expected
    assert_joined(fitted)


def test_bad_points_are_refused():
    with pytest.raises(InputError, match="point 1 is not finite"):
        fit_curve([[0, 0, 0], [np.nan, 0, 0]])
    with pytest.raises(InputError, match="three coordinates"):
        fit_curve([[0, 0], [1, 1]])
    with pytest.raises(InputError, match="noise of -1"):
        fit_curve(drawings.circle(), True, sigma=-1)


def test_the_points_given_stay_as_they_were():
    points = drawings.window()
    before = points.copy()
    fit_curve(points)
    assert (points == before).all()


def lines_and_a(target, sigma, seed, *ends, overlap=0.0):
    """A noisy curve and noisy straight lines from it to `ends`; they stop short of it, or run over it, by `overlap`."""
    rng = np.random.default_rng(seed)
    curves = [target + sigma * rng.normal(size=target.shape)]
    for foot, end in ends:
        foot, end = np.asarray(foot, float), np.asarray(end, float)
        start = foot - overlap * (end - foot) / np.linalg.norm(end - foot)
        line = start + np.linspace(0, 1, 50)[:, None] * (end - start)
        curves.append(line + sigma * rng.normal(size=line.shape))
    return curves


@pytest.mark.parametrize("overlap", [0.015, -0.015])
@pytest.mark.parametrize("first", [False, True])
def test_an_end_that_touches_the_middle_of_another_curve_lies_on_it(overlap, first):
    sill = np.linspace([0, 0, 0], [4.0, 0, 0], 160)
    curves = lines_and_a(sill, 0.01, 3, ([1, 0, 0], [1, 1, 0]), ([3, 0, 0], [3, 1, 0]), overlap=overlap)
    if first:
        curves = [curve[::-1] for curve in curves[::-1]]
    fitted = fit_curves(curves, [False] * 3, sigma=0.01)
    (along,) = [f.primitives[0] for f in fitted if f.primitives[0].length > 2]
    posts = [f.primitives[0] for f in fitted if f.primitives[0].length < 2]
    way = (along.end - along.start) / along.length
    for post in posts:
        foot = min((post.start, post.end), key=lambda p: abs(p[1])) - along.start
        assert np.linalg.norm(foot - (foot @ way) * way) < 1e-12
        assert 0.5 < foot @ way < 3.5
    assert all(f.deviation <= f.noise for f in fitted)


@pytest.mark.parametrize("shape", ["arc", "circle", "bezier"])
def test_an_end_lies_on_a_bent_curve_that_it_touches(shape):
    angle = np.linspace(0, 2 * np.pi * (1 if shape == "circle" else 0.4), 200)[: 199 if shape == "circle" else None]
    target = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    if shape == "bezier":
        t = np.linspace(0, 1, 200)[:, None]
        target = np.concatenate([3 * t, t * t * (3 - 2 * t), 0.4 * t**3], axis=1)
    touch = target[70]
    curves = lines_and_a(target, 0.005, 8, (touch, touch + [0.3, 1.5, 0.2]), overlap=-0.01)
    bent, straight = fit_curves(curves, [shape == "circle", False], sigma=0.005)
    assert [p.kind for p in bent.primitives] == [shape] and [p.kind for p in straight.primitives] == ["line"]
    foot = min((straight.primitives[0].start, straight.primitives[0].end), key=lambda p: np.linalg.norm(p - touch))
    (piece,) = bent.primitives
    t = np.linspace(0, 1, 20001) if shape == "bezier" else np.linspace(-np.pi, np.pi, 20001)
    if shape == "arc":
        t = t * piece.angle / 2 / np.pi
    assert np.linalg.norm(piece.at(t) - foot, axis=1).min() < 2e-4  # half a step of that many points
    assert straight.deviation <= straight.noise


def test_an_end_that_is_further_away_than_the_noise_stays_where_it_is():
    sill = np.linspace([0, 0, 0], [4.0, 0, 0], 160)
    curves = lines_and_a(sill, 0.01, 3, ([1, 0, 0], [1, 1, 0]), overlap=-0.2)
    alone = fit_curve(curves[1], sigma=0.01)
    _, together = fit_curves(curves, [False] * 2, sigma=0.01)
    assert together.primitives[0].start.tolist() == alone.primitives[0].start.tolist()


def hairpin(lean, gap=0.15, height=3.0, step=0.05):
    """Up one side, around a narrow turn, and down the other, which leans towards the first by so many radians."""
    up = np.linspace([0, 0, 0], [0, height, 0], int(height / step))
    top = up[-1] + [gap, 0, 0]
    angle = np.linspace(np.pi, 0, 8)[1:-1]
    turn = up[-1] + [gap / 2, 0, 0] + gap / 2 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    down = top + np.linspace(0, height, int(height / step))[:, None] * [np.sin(lean), -np.cos(lean), 0]
    return np.concatenate([up, turn, down])


@pytest.mark.parametrize("lean", [-0.08, -0.03, 0.0, 0.03, 0.08])
@pytest.mark.parametrize("sigma", [0.003, 0.01])
@pytest.mark.parametrize("closed", [False, True])
def test_no_piece_goes_where_no_sample_is(lean, sigma, closed):
    points, blur = drawings.noisy(hairpin(lean), sigma, 4), 0.15
    fitted = fit_curve(points, closed, sigma=sigma, blur=blur)
    path = dense(fitted.primitives, 0.01, closed)
    ring = np.concatenate([points, points[:1]]) if closed else points
    t = np.linspace(0, 1, 20)[:, None, None]
    line = ((1 - t) * ring[:-1] + t * ring[1:]).reshape(-1, 3)
    assert cKDTree(line).query(path)[0].max() < 1.5 * blur + 0.1
    assert fitted.deviation <= fitted.noise
