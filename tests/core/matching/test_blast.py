# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature BLAST finds what Algorithm 1 finds when it is run point by point."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from core.errors import Cancelled
from core.matching import windows
from core.matching.blast import Matches, feature_blast
from tests import naive
from tests.core import shapes

L0, OPTIONS = 20, {"s": 1.0, "t": 2.0, "delta_l": 5.0}


def run(net, *, l0=L0, strong=None, **more):
    return feature_blast(net, np.arange(len(net)) if strong is None else strong, l0=float(l0), **OPTIONS, **more)


def oracle(net, i, j, **more):
    rings = bool(net.closed[i]), bool(net.closed[j])
    return naive.best_match(net.curve(i), rings[0], net.curve(j), rings[1], l0=L0, s=1.0, t=2.0, step=5, **more)


def gaps(net, found: Matches, i, j, match):
    """How far from where the oracle takes the stretch each match of the pair takes it: RMS distance of the curves."""
    own = np.flatnonzero((found.curve == [i, j]).all(axis=1))
    curve = net.curve(i)
    stretch = curve[(match.a + np.arange(match.count)) % len(curve)]
    there = naive.moved(match.motion, stretch)
    away = [cdist(naive.moved(found.motions[k], stretch), there).min(axis=1) for k in own]
    return own, np.array([np.sqrt((x**2).mean()) for x in away])


def random_scene(rng):
    """Four curves of their own and two noisy pieces of those, somewhere else and in either direction."""
    curves = [shapes.wiggle(rng, int(rng.integers(L0 + 3, 45)), bend=rng.choice([0.2, 0.4, 0.6])) for _ in range(4)]
    for _ in range(2):
        piece = curves[rng.integers(4)][int(rng.integers(0, 3)) :]
        piece = piece[::-1] if rng.random() < 0.5 else piece
        noise = rng.choice([0, 0.1, 0.3]) * rng.normal(size=piece.shape)
        curves.append(naive.moved(shapes.random_motion(rng), piece) + noise)
    return curves


def test_the_best_match_of_every_pair_is_found():
    """Compared is where the stretch goes, not the motion: a flat or straight stretch leaves part of that free."""
    matched = missed = 0
    for seed in range(10):
        net = shapes.network(random_scene(np.random.default_rng(seed)))
        found = run(net)
        for i in range(len(net)):
            for j in range(i + 1, len(net)):
                best = oracle(net, i, j)
                if best is None:
                    continue
                matched += 1
                _, away = gaps(net, found, i, j, best)
                missed += not (away <= 2).any()
    assert matched > 40
    assert missed <= 0.01 * matched, f"{missed} of {matched}"


@pytest.mark.parametrize("noise", [0.0, 0.15])
@pytest.mark.parametrize("reverse", [False, True])
def test_a_planted_copy_is_found(rng, noise, reverse):
    for _ in range(5):
        curve = shapes.wiggle(rng, 60, bend=0.5)
        m = shapes.random_motion(rng)
        copy = naive.moved(m, curve[5:])[:: -1 if reverse else 1]
        net = shapes.network([curve, copy + noise * rng.normal(size=copy.shape)], smoothing=1.5)
        found = run(net, l0=25)
        own = np.flatnonzero((found.curve == [0, 1]).all(axis=1))
        best = own[np.argmax(found.affinity[own])]
        # the longer one is curve 0 of the network, unless noise has lengthened the other
        truth = shapes.in_frame(net, m)
        truth = truth if net.source[0] == 0 else np.linalg.inv(truth)
        assert naive.angle_of(found.motions[best][:3, :3] @ truth[:3, :3].T) < 1.5 + 10 * noise
        away = naive.moved(found.motions[best], net.curve(0)) - naive.moved(truth, net.curve(0))
        assert np.sqrt((away**2).sum(axis=1).mean()) < 0.5 + 5 * noise
        assert found.count[best] >= 45
        assert found.stiffness[best] > 0.2


