# SPDX-License-Identifier: GPL-3.0-or-later
"""The yardstick of speed does what it says: counts, matches and extension on curves whose answer is known."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from benchmarks.blast import compile_yardstick, strong_length, wide_scene, yardstick
from benchmarks.scenes import obj_text

pytestmark = pytest.mark.skipif(
    not any(map(shutil.which, ("g++", "clang++", "c++"))), reason="no C++ compiler is found"
)
H = 0.02


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    return compile_yardstick(tmp_path_factory.mktemp("yardstick"))


def bow(n, radius):
    angle = np.arange(n) * H / radius
    return np.c_[radius * np.cos(angle), radius * np.sin(angle), np.zeros(n)]


def turned(curve):
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    return curve @ (turn * np.linalg.det(turn)).T + [3, 1, -2]


def run(program, folder, curves):
    path = folder / "curves.obj"
    path.write_text(obj_text(curves))
    return yardstick(program, path, edge_length=H, l0=25, seconds=5.0)


def test_point_pairs_are_counted(program, tmp_path):
    curves = [bow(40, 0.5), turned(bow(31, 0.5)), bow(26, 2.0), bow(25, 0.5)]  # the last is not longer than l0
    result = run(program, tmp_path, curves)
    assert (result["strong_curves"], result["strong_samples"]) == (3, 97)
    windows = [40 - 24, 31 - 24, 26 - 24]
    expected = 2 * sum(windows[i] * windows[j] for i in range(3) for j in range(i))
    assert result["point_pairs"] == result["measured_pairs"] == expected


def test_a_turned_copy_matches_everywhere_and_a_corner_nowhere(program, tmp_path):
    assert run(program, tmp_path, [bow(40, 0.3), turned(bow(40, 0.3))])["match_share"] == 1.0
    t = np.arange(26) * H
    corner = np.concatenate([np.c_[t[:14], 0 * t[:14], 0 * t[:14]], np.c_[0 * t[1:14] + t[13], t[1:14], 0 * t[1:14]]])
    straight = np.c_[np.arange(27) * H, np.zeros((27, 2))]
    assert run(program, tmp_path, [corner, straight])["match_share"] == 0.0


def test_the_affinity_is_that_of_the_extended_match(program, tmp_path):
    # Both bows are 40 samples long. A match that starts at x and y is extended by 5 edges as far as both go.
    a = bow(40, 0.3)
    result = run(program, tmp_path, [a, turned(a)])
    lengths = [25 + 5 * ((min(40 - x, 40 - y) - 25) // 5) for x in range(16) for y in range(16)]
    assert result["affinity"] == pytest.approx(2 * sum(lengths) * H, rel=0.01)


def test_a_wide_scene_has_as_many_strong_samples_as_asked():
    scene = wide_scene(3000)
    assert 3000 <= strong_length(scene.curves) < 3200
    assert len(scene.curves) == len(scene.labels)
