# SPDX-License-Identifier: GPL-3.0-or-later
"""Binary glTF: layouts of the data, placement by nodes, and what is refused."""

import json
import struct

import numpy as np
import pytest

from core.errors import InputError
from core.files.formats import read_surface

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4")
CORNERS = np.array([0, 1, 2, 0, 2, 3])


def glb(document, binary=b"", version=2):
    """The bytes of a file."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        binary += b"\0" * (-len(binary) % 4)
        body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", version, 12 + len(body)) + body


def square(*, index="<u2", nodes=None, mode=None, corners=CORNERS, points=SQUARE, more=None):
    """A document with one mesh, the square, and its binary chunk."""
    kinds = {"<u1": 5121, "<u2": 5123, "<u4": 5125}
    binary = points.tobytes() + np.asarray(corners, index).tobytes()
    primitive = {"attributes": {"POSITION": 0}, "indices": 1}
    if mode is not None:
        primitive["mode"] = mode
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes or [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 1, "componentType": kinds[index], "count": len(corners), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": points.nbytes},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": len(binary) - points.nbytes},
        ],
        "buffers": [{"byteLength": len(binary)}],
        **(more or {}),
    }
    return document, binary


@pytest.fixture
def read(tmp_path):
    def of(data):
        (tmp_path / "a.glb").write_bytes(data)
        return read_surface(tmp_path / "a.glb")

    return of


def upright(points):
    """y-up to z-up, in words of its own: what was up (y) is z, what came forward (z) is -y."""
    points = np.asarray(points, float)
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


@pytest.mark.parametrize("index", ["<u1", "<u2", "<u4"])
def test_points_and_triangles(read, index):
    points, triangles = read(glb(*square(index=index)))
    assert points.dtype == np.float64 and triangles.dtype == np.int64
    assert np.array_equal(points, upright(SQUARE))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(("mode", "corners", "expected"), [
    (5, [0, 1, 3, 2], [[0, 1, 3], [1, 2, 3]]),
    (6, [0, 1, 2, 3], [[1, 2, 0], [2, 3, 0]]),
])  # fmt: skip
def test_strips_and_fans_face_one_way(read, mode, corners, expected):
    points, triangles = read(glb(*square(mode=mode, corners=corners)))
    assert triangles.tolist() == expected
    normal = np.cross(*(points[triangles[:, 1:]] - points[triangles[:, :1]]).transpose(1, 0, 2))
    assert (normal @ normal[0] > 0).all()


def test_nodes_place_meshes_one_inside_the_other_and_more_than_once(read):
    half = np.sqrt(0.5)
    nodes = [
        {"children": [1, 2], "translation": [10, 0, 0]},
        {"mesh": 0, "rotation": [0, 0, half, half], "scale": [2, 2, 2]},  # a quarter turn about z
        {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]},
    ]
    points, triangles = read(glb(*square(nodes=nodes)))
    turned = np.stack([-2 * SQUARE[:, 1], 2 * SQUARE[:, 0], 0 * SQUARE[:, 0]], axis=1) + [10, 0, 0]
    assert np.allclose(points, upright(np.concatenate([turned, SQUARE + [10, 0, 5]])))
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]


def test_a_mirrored_node_keeps_the_outside_outside(read):
    points, triangles = read(glb(*square(nodes=[{"mesh": 0, "scale": [-1, 1, 1]}])))
    a, b, c = points[triangles[0]]
    normal = np.cross(b - a, c - a)
    assert np.allclose(normal, upright([[0, 0, 1]])[0])


def test_interleaved_and_quantised_positions(read):
    document, _ = square()
    row = np.zeros(4, [("position", "<i2", 3), ("rest", "u1", 6)])
    row["position"] = np.round(SQUARE * 32767)
    binary = row.tobytes() + CORNERS.astype("<u2").tobytes()
    document["accessors"][0].update(componentType=5122, normalized=True)
    document["bufferViews"] = [
        {"buffer": 0, "byteLength": row.nbytes, "byteStride": 12},
        {"buffer": 0, "byteOffset": row.nbytes, "byteLength": 12},
    ]
    assert np.allclose(read(glb(document, binary))[0], upright(SQUARE))


def test_points_and_lines_are_left_out(read):
    document, binary = square()
    document["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    assert len(read(glb(document, binary))[1]) == 2
    document["meshes"][0]["primitives"].pop(0)
    with pytest.raises(InputError, match="no triangles"):
        read(glb(document, binary))


def broken(change):
    document, binary = square()
    change(document)
    return glb(document, binary)


BROKEN = {
    "cut": (glb(*square())[:-8], "cut off"),
    "old": (glb(*square(), version=1), "glTF 1"),
    "other": (b"PK\3\4" + bytes(40), "not a .glb"),
    "text": (glb([]), "no description"),
    "draco": (broken(lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"])), "compressed"),
    "sparse": (broken(lambda d: d["accessors"][0].update(sparse={})), "sparse"),
    "count": (broken(lambda d: d["accessors"][0].update(count=900)), "ends before accessor 0"),
    "outside": (broken(lambda d: d["buffers"][0].update(uri="a.bin")), "another file"),
    "no accessor": (broken(lambda d: d.update(accessors=[])), "damaged"),
    "circle": (broken(lambda d: d["nodes"][0].update(children=[0])), "inside itself"),
    "index": (glb(*square(corners=[0, 1, 7])), "index 7 has no point"),
    "nan": (glb(*square(points=SQUARE * np.float32("nan"))), "vertex 0"),
    "no mesh": (broken(lambda d: d["nodes"][0].pop("mesh")), "no triangles"),
}  # fmt: skip


@pytest.mark.parametrize(("data", "message"), BROKEN.values(), ids=BROKEN)
def test_what_cannot_be_read_is_said(read, data, message):
    with pytest.raises(InputError, match=message):
        read(data)
