# SPDX-License-Identifier: GPL-3.0-or-later
"""Ridge lines as CGAL and CrestCODE write them."""

import numpy as np
import pytest

from core.errors import InputError, NoCurves
from core.files.formats import read_curves

CREST = """5
3
2
0 0 0 0
1 0 0 0
2 0 0 0
5 5 5 1
5 5 9 1
12.0 0.9 3.0
8.0 0.8 2.0
0 1 17
2 1 18
4 3 -1
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "ridges.txt"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_cgal_strength_is_an_integral(file):
    read = read_curves([file("3 4.0 0 0 0 0 1 0 0 2 0 0 \n6 -1.5 9 0 0 0 0 0 3\n")])
    assert read.count == 2
    assert read.curves.offsets.tolist() == [0, 3, 5]
    assert read.curves.strength == pytest.approx([2, 2, 2, 0.5, 0.5])


@pytest.mark.parametrize("end", [b"", b"\x1a", b"\0\0\0\0", b"# the end\n"])
def test_comments_and_what_fills_a_file_up_are_passed_over(file, end):
    text = b"# ridges\n3 4 0 0 0 0 1 0 0\n" + end
    assert read_curves([file(text)]).curves.points.tolist() == [[0, 0, 0], [1, 0, 0]]


def test_cgal_curve_of_equal_points_is_counted_and_left_out(file):
    read = read_curves([file("3 1 0 1 1 1 1 1 1\n3 1 0 0 0 0 0 0 1\n")])
    assert (read.count, read.curves.source.tolist()) == (2, [1])
    assert np.isfinite(read.curves.strength).all()


def test_crest_components_are_joined_and_measured(file):
    read = read_curves([file(CREST)]).curves
    assert [read.curve(i).tolist() for i in range(len(read))] == [
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
        [[5, 5, 9], [5, 5, 5]],
    ]
    assert read.strength == pytest.approx([12 / 2] * 3 + [8 / 4] * 2)


def test_strength_is_kept_only_where_every_file_has_it(file, tmp_path):
    ridges = file(CREST)
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
    assert read_curves([ridges, ridges]).curves.strength is not None
    assert read_curves([ridges, tmp_path / "a.obj"]).curves.strength is None


def test_ridge_lines_cross_the_edges_of_a_mesh(file, tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
    assert read_curves([file(CREST)]).crossings
    assert not read_curves([file(CREST), tmp_path / "a.obj"]).crossings


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello world\n", "line 1: 'hello' is not a number"),
        (b"\x00\x01\x02", "binary"),
        ("3 1 0 0 0 0\n3 1 0 0 0 0 1 0\n", "line 2: 8 numbers"),
        ("3 1 0 0 0 0 1 nan 0\n", "line 1: 'nan' is not finite"),
        ("3 x 0 0 0 0 1 0 0\n", "line 1: 'x' is not a number"),
        ("5\n3\n", "cut off after 2 lines"),
        (CREST[:-10], "cut off, it has 12 of 13 lines"),
        (CREST.replace("4 3 -1", "4 5 -1"), "line 13: no such point, the file has 5"),
        (CREST.replace("5 5 5 1", "5 5 5 2"), "line 7: no such component, the file has 2"),
        (CREST.replace("2 0 0 0", "2 inf 0 0"), "line 6: 'inf' is not finite"),
        (CREST.replace("2 0 0 0", "2 0 0"), "line 6: 3 numbers where 4 belong"),
    ],
)
def test_what_is_wrong_is_named(text, message, file):
    with pytest.raises(InputError) as error:
        read_curves([file(text)])
    assert message in str(error.value)


@pytest.mark.parametrize("line", ["0 1 0 0 0 0 1 0 0", "7 1 0 0 0 0 1 0 0 2 0 0", "2.5 1 0 0 0 0 1 0 0"])
def test_a_type_is_one_to_six(file, line):
    with pytest.raises(InputError, match=f"line 2: {line.split()[0]} is no type of a ridge line"):
        read_curves([file("3 4.0 0 0 0 0 1 0 0 2 0 0 5 5 5\n" + line + "\n")])


@pytest.mark.parametrize(
    "rows",
    [
        "6.3 0.1 -0.2 126 178 99 0 -1 0\n4.4 0 3.3 93 172 138 0 -1 0\n",
        "0.1 0.2 0.3\n0.4 0.5 0.6\n0.7 0.8 0.9\n",
        "//X Y Z I\n0.1 0.2 0.3 9\n0.4 0.5 0.6 8\n",
        "0.1, 0.2, 0.3, 7\n0.4, 0.5, 0.6, 7\n",
        "3\n0.1 0.2 0.3 9 255 0 0\n0.4 0.5 0.6 8 255 0 0\n0.4 0.9 0.6 8 255 0 0\n",
        "x y z r g b\n1 2 3 4 5 6\n2 2 3 4 5 6\n3 2 1 1 1 1\n",
        "1 2 3 4\n1 2 3 5\n",
        "2 0 0 0 1 0 0\n2.5 0 0 0 1 0 0\n",
    ],
)
def test_a_point_cloud_is_called_one(file, rows):
    with pytest.raises(NoCurves, match="this is a point cloud, .* make a mesh of it"):
        read_curves([file(rows)])


POLYLINES = "3 0 0 0 1 0 0 1 1 0\n2 5 5 5 6 5 5\n"


@pytest.mark.parametrize("name", ["a.txt", "a.polylines.txt", "a.cgal", "A.CGAL"])
@pytest.mark.parametrize(
    "text",
    [POLYLINES, "3\n0 0 0\n1 0 0\n1 1 0\n2\n5 5 5\n6 5 5\n", "3 0 0 0 1 0 0 1 1 0 a crease\n\n2 5 5 5 6 5 5\n"],
)
def test_polylines_of_cgal(tmp_path, name, text):
    if name == "a.txt" and "crease" in text:
        return  # with words behind the points a .txt is not known as polylines
    (tmp_path / name).write_text(text)
    read = read_curves([tmp_path / name])
    assert [read.curves.curve(i).tolist() for i in range(2)] == [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]],
        [[5, 5, 5], [6, 5, 5]],
    ]
    assert read.count == 2 and not read.crossings


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("3 0 0 0 1 0 0\n", "line 1: a polyline of 3 points has 2; was the file cut off"),
        ("2 0 0 0 1 0 0 1 1 0\n", "line 1: there are more numbers than the 2 points"),
        ("3 0 0 0 1 0 0\n2 5 5 5 6 5 5\n", "line 2: there are more numbers than the 3 points of line 1"),
        ("-1 0 0 0\n", "line 1: '-1' is no number of points"),
        ("99999999999 0 0 0\n", "line 1"),
        ("999999999 0 0 0\n", "was the file cut off"),
        ("2 0 0 0 nan 0 0\n", "line 1: 'nan' is not finite"),
    ],
)
def test_polylines_that_do_not_fit_are_named(tmp_path, text, message):
    (tmp_path / "a.cgal").write_text(text)
    with pytest.raises(InputError, match=message):
        read_curves([tmp_path / "a.cgal"])