def test_what_a_match_says_of_itself_is_true(rng):
    net = shapes.network(random_scene(rng))
    found = run(net)
    assert len(found) > 5
    for k in range(len(found)):
        i, j = found.curve[k]
        step = np.arange(found.count[k])
        a = net.curve(i)[found.start[k, 0] + step]
        b = net.curve(j)[found.start[k, 1] + found.direction[k] * step]
        best = naive.fit_motion(a, b)
        d = np.sqrt(((naive.moved(best, a) - b) ** 2).sum(axis=1).mean())
        assert found.distance[k] == pytest.approx(d, abs=1e-4) and d < 2.0
        assert found.affinity[k] == pytest.approx(found.count[k] * np.exp(-d), rel=1e-3)
        assert 0 <= found.stiffness[k] <= 1
        # a straight stretch takes the smallest rotation: its roll may move it by twice its own width
        got = np.sqrt(((naive.moved(found.motions[k], a) - b) ** 2).sum(axis=1).mean())
        width = np.linalg.svd(a - a.mean(axis=0), compute_uv=False)[1:] / np.sqrt(len(a))
        assert d - 1e-6 <= got < d + 2 * np.linalg.norm(width) + 1e-3
        assert np.allclose(found.motions[k][:3, :3] @ found.motions[k][:3, :3].T, np.eye(3), atol=1e-6)


def test_the_agree_test_is_the_residual_of_the_svd(rng):
    size, rows, columns = 25, windows.TILE_ROWS, windows.TILE_COLUMNS
    tiles = []
    for count in (rows, columns):
        curves = [shapes.wiggle(rng, size, bend=b) for b in rng.choice([1e-3, 0.05, 0.1, 0.2, 0.4, 0.8], size=count)]
        tiles.append(np.array(curves) - np.array(curves)[:, :1])
    # Straight ones, copies and mirror images are degenerate: the quartic has double roots there.
    tiles[0][:4] = shapes.line(size)
    tiles[1][:60] = tiles[0][:60] @ naive.turn([1, 2, 3], 2.0).T
    tiles[1][60:90] = tiles[0][60:90] * [1, 1, -1]
    a, b = (t.transpose(2, 0, 1).astype(np.float32) for t in tiles)
    ga, gb = ((t**2).sum(axis=(1, 2)).astype(np.float32) for t in tiles)
    na, nb = (np.linalg.norm(t, axis=2).astype(np.float32) for t in tiles)
    for s in (0.3, 1.0, 2.5):
        got = windows.agree(a, b, ga, gb, na, nb, size, s, windows.Workspace()).copy()
        truth = np.array([naive.distance(window, tiles[1], False)[0] for window in tiles[0]])
        # In single precision, the less of the squares s leaves over, the less is sure.
        clear = np.abs(truth - s) > 0.02 / s**2
        assert clear.mean() > 0.9 and got.any()
        assert (got == (truth < s))[clear].all()


def test_point_pairs_are_counted(rng):
    curves = [shapes.wiggle(rng, n, bend=0.6) for n in (40, 33, 30, 26, 20)]
    net = shapes.network(curves)
    windows = [n - 25 + 1 for n in (40, 33, 30, 26)]
    expected = 2 * sum(x * y for k, x in enumerate(windows) for y in windows[:k])
    assert sorted(np.diff(net.offsets)) == [20, 26, 30, 33, 40]
    assert run(net, l0=25).point_pairs == expected
    assert run(net, l0=50).point_pairs == 0 and len(run(net, l0=50)) == 0
    assert run(net, l0=25, strong=np.array([2])).point_pairs == 0


def test_the_result_does_not_depend_on_blocks_and_threads(rng):
    net = shapes.network(
        random_scene(rng) + [shapes.circle(30), shapes.circle(30, [90, 0, 0])], closed=[False] * 6 + [True] * 2
    )
    first = run(net, block=1 << 10, threads=1)
    assert len(first) > 10
    for block, threads in ((1 << 16, 1), (1 << 17, 2), (1 << 24, 5)):
        other = run(net, block=block, threads=threads)
        for f in fields(Matches):
            assert np.array_equal(getattr(first, f.name), getattr(other, f.name)), f.name


