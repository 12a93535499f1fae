# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY files, ascii and binary of both byte orders."""

import numpy as np
import pytest

from core.errors import InputError
from core.files.formats import mean_edge_length, read_curves, read_surface

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]], float)
FORMATS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}


def ply(kind, *, edges=(), faces=(), curvature=None, count="uchar"):
    """A PLY file's bytes, made here with nothing of the reader."""
    order = FORMATS[kind]
    head = [f"ply\nformat {kind} 1.0\ncomment made by a test\nelement vertex {len(POINTS)}"]
    head += [f"property float {c}" for c in "xyz"]
    head += ["property double curvature"] if curvature is not None else []
    head += [f"element edge {len(edges)}\nproperty int vertex1\nproperty int vertex2\nproperty uchar kind"]
    head += [f"element face {len(faces)}\nproperty list {count} int vertex_indices\nproperty float area\nend_header\n"]
    rows = []
    for i, p in enumerate(POINTS):
        rows.append([("f4", v) for v in p] + ([("f8", curvature[i])] if curvature is not None else []))
    rows += [[("i4", a), ("i4", b), ("u1", 6)] for a, b in edges]
    length = {"uchar": "u1", "int": "i4"}[count]
    rows += [[(length, len(f)), *(("i4", v) for v in f), ("f4", 0.5)] for f in faces]
    if order is None:
        body = "".join(" ".join(f"{v:g}" for _, v in row) + "\n" for row in rows).encode()
    else:
        body = b"".join(np.array(v, order + t).tobytes() for row in rows for t, v in row)
    return "\n".join(head).encode() + body


@pytest.fixture
def file(tmp_path):
    def write(data):
        path = tmp_path / "in.ply"
        path.write_bytes(data)
        return path

    return write


@pytest.mark.parametrize("kind", FORMATS)
def test_edges_are_a_graph(kind, file):
    read = read_curves([file(ply(kind, edges=[(0, 1), (1, 2), (2, 3), (3, 0)]))]).curves
    assert read.closed.tolist() == [True]
    assert read.points.tolist() == POINTS[:4].tolist()
    assert read.strength is None


@pytest.mark.parametrize("kind", FORMATS)
def test_elements_of_no_row(kind, file):
    data = ply(kind, edges=[(0, 1)]).replace(b"property float area\n", b"")
    assert len(read_curves([file(data)]).curves) == 1 and len(read_surface(file(data))[1]) == 0


@pytest.mark.parametrize("kind", FORMATS)
def test_curvature_is_the_strength(kind, file):
    read = read_curves([file(ply(kind, edges=[(2, 1), (1, 0)], curvature=[1, -2.5, 3, 4, 5]))]).curves
    assert read.strength.tolist() == [3, 2.5, 1]


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("count", ["uchar", "int"])
@pytest.mark.parametrize("faces", [[(0, 1, 2), (0, 2, 3)], [(0, 1, 2, 3)], [(0, 1, 2), (0, 1, 2, 3)], []])
def test_faces_are_triangles(kind, count, faces, file):
    path = file(ply(kind, edges=[(0, 1)], faces=faces, count=count))
    fans = [[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)]
    assert read_surface(path)[1].tolist() == fans


def test_the_mean_edge_counts_each_edge_once(file):
    path = file(ply("ascii", faces=[(0, 1, 2), (0, 2, 3)]))
    assert mean_edge_length(*read_surface(path)) == pytest.approx((4 + 2**0.5) / 5)


@pytest.mark.parametrize("kind", FORMATS)
def test_a_file_that_was_cut_off(kind, file):
    data = ply(kind, edges=[(0, 1), (1, 2)])
    with pytest.raises(InputError, match=r"cut off, it has 1 of 2 rows of `edge`"):
        read_curves([file(data[: -6 if kind == "ascii" else -3])])
    with pytest.raises(InputError, match="cut off"):
        read_curves([file(data[:40])])


@pytest.mark.parametrize("kind", FORMATS)
def test_faces_that_were_cut_off(kind, file):
    data = ply(kind, faces=[(0, 1, 2), (0, 2, 3, 1)])
    with pytest.raises(InputError, match=r"cut off, it has 1 of 2|does not fit"):
        read_surface(file(data[:-14]))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"ply\nformat ascii 1.0\nelement vertex two\nend_header\n", "line 3: 'element vertex two' is not PLY"),
        (b"ply\nformat ascii 1.0\nproperty float x\nend_header\n", "line 3"),
        (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty fload x\nend_header\n1\n", "line 4"),
        (
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
            "no element `vertex` with x, y",
        ),
        (b"solid cube\n", "no PLY header"),
        (ply("ascii", faces=[(0, 1, 2)]).replace(b"edge 0", b"egde 0"), "--surface"),
        (ply("ascii", edges=[(0, 1), (1, 77)]), "edge 1: index 77 has no point, the file has 5"),
        (ply("binary_big_endian", edges=[(0, -1)]), "edge 0: index -1"),
        (ply("ascii", edges=[(0, 2)]).replace(b"1 1 0\n", b"1 nan 0\n"), "vertex 2"),
        (ply("ascii", edges=[(0, 1)]).replace(b"1 1 0\n", b"1 1\n"), "cut off, it has 0 of 1 rows of `edge`"),
        (ply("ascii", edges=[(0, 1)]).replace(b"1 1 0\n", b"1 1 0 7\n"), "1 numbers more than its header tells of"),
        (ply("ascii", edges=[(0, 2)], curvature=[0, 0, float("inf"), 0, 0]), "vertex 2: its curvature is not finite"),
    ],
)
def test_what_is_wrong_is_named(data, message, file):
    with pytest.raises(InputError) as error:
        read_curves([file(data)])
    assert message in str(error.value)


