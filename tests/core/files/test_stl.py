# SPDX-License-Identifier: GPL-3.0-or-later
"""STL files: both kinds read alike, and damaged ones are named."""

import struct

import numpy as np
import pytest

from core.errors import InputError
from core.files.formats import read_surface
from core.files.stl import read_stl_surface

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
