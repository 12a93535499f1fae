# SPDX-License-Identifier: GPL-3.0-or-later
"""Which reader takes which file, and that README says so."""

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError, NoCurves
from core.files.formats import FORMATS, endings, format_of, read_curves, read_surface, table
from core.files.reading import Reading, concatenate, lines_of_points

ROOT = Path(__file__).resolve().parents[3]


def test_the_table_of_readme_is_that_of_the_code():
    """`python -c "from core.files.formats import table; print(table())"` makes it."""
    assert table() in (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_longest_ending_decides_in_any_case():
    assert format_of("a.polylines.txt") is not format_of("a.txt")
    assert format_of("A.POLYLINES.TXT") is format_of("b.cgal")
    assert format_of("a.obj.xyz") is None and format_of("obj") is None


def test_words_and_readers_go_together():
    for form in FORMATS:
        assert bool(form.surface) == (form.read_surface is not None), form.endings
        assert bool(form.curves) == (form.read_curves is not None), form.endings
    assert set(endings("surface")) | set(endings("curves")) == set(endings())


def test_a_file_of_the_wrong_kind_names_those_that_fit(tmp_path):
    with pytest.raises(InputError, match=r"a surface cannot be read from a .dxf file; give one of .obj, .ply"):
        read_surface(tmp_path / "a.dxf")
    with pytest.raises(InputError, match=r"curves cannot be read from a .stl file; give one of .cgal, .dxf, .obj"):
        read_curves([tmp_path / "a.stl"])


def test_several_readings_keep_what_each_is():
    points = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0)], float)
    one = lines_of_points("a", points, np.array([0, 1, 2]), [0, 3], named=[True])
    two = lines_of_points("b", points, np.array([0, 1, 1, 2]), [0, 2, 4], named=[False, False])
    both = concatenate([two, one, two, one])
    assert isinstance(both, Reading) and both.count == 2
    assert both.curves.source.tolist() == [-1, -1, 0, -1, -1, 1]


def test_lines_without_a_length_are_no_curves():
    with pytest.raises(NoCurves, match="a.obj: no curve has two different points"):
        lines_of_points("a.obj", np.zeros((3, 3)), np.array([0, 1, 2]), [0, 3], named=[True])
