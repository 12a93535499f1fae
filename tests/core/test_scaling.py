# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of how time and memory grow."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from benchmarks.scaling import SIZES, expected, exponent, main, size_of, wall


def test_walls_grow_by_windows_of_one_form():
    small, large = wall(3, 2), wall(5, 3)
    assert len(np.unique(small.truth_labels[small.truth_labels[:, 0] == 0, 2])) == 6
    assert len(np.unique(large.truth_labels[large.truth_labels[:, 0] == 0, 2])) == 15
    assert [len(c) for c in small.truth[:10]] == [len(c) for c in large.truth[:10]]
    assert 9_000 < sum(map(len, large.curves)) < 13_000
    windows = [np.prod(size_of(size)) for size in SIZES]
    assert windows == sorted(windows)


def test_the_exponent_is_the_slope():
    results = [{"samples": n, "seconds": 3e-6 * n**1.7, "done": True} for n in (1000, 5000, 9000)]
    assert exponent(results) == pytest.approx(1.7)
    assert expected(results, 18_000) == pytest.approx(3e-6 * 18_000**1.7)
    assert np.isnan(exponent(results[:1])) and expected(results[:1], 9000) == 0
    assert exponent([*results, {"samples": 20_000, "seconds": 1.0, "done": False}]) == pytest.approx(1.7)


def test_a_program_is_measured_on_each_wall(tmp_path, capsys):
    program = tmp_path / "program.py"
    program.write_text(
        "import json, sys, time\n"
        "time.sleep(0.02 * sum(line.startswith('l ') for line in open(sys.argv[1])) / 20)\n"
        "json.dump({'templates': [{'occurrences': [0] * 4}], 'seconds': {}}, open(sys.argv[-1], 'w'))\n"
    )
    out = tmp_path / "out.jsonl"
    words = ["--sizes", "1x2", "2x2", "--program", f"{sys.executable} {program}", "--out", str(out)]
    assert main(words) == 0
    first, second = (json.loads(line) for line in out.read_text().splitlines())
    assert second["samples"] > 1.4 * first["samples"] and second["seconds"] > 0.02 and second["peak"] > 1e6
    assert "4 of 4" in capsys.readouterr().out
    assert main(["--sizes", "1x2", "--program", f"{sys.executable} -c pass"]) == 1
    assert "no result" in capsys.readouterr().out
