# SPDX-License-Identifier: GPL-3.0-or-later
"""OBJ files: what is read, what is written, and what is refused."""

import numpy as np
import pytest

from core.errors import InputError
from core.files.formats import Content, content, mean_edge_length, read_curves, read_surface
from core.files.writers.obj import write_obj

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


@pytest.fixture
def obj(tmp_path):
    def write(text, name="in.obj"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def curves(path):
    read = read_curves([path]).curves
    return [read.curve(i).tolist() for i in range(len(read))]


def test_every_line_is_one_curve(obj):
    read = read_curves([obj(SQUARE + "l 1 2 3\nl 3 4 1\n")])
    assert read.count == 2
    assert read.curves.closed.tolist() == [True]  # where nothing else meets them they go on as one
    assert read.shares.line.tolist() == [0, 1]
    assert read.shares.length.tolist() == [2, 2]


def test_a_line_that_is_met_inside_is_cut_and_remembers_its_source(obj):
    read = read_curves([obj(SQUARE + "v 2 2 2\nl 1 2 3 4\nl 5 3\n")])
    assert read.count == 2
    assert read.curves.source.tolist() == [0, 0, 1]


def test_a_closed_line_stays_closed(obj):
    read = read_curves([obj(SQUARE + "l 1 2 3 4 1\n")])
    assert read.curves.closed.tolist() == [True]
    assert len(read.curves.points) == 4


def test_edges_only_is_a_graph(obj):
    read = read_curves([obj(SQUARE + "l 1 2\nl 3 2\nl 3 4\n")])
    assert len(read.curves) == read.count == 1
    assert read.curves.points[:, :2].tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]


@pytest.mark.parametrize(
    "lines",
    [
        "l 1/1 2/2 3/3",
        "l -4 -3 -2",
        "l 1 2 \\\n3",
        "  l 1 2 3",
        "l\t1 2 3 # a note",
        "o x\r\ng y\r\nl 1 2 3\r",
        "s 1\nl 1 2 3",
    ],
)
def test_ways_to_write_a_line(obj, lines):
    assert curves(obj(SQUARE + lines + "\n")) == [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]


def test_a_negative_index_counts_from_the_points_before_it(obj):
    assert curves(obj("v 0 0 0\nv 1 0 0\nv 2 0 0\nl -3 -2 -1\nv 9 9 9\n")) == [[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]


def test_weights_and_colours_of_points_are_ignored(obj):
    assert curves(obj("v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 2 0 0\nl 1 2 3\n")) == [[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]


def test_zero_length_edges_and_isolated_points_go(obj):
    text = "v 0 0 0\nv 0 0 0\nv 1 0 0\nv 7 7 7\nv 1 0 0\nl 1 2 3\nl 3 5\nl 1 2 3 5 1\n"
    read = read_curves([obj(text)])
    assert [read.curves.curve(i).tolist() for i in range(len(read.curves))] == [[[0, 0, 0], [1, 0, 0]]]
    assert read.count == 2  # a single edge without a length is nothing
    assert read.shares.line.tolist() == [0, 1]  # the second goes there and back where the first is
    assert not read.curves.closed.any()  # two points close nothing


def test_several_files_are_one_network(obj):
    a, b = obj(SQUARE + "l 1 2 3\nl 4 4 4\n", "a.obj"), obj(SQUARE + "l 1 2 3 4\n", "b.obj")
    read = read_curves([a, b])
    assert read.count == 3
    assert read.shares.line.tolist() == [0, 2]  # what is in both files is there once
    assert read.curves.points[:, :2].tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]


def test_far_coordinates_keep_their_digits(obj):
    assert curves(obj("v 10000000.125 0 0\nv 10000001.25 0 0\nl 1 2\n")) == [[[1e7 + 0.125, 0, 0], [1e7 + 1.25, 0, 0]]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty"),
        ("\n  \n", "empty"),
        ("hello\n", "no `v` lines"),
        (b"\x7fELF\0\0\x01\x02", "binary"),
        (SQUARE, "no `l` lines"),
        (SQUARE + "f 1 2 3\n", "--surface"),
        (SQUARE + "l 1 2 9\n", "line 5: index 9 has no point, the file has 4"),
        (SQUARE + "l 1 0 2\n", "line 5: index 0"),
        (SQUARE + "l 1 -5 2\n", "line 5: index -5"),
        (SQUARE + "l 1 2 x\n", "line 5: 'x' is not a whole number"),
        ("v 0 0 0\nv 1 nan 0\nl 1 2\n", "line 2: 'nan' is not finite"),
        ("v 0 0 0\nv 1 -inf 0\nl 1 2\n", "line 2: '-inf' is not finite"),
        ("v 0 0 0\n\nv 1 1e999 0\nl 1 2\n", "line 3: '1e999' is not finite"),
        ("v 0 0 0\nv 1 zwei 0\nl 1 2\n", "line 2: 'zwei' is not a number"),
        ("v 0 0 0\nv 1 0\nl 1 2\n", "line 2: a point has 2 numbers"),
        ("v 0 0 0\nv 0 0 0\nl 1 2\n", "no curve has two different points"),
    ],
)
def test_what_is_wrong_is_named(obj, text, message):
    path = obj(text)
    with pytest.raises(InputError) as error:
        read_curves([path])
    assert str(path) in str(error.value)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_a_folder_and_an_unknown_kind(tmp_path):
    for name, message in (("no.obj", "no such file"), ("dir.obj", "folder"), ("x.xyz", ".obj")):
        (tmp_path / "dir.obj").mkdir(exist_ok=True)
        with pytest.raises(InputError, match=message):
            read_curves([tmp_path / name])


