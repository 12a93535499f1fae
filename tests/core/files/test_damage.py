# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files through every reader: nothing but InputError, no hang, no memory that the file does not ask for."""

import io
import tracemalloc
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.files.formats import content, format_of, read_curves, read_surface
from core.files.writers.obj import write_obj

MOST_BYTES = 60_000_000
"""That a file of a few kilobytes may take, ezdxf's own tables included."""

RNG = np.random.default_rng(5)
POINTS = np.round(RNG.normal(size=(12, 3)), 3)
TRIANGLES = np.array([(0, 1, 2), (2, 1, 3), (4, 5, 6), (6, 5, 7), (8, 9, 10)], np.int32)


def rows(table):
    return "".join(" ".join(f"{v:g}" for v in row) + "\n" for row in table)


def obj(folder):
    write_obj(folder / "base.obj", [POINTS[:5], POINTS[5:7], POINTS[7:]], [False, False, True], ["a", "a", "b"])
    text = (folder / "base.obj").read_text()
    return (text + "f 1/1 2//2 3\nf -4 -3 -2 -1\nf 1 2 3 4 5 \\\n 6 7\nf 1 2\nl 3 4\np 1\n").encode()


def ply(order):
    kind = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = f"ply\nformat {kind} 1.0\ncomment c\nelement vertex 12\n" + "".join(f"property float {c}\n" for c in "xyz")
    head += "property uchar red\nelement face 5\nproperty list uchar int vertex_indices\nelement edge 3\n"
    head += "property int vertex1\nproperty int vertex2\nelement tristrips 1\nproperty list int int vertex_indices\n"
    edges, strip = np.array([(0, 1), (1, 2), (4, 5)]), np.array([6, 0, 1, 2, -1, 3, 4])
    if not order:
        tables = np.c_[POINTS, np.full(12, 200)], np.c_[np.full(5, 3), TRIANGLES], edges, [strip]
        return (head + "end_header\n" + "".join(map(rows, tables))).encode()
    vertex = np.zeros(12, [("p", order + "f4", 3), ("r", "u1")])
    vertex["p"] = POINTS
    face = np.zeros(5, [("n", "u1"), ("i", order + "i4", 3)])
    face["n"], face["i"] = 3, TRIANGLES
    numbers = edges.astype(order + "i4").tobytes() + strip.astype(order + "i4").tobytes()
    return (head + "end_header\n").encode() + vertex.tobytes() + face.tobytes() + numbers


def stl():
    facets = np.zeros(5, [("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")])
    facets["p"] = POINTS[TRIANGLES]
    return b"a scan".ljust(80) + np.uint32(5).tobytes() + facets.tobytes()


def stl_text():
    out = io.StringIO("solid a\n")
    out.seek(0, 2)
    for corners in POINTS[TRIANGLES]:
        vertices = "".join(f"vertex {x:g} {y:g} {z:g}\n" for x, y, z in corners)
        out.write(f"facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    return (out.getvalue() + "endsolid a\n").encode()


def dxf(folder):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R12")
    block = document.blocks.new("A")
    block.add_line((0, 0), (1, 0))
    space = document.modelspace()
    space.add_blockref("A", (3, 0), dxfattribs={"rotation": 30, "column_count": 2, "column_spacing": 2})
    space.add_arc((0, 0), 2, 10, 300)
    space.add_polyline2d([(0, 0, 0.5), (1, 1, 0), (2, 0, 0)], format="xyb")
    document.saveas(folder / "base.dxf")
    return (folder / "base.dxf").read_bytes()


RIDGES = b"".join(b"%d 1.5 0.2 " % (1 + k % 6) + rows([POINTS[k : k + 4].ravel()]).encode() for k in range(0, 8, 4))
CREST = b"3\n2\n1\n0 0 0 0\n1 0 0 0\n2 0 0 0\n12 0.9 3\n0 1 17\n2 1 18\n"
POLYLINES = b"4 " + rows([POINTS[:4].ravel()]).encode() + b"2\n" + rows(POINTS[4:6]).encode()

FILES = {
    "a.obj": obj, "ascii.ply": lambda _: ply(""), "little.ply": lambda _: ply("<"), "big.ply": lambda _: ply(">"),
    "binary.stl": lambda _: stl(), "ascii.stl": lambda _: stl_text(), "ridges.txt": lambda _: RIDGES,
    "crest.txt": lambda _: CREST, "lines.txt": lambda _: POLYLINES, "a.polylines.txt": lambda _: POLYLINES,
    "a.dxf": dxf,
}  # fmt: skip

WORDS = (
    b"0", b"-1", b"1", b"2", b"99999999999", b"-99999999999999999999", b"1e400", b"1e-320", b"1e308", b"nan", b"-inf",
    b"", b"x", b"3", b"4294967295", b"255", b"\xff\xff\xff\xff", b"\0\0\0\0", b"\0", b"\n", b"\r", b" ", b"\\\n", b"#",
    b"\xef\xbb\xbf", b"\xff\xfe", b"0.5", b"l", b"f", b"v", b"vertex", b"list", b"comment", b"  0\nINSERT\n",
)  # fmt: skip

EDIT = st.tuples(st.sampled_from(("word", "bytes", "cut", "twice", "end")), st.floats(0, 1), st.floats(0, 1),
                 st.sampled_from(WORDS))  # fmt: skip


def damaged(data, edits):
    for kind, begin, end, word in edits:
        a, b = sorted((int(begin * len(data)), int(end * len(data))))
        if kind == "word":  # a number or a name is another one
            while a < len(data) and not data[a : a + 1].isspace():
                a += 1
            b = a + 1
            while b < len(data) and not data[b : b + 1].isspace():
                b += 1
            data = data[: a + 1] + word + data[b:]
        elif kind == "bytes":
            data = data[:a] + word + data[a + len(word) :]
        elif kind == "cut":
            data = data[:a] + data[min(b, a + 40) :]
        elif kind == "twice":
            data = data[:b] + data[a : min(b, a + 400)] + data[b:]
        else:
            data = data[: max(b, 1)]
    return data


@pytest.fixture(scope="module", params=FILES)
def base(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("damage")
    return folder / request.param, FILES[request.param](folder)


def test_the_files_are_whole_before_they_are_damaged(base):
    path, data = base
    path.write_bytes(data)
    form = format_of(path)
    read = [read_curves([path]).curves.points] if form.read_curves else []
    read += [read_surface(path)[1]] if form.read_surface else []
    assert read and all(map(len, read))


@settings(
    max_examples=40, deadline=5000, derandomize=True, database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow, HealthCheck.data_too_large],
)  # fmt: skip
@given(st.lists(EDIT, min_size=1, max_size=4))
def test_damage_raises_input_error_or_nothing(base, edits):
    path, data = base
    path.write_bytes(damaged(data, edits) or b" ")
    form = format_of(path)
    tracemalloc.start()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for reader in (content, form.read_curves and (lambda p: read_curves([p])), form.read_surface):
                try:
                    if reader:
                        reader(path)
                except InputError as error:
                    assert "\n" not in str(error)
        assert tracemalloc.get_traced_memory()[1] < MOST_BYTES
    finally:
        tracemalloc.stop()
