# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading takes little more memory than the file: three times its size beside a fixed base, the result included."""

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]

BASE = 30e6
"""Bytes: a block of text as words, above all."""

SIZE = 400

PROGRAM = """
import sys
from core.files import formats
from core.files.readers import dxf, obj, ply, ridges, stl  # so that what they import is not counted
if sys.argv[1].endswith(".dxf"):
    import ezdxf.document, ezdxf.path
read = formats.read_lines if sys.argv[2] == "lines" else formats.read_surface
def peak():  # of this program; getrusage begins with that of the process that started it
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))
before = peak()
found = read(sys.argv[1])
print(peak() - before)
"""


@pytest.fixture(scope="module")
def mesh():
    """Points (n, 3) and triangles (m, 3) of a wavy sheet."""
    x, y = np.meshgrid(np.arange(SIZE) * 0.1, np.arange(SIZE) * 0.1, indexing="ij")
    points = np.c_[x.ravel(), y.ravel(), np.sin(x.ravel())]
    a = (np.arange(SIZE - 1)[:, None] * SIZE + np.arange(SIZE - 1)).ravel()
    return points, np.concatenate([np.c_[a, a + SIZE, a + SIZE + 1], np.c_[a, a + SIZE + 1, a + 1]])


def rows(form, values):
    return "".join(form % tuple(row) for row in values.tolist()).encode()


def obj(points, faces):
    return rows("v %.6f %.6f %.6f\n", points) + rows("f %d/1 %d/1 %d/1\n", faces + 1)


def obj_lines(points, faces):
    return rows("v %.6f %.6f %.6f\n", points) + rows("l %d %d\n", faces[:, :2] + 1)


def header(form, points, faces):
    lines = ["ply", f"format {form} 1.0", f"element vertex {len(points)}", *(f"property double {c}" for c in "xyz")]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(lines).encode()


def ascii_ply(points, faces):
    return header("ascii", points, faces) + rows("%.6f %.6f %.6f\n", points) + rows("3 %d %d %d\n", faces)


def binary_ply(points, faces):
    table = np.zeros(len(faces), [("n", "u1"), ("i", "<i4", 3)])
    table["n"], table["i"] = 3, faces
    return header("binary_little_endian", points, faces) + points.astype("<f8").tobytes() + table.tobytes()


def binary_stl(points, faces):
    table = np.zeros(len(faces), [("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    table["c"] = points[faces]
    return b" " * 80 + np.uint32(len(faces)).tobytes() + table.tobytes()


def ascii_stl(points, faces):
    corner = "vertex %.6f %.6f %.6f\n"
    form = f"facet normal 0 0 1\nouter loop\n{3 * corner}endloop\nendfacet\n"
    return b"solid x\n" + rows(form, points[faces[:80_000]].reshape(-1, 9)) + b"endsolid x\n"


def ridge_lines(points, faces):
    lines = np.tile(points, (2, 1)).reshape(-1, 3 * 40)
    return b"".join(b"4 1.25 0.5 " + b" ".join(b"%.6f" % v for v in line) + b"\n" for line in lines.tolist())


def crest_lines(points, faces):
    count = 200_000
    edges = np.c_[faces[:count, :2], np.arange(count)]
    head = f"{len(points)}\n{count}\n1\n".encode()
    return head + rows("%.6f %.6f %.6f 0\n", points) + b"12.0 0.9 3.0\n" + rows("%d %d %d\n", edges)


def polylines(points, faces):
    lines = np.tile(points, (2, 1)).reshape(-1, 3 * 40)
    return b"".join(b"40 " + b" ".join(b"%.6f" % v for v in line) + b"\n" for line in lines.tolist())


LINE = "  0\nLINE\n  5\n%X\n330\n1F\n100\nAcDbEntity\n  8\n0\n100\nAcDbLine\n" + "".join(
    f" {code}\n%.6f\n" for code in (10, 20, 30, 11, 21, 31)
)


def drawing(points, faces):
    ezdxf = pytest.importorskip("ezdxf")
    out = io.StringIO()
    ezdxf.new().write(out)
    head, _, tail = out.getvalue().partition("  2\nENTITIES\n")
    entities = (LINE % (65536 + i, *row) for i, row in enumerate(points[faces[:60_000, :2]].reshape(-1, 6).tolist()))
    return (head + "  2\nENTITIES\n" + "".join(entities) + tail).encode()


INSERT = "  0\nINSERT\n  5\n%X\n330\n1F\n100\nAcDbEntity\n  8\n0\n100\nAcDbBlockReference\n  2\n%s\n" + "".join(
    f" {code}\n%.6f\n" for code in (10, 20, 30)
)


def drawing_of_blocks(points, faces):
    """Lines in a block that is in another, and a small block at many places."""
    ezdxf = pytest.importorskip("ezdxf")
    out, document = io.StringIO(), ezdxf.new()
    for name in ("small", "inner", "outer"):
        document.blocks.new(name).add_point((0, 0), dxfattribs={"layer": name})
    document.write(out)
    text = out.getvalue()
    lines = [LINE % (65536 + i, *row) for i, row in enumerate(points[faces[:64_000, :2]].reshape(-1, 6).tolist())]
    places = [INSERT % (262144 + i, "small", *row) for i, row in enumerate(points[:12_000].tolist())]
    held = {"small": "".join(lines[:2]), "inner": "".join(lines), "outer": INSERT % (131072, "inner", 1, 2, 3)}
    for name, entities in held.items():
        begin = text.rindex("  0\nPOINT", 0, text.index(f"  8\n{name}\n"))
        text = text[:begin] + entities + text[text.index("  0\nENDBLK", begin) :]
    head, _, tail = text.partition("  2\nENTITIES\n")
    return (head + "  2\nENTITIES\n" + INSERT % (131073, "outer", 0, 0, 0) + "".join(places) + tail).encode()


KINDS = [
    (obj, "a.obj", "surface"), (obj_lines, "l.obj", "lines"), (ascii_ply, "a.ply", "surface"),
    (ridge_lines, "a.txt", "lines"), (crest_lines, "ridges.txt", "lines"), (polylines, "a.cgal", "lines"),
    (drawing, "a.dxf", "lines"), (binary_ply, "b.ply", "surface"),
    (binary_stl, "b.stl", "surface"), (ascii_stl, "a.stl", "surface"),
]  # fmt: skip


def peak_of(path, what):
    """Bytes that reading a file takes in a process of its own, beside what its modules take."""
    command = [sys.executable, "-c", PROGRAM, str(path), what]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=200, check=True)
    return 1024 * int(done.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is asked in Linux's way")
@pytest.mark.parametrize(("make", "name", "what"), KINDS, ids=[kind[0].__name__ for kind in KINDS])
def test_reading_takes_three_times_the_file_at_most(mesh, tmp_path, make, name, what):
    path = tmp_path / name
    path.write_bytes(make(*mesh))
    size = path.stat().st_size
    assert size > 7e6
    peak = peak_of(path, what)
    assert size / 2 < peak < 3 * size + BASE, f"{(peak - BASE) / size:.1f} times the file"


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is asked in Linux's way")
def test_what_is_in_blocks_takes_no_more(mesh, tmp_path):
    path = tmp_path / "a.dxf"
    path.write_bytes(drawing_of_blocks(*mesh))
    size = path.stat().st_size
    assert size > 9e6
    peak = peak_of(path, "lines")
    assert size / 2 < peak < 3.5 * size, f"{peak / size:.1f} times the file"