def wave_ring(radius=14, phase=0):
    """A closed curve of which every stretch differs from the others."""
    a = np.linspace(0, 2 * np.pi, 200, endpoint=False) + phase
    r = radius * (1 + 0.25 * np.cos(2 * a + 1) + 0.15 * np.sin(3 * a))
    return np.c_[r * np.cos(a), r * np.sin(a), 4 * np.sin(a) + 3 * np.cos(2 * a)]


@pytest.mark.parametrize("reverse", [False, True])
def test_closed_curves_match_across_the_seam(rng, reverse):
    m = shapes.random_motion(rng)
    ring, copy = wave_ring(), naive.moved(m, wave_ring(phase=2.0))[:: -1 if reverse else 1]
    net = shapes.network([ring, copy, copy[60:120]], closed=[True, True, False])
    ways = shapes.in_frame(net, m), np.linalg.inv(shapes.in_frame(net, m))
    found = run(net, l0=25)
    rings = np.flatnonzero(net.closed)
    assert len(rings) == 2
    own = np.flatnonzero((found.curve == sorted(rings)).all(axis=1))
    best = own[np.argmax(found.affinity[own])]
    n = len(net.curve(rings[0]))
    assert found.count[best] >= n - 10 and found.count[best] <= n, "nearly once round, never further"
    p = net.curve(found.curve[best][0])
    assert min(np.abs(naive.moved(found.motions[best], p) - naive.moved(w, p)).max() for w in ways) < 1.5
    assert (found.start >= 0).all() and (found.start < np.diff(net.offsets)[found.curve]).all()
    # every stretch of the open piece lies on the ring, wherever that begins
    piece = int(np.flatnonzero(~net.closed)[0])
    for ring in rings:
        i, j = sorted((piece, int(ring)))
        own = np.flatnonzero((found.curve == [i, j]).all(axis=1))
        assert found.count[own].max() == len(net.curve(piece))


def test_a_curve_recurs_within_itself(rng):
    curl = shapes.wiggle(rng, 40, bend=0.7)
    there = naive.rigid(shift=[0, 0, 70])
    bridge = np.linspace(curl[-1], naive.moved(there, curl)[0], 60)[1:-1]
    net = shapes.network([np.concatenate([curl, bridge, naive.moved(there, curl)])])
    found = run(net, l0=25)
    assert (found.curve == 0).all()
    truth = shapes.in_frame(net, there)
    away = []
    for k in np.flatnonzero(found.count >= 35):
        start = found.start[k].min() if found.direction[k] > 0 else found.start[k, 0]
        p = net.curve(0)[start : start + found.count[k]]
        both = found.motions[k], np.linalg.inv(found.motions[k])
        away.append(min(np.abs(naive.moved(m, p) - naive.moved(truth, p)).max() for m in both))
    assert min(away) < 0.7
    # the curve does not match itself where it lies
    still = np.abs(found.motions - np.eye(4)).max(axis=(1, 2)) < 1e-3
    assert not (still & (found.start[:, 0] == found.start[:, 1]) & (found.direction > 0)).any()


def test_degenerate_networks():
    lines = [shapes.line(60), shapes.line(60), shapes.line(40, [0, 30, 0], [0, 0, 1])]
    found = run(shapes.network(lines), l0=25)
    assert len(found) and np.isfinite(found.motions).all() and np.isfinite(found.affinity).all()
    assert (found.stiffness < 0.05).all(), "a straight stretch fixes no roll"
    none = run(shapes.network([shapes.line(10)]), l0=25)
    assert len(none) == 0 and none.point_pairs == 0


def test_progress_rises_and_may_stop(rng):
    net = shapes.network([shapes.wiggle(rng, 60, bend=0.4) for _ in range(6)])
    told = []
    run(net, l0=25, progress=lambda stage, f: told.append((stage, f)))
    assert {stage for stage, _ in told} == {"blast"}
    shares = [f for _, f in told]
    assert shares == sorted(shares) and 0 <= shares[0] and shares[-1] <= 1

    def stop(stage, fraction):
        raise Cancelled

    with pytest.raises(Cancelled):
        run(net, l0=25, progress=stop)
