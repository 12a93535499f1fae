# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of drawings: what is read equals what ezdxf puts in by itself, with the whole drawing in memory."""

import io
import re

import numpy as np
import pytest

from core.errors import InputError
from core.files.readers import dxf_held
from core.files.readers.dxf import read_dxf
from core.files.readers.dxf_space import CURVES, points_of

ezdxf = pytest.importorskip("ezdxf")

UP, DOWN, TILTED = (0, 0, 1), (0, 0, -1), (1, 2, 3)


def fill(block, rng, size=1.0, version="R2010"):
    """Add one of each kind of curve to a block, and some that are none."""
    flat, deep = (size * rng.normal(size=(2, 5, 3))).round(4)
    block.add_line(deep[0], deep[1])
    block.add_polyline2d([(*p[:2], 0.3) for p in flat], format="xyb", dxfattribs={"extrusion": DOWN})
    block.add_polyline3d(deep)
    block.add_arc(flat[0], size, 20, 250, dxfattribs={"extrusion": DOWN})
    block.add_circle(flat[1], size, dxfattribs={"extrusion": TILTED})
    block.add_text("text")
    block.add_polyline2d(flat[:, :2], close=True)
    if version != "R12":
        block.add_lwpolyline(flat[:, :2], dxfattribs={"elevation": 2, "extrusion": TILTED})
        block.add_lwpolyline([(*p[:2], 0, 0, -0.4) for p in flat])
        block.add_spline(deep)
        block.add_ellipse(flat[2], (2 * size, 0, 0), 0.4, 0.5, 4)
        block.add_hatch().paths.add_polyline_path(flat[:, :2])
        block.add_mtext("words")


def make(version="R2010"):
    """A drawing with blocks in every way."""
    document, rng = ezdxf.new(version, setup=True), np.random.default_rng(3)
    document.layers.add("off").off()
    document.layers.add("frozen").freeze()
    document.layers.add("shown")
    one = document.blocks.new("one", base_point=(1, 2, 0.5))
    fill(one, rng, version=version)
    for layer in ("off", "frozen", "shown"):
        one.add_line((0, 0), (1, 1, 1), dxfattribs={"layer": layer})
    one.add_line((0, 0), (7, 7), dxfattribs={"invisible": 1} if version != "R12" else {"layer": "off"})
    two = document.blocks.new("TWO")
    two.add_blockref("ONE", (3, 1), dxfattribs={"rotation": 25, "layer": "shown"})
    two.add_blockref("one", (3, 1), dxfattribs={"layer": "frozen"})
    two.add_line((0, 0), (1, 0))
    two.add_blockref("one", (0, 5), dxfattribs={"yscale": -1, "layer": "off"})
    two.add_auto_blockref("one", (1, 1), {}) if version != "R12" else None
    three = document.blocks.new("three", base_point=(-4, 0))
    three.add_blockref("two", (1, 1), dxfattribs={"xscale": 2, "yscale": 2, "zscale": 2, "extrusion": DOWN})
    three.add_blockref(
        "one", (9, 9), dxfattribs={"row_count": 2, "column_count": 2, "row_spacing": 4, "column_spacing": 5}
    )
    three.add_blockref("nowhere", (0, 0))
    document.blocks.new("empty")
    space = document.modelspace()
    document.blocks.new("unused").add_line((0, 0), (1, 0))
    turns = (
        {},
        {"xscale": -1, "yscale": 1.5, "zscale": 0.5, "rotation": 40},
        {"extrusion": DOWN, "xscale": -2},
        {"extrusion": TILTED, "rotation": 70},
    )
    names = ("one", "one", "One", "one", "two", "TWO", "two", "three", "empty", "nowhere")
    for i, name in enumerate(names):
        at = tuple((100 * rng.normal(size=3)).round(3))
        layer = ("0", "shown", "off")[i % 3]
        space.add_blockref(name, at, dxfattribs={"layer": layer, **turns[i % 4]})
        space.add_line(at, (0, 0, 0))
    grid = {"row_count": 2, "column_count": 2, "row_spacing": 50, "column_spacing": 0, "rotation": 30}
    space.add_blockref("two", (0, 0), dxfattribs=grid)
    space.add_blockref("one", (5, 5)).add_attrib("TAG", "value", (5, 6))
    space.add_blockref("one", (6, 5), dxfattribs={"layer": "frozen"})
    space.add_blockref("one", (7, 5))
    space.add_linear_dim((0, 2), (0, 0), (4, 0)).render()
    one.add_linear_dim((0, 2), (0, 0), (4, 0)).render()
    paper = document.layout("Layout1") if version != "R12" else document.paperspace()
    paper.add_blockref("one", (0, 0))
    if version != "R12":
        document.layouts.new("Other").add_blockref("two", (0, 0))
    return document


