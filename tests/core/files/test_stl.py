# SPDX-License-Identifier: GPL-3.0-or-later
"""STL files: both kinds read alike, and damaged ones are named."""

import struct

import numpy as np
import pytest

from core.errors import InputError
from core.files.formats import read_surface
from core.files.readers.stl import read_stl_surface

SQUARE = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], float)


def binary(triangles, name=b"a scan"):
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *t.ravel(), 0) for t in triangles)
    return name.ljust(80, b" ") + struct.pack("<I", len(triangles)) + body


def ascii_text(triangles):
    facets = "".join(
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x:g} {y:g} {z:g}\n" for x, y, z in t)
        + " endloop\nendfacet\n"
        for t in triangles
    )
    return ("solid a\n" + facets + "endsolid a\n").encode()


@pytest.mark.parametrize("data", [binary(SQUARE), binary(SQUARE, b"solid but binary"), ascii_text(SQUARE)])
def test_reads_shared_vertices(tmp_path, data):
    path = tmp_path / "a.stl"
    path.write_bytes(data)
    points, faces = read_surface(path)
    assert points.shape == (4, 3)
    assert np.array_equal(points[faces], SQUARE)


@pytest.mark.parametrize(
    "data, message",
    [
        (binary(SQUARE)[:-7], "cut off"),
        (b"PK\3\4" + bytes(200), "do not fit"),
        (b"solid a\nendsolid a\n", "no facets"),
        (ascii_text(SQUARE).replace(b"vertex 1 1 0", b"vertex 1 x 0"), "line 6: 'x' is not a number"),
        (ascii_text(SQUARE).replace(b"  vertex 0 1 0\n", b""), "cut off"),
        (binary(np.where(SQUARE == 1, np.nan, SQUARE)), "facet 0: a coordinate is not finite"),
        (b"", "empty"),
    ],
)
def test_damage_is_named(tmp_path, data, message):
    path = tmp_path / "a.stl"
    path.write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_stl_surface(path)


def total_area(path):
    points, faces = read_surface(path)
    a, b, c = (points[faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def counted(data, count):
    return data[:80] + struct.pack("<I", count) + data[84:]


@pytest.mark.parametrize(
    ("data", "area"),
    [
        (binary(SQUARE) + b"spare", 1),
        (binary(SQUARE, b"solid with spare bytes") + bytes(50), 1),
        (counted(binary(SQUARE), 0), 1),
        (counted(binary(SQUARE), 2**32 - 1), 1),
        (counted(binary(SQUARE), 1), 1),
        (binary(SQUARE) + binary(SQUARE + 3), 2),
        (ascii_text(SQUARE) + ascii_text(SQUARE + 3), 2),
        (b"\n" + ascii_text(SQUARE).replace(b"\n", b"\r\n").upper().replace(b"SOLID A", b"solid Vertex 1"), 1),
        (ascii_text(SQUARE).replace(b"\n  vertex", b" vertex").replace(b"\n endloop", b" endloop"), 1),
        (b"\xef\xbb\xbf" + ascii_text(SQUARE), 1),
        (ascii_text(SQUARE).replace(b"\n", b" "), 1),
        (ascii_text(SQUARE).replace(b"\n", b"\r"), 1),
        (ascii_text(SQUARE).decode().encode("utf-16"), 1),
    ],
)
def test_what_writers_really_write(tmp_path, data, area):
    (tmp_path / "a.stl").write_bytes(data)
    assert total_area(tmp_path / "a.stl") == pytest.approx(area)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (counted(binary(SQUARE), 3), "of 3 facets, there is room for 2"),
        (ascii_text(SQUARE).replace(b" endloop", b"  vertex 5 5 5\n endloop", 1), "a facet of 4 vertices"),
        (b"short", "too few"),
        (ascii_text(SQUARE)[: ascii_text(SQUARE).rindex(b"vertex") + 9], "three coordinates; .* cut off"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path, data, message):
    (tmp_path / "a.stl").write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_stl_surface(tmp_path / "a.stl")