def test_a_surface_without_faces(file):
    with pytest.raises(InputError, match="no edge with a length"):
        mean_edge_length(*read_surface(file(ply("ascii"))))
    with pytest.raises(InputError, match="face 0: index 9"):
        read_surface(file(ply("ascii", faces=[(0, 1, 9)])))


def header(*lines):
    return "\n".join(["ply", "format ascii 1.0", *lines, "end_header\n"]).encode()


VERTICES = ("element vertex 4", "property float x", "property float y", "property float z")
FACES = ("element face 2", "property list uchar int vertex_indices")
BODY = b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
@pytest.mark.parametrize(
    "data",
    [
        header(*VERTICES, *FACES) + BODY,
        header(*VERTICES, *FACES) + BODY.replace(b"\n", b" "),  # rows that are not lines
        header(*VERTICES, *FACES) + BODY.replace(b" ", b"\n"),
        header("comment a", "obj_info b", *VERTICES, *FACES) + BODY.replace(b"3 0 1", b"comment x 1\n3 0 1"),
        header(*VERTICES, *FACES) + b"comment first\n" + BODY,
        header(*(line.replace(" x", " X").replace("vertex", "Vertex") for line in VERTICES), *FACES) + BODY,
        header(*VERTICES, *(line.replace("indices", "index") for line in FACES)) + BODY,
        header(*VERTICES, "property uchar red", *FACES) + BODY.replace(b" 0\n", b" 0 255\n"),
        header(*VERTICES, "property float x", *FACES) + BODY.replace(b" 0\n", b" 0 9\n"),  # there twice
        header(*VERTICES, "element tristrips 1", "property list int int vertex_indices") + BODY[:24] + b"4 0 1 3 2",
        header(*VERTICES, "element empty 5", *FACES) + BODY,
    ],
)  # fmt: skip
def test_what_writers_really_write(data, end, file):
    points, triangles = read_surface(file(data.replace(b"\n", end)))
    a, b, c = (points[triangles[:, i]] for i in range(3))
    assert np.cross(b - a, c - a).tolist() == [[0, 0, 1]] * 2
    assert len(points) == 4


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_mark_before_the_header(file, encoding):
    assert len(read_surface(file((header(*VERTICES, *FACES) + BODY).decode().encode(encoding)))[1]) == 2


def test_strips_with_breaks_run_the_same_way(file):
    head = header(*VERTICES, "element tristrips 1", "property list int int vertex_indices")
    points, triangles = read_surface(file(head + BODY[:24] + b"8 0 1 3 2 -1 0 1 2"))
    assert triangles.tolist() == [[0, 1, 3], [1, 2, 3], [0, 1, 2]]


def test_a_point_that_no_face_has_may_be_anything(file):
    body = BODY.replace(b"1 1 0", b"nan nan nan").replace(b"3 0 1 2\n3 0 2 3", b"3 0 1 3\n3 1 0 3")
    points, triangles = read_surface(file(header(*VERTICES, *FACES) + body))
    assert points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]] and triangles.tolist() == [[0, 1, 2], [1, 0, 2]]
    with pytest.raises(InputError, match="vertex 2"):
        read_surface(file(header(*VERTICES, *FACES) + BODY.replace(b"1 1 0", b"nan nan nan")))


@pytest.mark.parametrize(
    ("head", "message"),
    [
        (("element vertex -3", *VERTICES[1:]), "line 3: 'element vertex -3' is not PLY"),
        (("element vertex 99999999999999999999", *VERTICES[1:]), "line 3"),
        (("element vertex 9999999999", *VERTICES[1:], *FACES), "cut off, it has 6 of 9999999999 rows of `vertex`"),
        ((*VERTICES, "element face 2", "property list float int vertex_indices"), "line 8"),
        ((*VERTICES, "element face 2", "property list uchar int corners"), "`face` has no vertex_indices"),
        ((*VERTICES, *VERTICES), "line 7: 'element vertex 4' is not PLY"),
        ((*VERTICES, "propertee float q"), "line 7"),
        (("element vertex 4", "property list uchar float x", *VERTICES[2:], *FACES), "cut off|is a list where one"),
    ],
)  # fmt: skip
def test_a_header_that_lies_is_refused(head, message, file):
    with pytest.raises(InputError, match=message):
        read_surface(file(header(*head) + BODY))


def test_lists_that_are_no_lists_are_refused(file):
    with pytest.raises(InputError, match="`vertex_indices` of `face` is one number"):
        read_surface(file(header(*VERTICES, "element face 2", "property int vertex_indices") + BODY[:24] + b"0 1"))
    for body, message in ((BODY.replace(b"3 0 1 2", b"-3 0 1 2"), "face 0: -3 is no length"),
                          (BODY.replace(b"3 0 1 2", b"3 0 1.5 2"), "1.5 is no index"),
                          (BODY.replace(b"3 0 1 2", b"3 0 x 2"), "'x' in the body is not a number")):  # fmt: skip
        with pytest.raises(InputError, match=message):
            read_surface(file(header(*VERTICES, *FACES) + body))