def drawn(document):
    """The lines of a drawing as ezdxf puts its blocks in: first those of no block."""
    off = {layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()}
    frozen = {layer.dxf.name.lower() for layer in document.layers if layer.is_frozen()}

    def inside(entities, home):
        for entity in entities:
            layer = entity.dxf.get("layer", "0").lower()
            layer = home if layer == "0" else layer
            name = entity.dxftype()
            if entity.dxf.get("invisible", 0) or layer in (frozen if name == "INSERT" else off):
                continue
            if name == "INSERT" and entity.block() is not None:
                for single in entity.multi_insert() if entity.mcount > 1 else [entity]:
                    yield from inside(single.virtual_entities(), layer)
            elif name in CURVES:
                yield points_of(entity)

    space = document.modelspace()
    return [
        *inside((e for e in space if e.dxftype() != "INSERT"), "0"),
        *inside((e for e in space if e.dxftype() == "INSERT"), "0"),
    ]


def assert_same(path):
    """Assert that a file is read as ezdxf draws it, to the last bit."""
    wanted = drawn(ezdxf.readfile(path))
    reading = read_dxf(path)
    found = [reading.curves.curve(i) for i in range(len(reading.curves))]
    assert len(found) == len(wanted) > 0
    assert all(np.array_equal(a, b) for a, b in zip(found, wanted))
    return reading


@pytest.mark.parametrize("form", ["asc", "bin"])
@pytest.mark.parametrize("version", ["R12", "R2000", "R2018"])
def test_blocks_are_put_in_as_ezdxf_does(tmp_path, version, form):
    make(version).saveas(tmp_path / "a.dxf", fmt=form)
    reading = assert_same(tmp_path / "a.dxf")
    told = dict(reversed(part.split(" ", 1)) for part in reading.left_out.split(", "))
    assert int(told["INSERT of no block"]) > 0 and int(told["hidden INSERT"]) > 0 and int(told["TEXT"]) > 0


@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_any_line_end_is_read(tmp_path, end):
    make().saveas(tmp_path / "a.dxf")
    wanted = read_dxf(tmp_path / "a.dxf").curves.points
    data = re.sub(rb"\r?\n", end, (tmp_path / "a.dxf").read_bytes())
    (tmp_path / "b.dxf").write_bytes(data)
    assert np.array_equal(read_dxf(tmp_path / "b.dxf").curves.points, wanted)


@pytest.mark.parametrize("sizes", [(1, 0), (1, 10**6), (50, 300)])
def test_the_size_of_pieces_and_what_is_kept_ready_change_nothing(tmp_path, monkeypatch, sizes):
    make().saveas(tmp_path / "a.dxf")
    wanted = read_dxf(tmp_path / "a.dxf")
    monkeypatch.setattr(dxf_held, "PIECE", sizes[0])
    monkeypatch.setattr(dxf_held, "READY", sizes[1])
    reading = assert_same(tmp_path / "a.dxf")
    assert np.array_equal(reading.curves.points, wanted.curves.points) and reading.left_out == wanted.left_out


def text_of(document):
    out = io.StringIO()
    document.write(out)
    return out.getvalue()


def simple():
    """A drawing with a line in a block, and its text."""
    document = ezdxf.new()
    block = document.blocks.new("A")
    block.add_line((1, 2, 3), (4, 5, 6))
    document.modelspace().add_blockref("A", (10, 0))
    return document, block