def test_what_is_written_is_read_again(tmp_path):
    rng = np.random.default_rng(3)
    lines, closed = [rng.normal(size=(n, 3)) for n in (2, 5, 9)], [False, True, False]
    write_obj(tmp_path / "out.obj", lines, closed, ["a", "a", "b"])
    read = read_curves([tmp_path / "out.obj"]).curves
    assert read.closed.tolist() == closed
    assert np.allclose(read.points, np.concatenate(lines), atol=1e-7)
    assert (tmp_path / "out.obj").read_text().count("o ") == 2


def test_a_surface_of_mixed_polygons(obj):
    points, triangles = read_surface(obj(SQUARE + "v .5 2 0\nf 1/1/1 2/2/2 3//3 4\nf 4 3 5\n"))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    diagonal, side = 2**0.5, (0.25 + 1) ** 0.5
    assert mean_edge_length(points, triangles) == pytest.approx((4 + diagonal + 2 * side) / 7)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-32"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_any_unicode_and_any_line_end(obj, encoding, end):
    text = ("\ufeff" if encoding == "utf-16-le" else "") + "# \u00dcberzug\n" + SQUARE + "l 1 2 3\n"
    assert curves(obj(text.replace("\n", end).encode(encoding))) == [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]


def test_faces_of_two_corners_are_edges(obj):
    path = obj(SQUARE + "f 1 2\nf 3/1 2/4\n")
    assert curves(path) == [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]
    assert content(path) == Content(faces=False, curves=True)
    assert content(obj(SQUARE + "f 1 2 3\nf 1 4\n")) == Content(faces=True, curves=True)
    for face in ("f 1 2 \\\n3", "f \\\n1 2 3", "f 1 2 3 # three", "  f\t1/1/1 2/2/2 3/3/3", "f 1 2 3\r"):
        assert content(obj(SQUARE + face + "\n")) == Content(faces=True, curves=False)
    assert content(obj((SQUARE + "f 1 2 3\nl 1 4\n").replace("\n", "\r"))) == Content(faces=True, curves=True)
    assert content(obj(SQUARE + "f 1 2 # two\n")) == Content(faces=False, curves=True)


def test_single_edges_and_a_longer_line_are_one_network(obj):
    read = read_curves([obj(SQUARE + "v 0 3 0\nv 0 4 0\nl 1 2\nl 3 2\nl 3 4 5\nl 5 6\n")])
    assert len(read.curves) == 1 and len(read.curves.points) == 6
    assert read.count == 2  # what the edges make, and the line


def test_points_and_continuations_with_spaces_and_comments(obj):
    text = "# C:\\scans\\\n" + SQUARE + "p 1 2\nl 1 \\  \n  2 \\\n 3\n"
    assert curves(obj(text)) == [[[0, 0, 0], [1, 0, 0], [1, 1, 0]]]


@pytest.mark.parametrize("statement", ["curv 0 1 1 2 3 4", "  curv 0 1 -1 -2"])
def test_free_form_curves_are_refused_by_name(obj, statement):
    with pytest.raises(InputError, match=r"line 6: free-form curves \(`curv`\) are not read; convert"):
        read_curves([obj(SQUARE + "l 1 2\n" + statement + "\n")])
    with pytest.raises(InputError, match="free-form surfaces"):
        read_surface(obj(SQUARE + "f 1 2 3\nsurf 0 1 0 1 1 2 3 4\n"))
    with pytest.raises(InputError, match="free-form surfaces"):
        read_curves([obj(SQUARE + "surf 0 1 0 1 1 2 3 4\n")])


def test_a_concave_polygon_is_not_a_fan(obj):
    points, triangles = read_surface(obj("v 0 0 0\nv 4 0 0\nv 4 3 0\nv 2 1 0\nv 0 3 0\nf 3 4 5 1 2\n"))
    a, b, c = (points[triangles[:, i]] for i in range(3))
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert areas.min() > 0 and areas.sum() == pytest.approx(8)


def test_all_digits_are_written(tmp_path):
    points = np.array([[4.5e5 + 1 / 3, 5.4e6 + 1 / 7, 1 / 9], [1e-9, -0.1, 2e17]])
    write_obj(tmp_path / "out.obj", [points], [False])
    assert np.array_equal(read_curves([tmp_path / "out.obj"]).curves.points, points)


def test_a_long_word_makes_no_wide_table(obj):
    with pytest.raises(InputError, match="line 5"):
        read_curves([obj(SQUARE + "v " + "1" * 100_000 + " 0 0\n" + "l 1 2\n" * 1000)])