def test_the_order_of_group_codes_does_not_matter(tmp_path):
    text = text_of(simple()[0])
    points = " 10\n1.0\n 20\n2.0\n 30\n3.0\n", " 11\n4.0\n 21\n5.0\n 31\n6.0\n"
    assert "".join(points) in text
    (tmp_path / "a.dxf").write_text(text.replace("".join(points), points[1] + "999\na remark\n" + points[0]))
    assert assert_same(tmp_path / "a.dxf").curves.points.tolist() == [[11, 2, 3], [14, 5, 6]]
    (tmp_path / "a.dxf").write_text(text.replace("".join(points), points[0].replace(" 30\n3.0\n", "") + points[1]))
    assert assert_same(tmp_path / "a.dxf").curves.points.tolist() == [[11, 2, 0], [14, 5, 6]]


def test_data_of_programs_and_points_in_blocks_are_passed_over(tmp_path):
    document, block = simple()
    block[0].set_xdata("ACAD", [(1000, "held 0"), (1010, (1, 2, 3)), (1004, b"\1\2")])
    block[0].set_app_data("{MINE", [(330, "FEFE"), (5, "FF")])
    block[0].new_extension_dict()
    block.add_point((0, 0), dxfattribs={"layer": "held 0"})
    document.modelspace().add_point((0, 0), dxfattribs={"layer": "held 1"})
    document.saveas(tmp_path / "a.dxf")
    assert assert_same(tmp_path / "a.dxf").left_out == "2 POINT"


def test_inserts_of_paper_space_between_others_stay_there(tmp_path):
    document, _ = simple()
    document.modelspace().add_blockref("A", (20, 0)).add_attrib("T", "x", (0, 0))
    document.modelspace().add_blockref("A", (30, 0))
    text = text_of(document)
    parts = re.split(r"(?=  0\nINSERT\n)", text)
    owner = document.paperspace().block_record_handle
    parts[2] = re.sub(r"330\n\w+", f"330\n{owner}", parts[2], count=1)
    (tmp_path / "a.dxf").write_text("".join(parts))
    assert assert_same(tmp_path / "a.dxf").curves.points[:, 0].tolist() == [11, 14, 31, 34]


def test_a_polyline_in_a_block_without_its_end_is_damage(tmp_path):
    document, block = simple()
    block.add_polyline3d([(0, 0, 0), (1, 1, 1), (2, 0, 0)])
    text = text_of(document)
    begin = text.index("  0\nSEQEND")
    (tmp_path / "a.dxf").write_text(text[:begin] + text[text.index("  0\nENDBLK", begin) :])
    with pytest.raises(InputError, match="Expected DXF entity ENDBLK or SEQEND"):
        read_dxf(tmp_path / "a.dxf")


@pytest.mark.parametrize("name", ["A", "unused"])
def test_damage_in_a_block_is_found_though_it_is_not_put_in(tmp_path, name):
    document, block = simple()
    document.blocks.new("unused").add_line((0, 0), (7, 7))
    text = text_of(document)
    line = text.index("  0\nLINE", text.index(f"  2\n{name}\n", text.index("  2\nBLOCKS\n")))
    handle = re.compile(r"  5\n\w+\n").search(text, line)
    (tmp_path / "a.dxf").write_text(text[: handle.start()] + "  5\nnone\n" + text[handle.end() :])
    with pytest.raises(ValueError, match="Invalid handle"):
        ezdxf.readfile(tmp_path / "a.dxf")
    reading = read_dxf(tmp_path / "a.dxf")
    assert reading.curves.points.tolist() == [[11, 2, 3], [14, 5, 6]]


def test_a_circle_of_blocks_that_is_not_put_in_is_no_error(tmp_path):
    document, block = simple()
    one, two = document.blocks.new("B"), document.blocks.new("C")
    one.add_blockref("C", (0, 0))
    two.add_blockref("B", (0, 0))
    document.saveas(tmp_path / "a.dxf")
    assert len(assert_same(tmp_path / "a.dxf").curves) == 1
    document.modelspace().add_blockref("C", (0, 0))
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(InputError, match="in a circle"):
        read_dxf(tmp_path / "a.dxf")
