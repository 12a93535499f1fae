# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF drawings read, and plans written as DXF and SVG."""

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.errors import InputError, NoCurves
from core.files.formats import read_curves
from core.files.readers.dxf import read_dxf
from core.files.reading import concatenate
from core.files.writers.dxf import write_dxf
from core.files.writers.plan import Plan, Stroke, Symbol, main_plane
from core.files.writers.svg import write_svg

ezdxf = pytest.importorskip("ezdxf")

FAR = np.array([4.5e5, 5.4e6, 120.0])


@pytest.fixture
def drawing(tmp_path):
    """An empty drawing, and what is read of it."""
    document = ezdxf.new("R2010")

    def read():
        document.saveas(tmp_path / "in.dxf")
        return read_dxf(tmp_path / "in.dxf")

    return document, read


def lines(reading):
    return [reading.curves.curve(i) for i in range(len(reading.curves))]


def test_lines_and_polylines_in_space(drawing):
    document, read = drawing
    space = document.modelspace()
    space.add_line((0, 0, 1), (3, 0, 1))
    space.add_polyline3d([(0, 0, 0), (1, 2, 3), (4, 5, 6)])
    space.add_polyline2d([(0, 0), (1, 0), (1, 1)], close=True)
    space.add_lwpolyline([(0, 0), (2, 0)], dxfattribs={"elevation": 5})
    found = lines(read())
    assert found[0].tolist() == [[0, 0, 1], [3, 0, 1]]
    assert found[1].tolist() == [[0, 0, 0], [1, 2, 3], [4, 5, 6]]
    assert found[2].tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]]
    assert found[3].tolist() == [[0, 0, 5], [2, 0, 5]]


def test_arcs_are_round(drawing):
    document, read = drawing
    space = document.modelspace()
    space.add_arc((1, 2), 3, 30, 120)
    space.add_circle((1, 2), 3)
    space.add_lwpolyline([(4, 2, 0, 0, 1), (-2, 2)], format="xyseb")  # a bulge of 1 is half a circle
    space.add_ellipse((1, 2), (3, 0), 1.0, 0, np.pi)
    for line, angle in zip(lines(read()), (90, 360, 180, 180)):
        assert np.linalg.norm(line[:, :2] - (1, 2), axis=1) == pytest.approx(3, abs=0.004)
        middle = (line[1:] + line[:-1])[:, :2] / 2
        assert np.linalg.norm(middle - (1, 2), axis=1) == pytest.approx(3, abs=0.008)
        length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        assert length == pytest.approx(3 * np.radians(angle), rel=2e-3)


def test_a_spline_runs_through_its_fit_points(drawing):
    document, read = drawing
    points = [(0, 0, 0), (1, 2, 0), (3, 1, 1), (4, 4, 2)]
    document.modelspace().add_spline(points)
    (line,) = lines(read())
    for point in points:
        assert np.linalg.norm(line - point, axis=1).min() < 0.02


def test_blocks_in_blocks_are_put_in(drawing):
    document, read = drawing
    inner, outer = document.blocks.new("A"), document.blocks.new("B")
    inner.add_line((0, 0), (1, 0))
    outer.add_blockref("A", (0, 1), dxfattribs={"rotation": 90})
    document.modelspace().add_blockref("B", (10, 0), dxfattribs={"xscale": 2, "yscale": 2, "zscale": 2})
    document.modelspace().add_blockref("A", (0, 0), dxfattribs={"column_count": 3, "column_spacing": 5})
    found = lines(read())
    assert np.allclose(found[0], [[10, 2, 0], [10, 4, 0]])
    assert [line[0, 0] for line in found[1:]] == [0, 5, 10]


def test_what_is_hidden_or_no_line_is_left_out_and_told(drawing):
    document, read = drawing
    document.layers.add("off").off()
    space = document.modelspace()
    space.add_line((0, 0), (1, 0))
    space.add_line((0, 0), (9, 0), dxfattribs={"layer": "off"})
    space.add_text("a window")
    reading = read()
    assert len(reading.curves) == 1
    assert reading.left_out == "1 TEXT, 1 hidden LINE"
    space.delete_entity(space[0])
    with pytest.raises(NoCurves, match="left out are 1 TEXT, 1 hidden LINE"):
        read()


def test_what_is_off_stays_hidden_inside_of_blocks_and_what_is_frozen_hides_them(drawing):
    document, read = drawing
    document.layers.add("frozen").freeze()
    document.layers.add("off").off()
    block = document.blocks.new("A")
    block.add_line((0, 0), (1, 0))  # on layer 0: it is on that of the INSERT
    block.add_line((0, 0), (0, 7), dxfattribs={"layer": "shown"})
    for layer in ("frozen", "off"):
        document.modelspace().add_blockref("A", (0, 0), dxfattribs={"layer": layer})
    reading = read()
    assert [line.tolist() for line in lines(reading)] == [[[0, 0, 0], [0, 7, 0]]]
    assert reading.left_out == "1 hidden INSERT, 1 hidden LINE"


def test_paper_space_is_no_part_and_other_drawings_are_named(drawing):
    document, read = drawing
    document.layout("Layout1").add_lwpolyline([(0, 0), (9, 9)])
    document.add_xref_def("other.dwg", "X")
    document.modelspace().add_blockref("X", (0, 0))
    document.modelspace().add_blockref("nowhere", (0, 0))
    with pytest.raises(NoCurves, match="1 INSERT of another drawing, 1 INSERT of no block; bind the other drawing"):
        read()
    document.modelspace().add_line((0, 0), (3, 0))
    assert len(lines(read())) == 1


@pytest.mark.parametrize("form", ["asc", "bin"])
@pytest.mark.parametrize("version", ["R12", "R2000", "R2018"])
def test_every_version_is_read_as_text_and_as_bytes(tmp_path, version, form):
    document = ezdxf.new(version)
    document.layers.add("T\u00fcren").off()
    space = document.modelspace()
    space.add_line((0, 0), (9, 0), dxfattribs={"layer": "T\u00fcren"})
    space.add_polyline2d([(0, 0, 1), (2, 0, 0)], format="xyb")
    inside = document.blocks.new("A", base_point=(1, 1))
    inside.add_line((1, 1), (2, 1))
    space.add_blockref("A", (5, 0), dxfattribs={"xscale": -2})
    document.saveas(tmp_path / "a.dxf", fmt=form)
    reading = read_dxf(tmp_path / "a.dxf")
    half, line = lines(reading)
    assert np.linalg.norm(half - (1, 0, 0), axis=1) == pytest.approx(1, abs=1e-3)
    assert np.allclose(line, [[5, 0, 0], [3, 0, 0]]) and reading.left_out == "1 hidden LINE"


def test_lines_and_an_arc_are_one_outline(drawing, tmp_path):
    document, _ = drawing
    space = document.modelspace()
    space.add_line((0, 2), (0, 0))
    space.add_line((2, 0), (0, 0))  # the other way round
    space.add_line((2, 0), (2, 2))
    space.add_arc((1, 2), 1, 0, 180)
    document.saveas(tmp_path / "a.dxf")
    read = read_curves([tmp_path / "a.dxf"])
    assert read.count == len(read.curves) == 1 and read.curves.closed[0]


def test_blocks_that_hold_themselves_end(drawing):
    document, read = drawing
    block = document.blocks.new("A")
    block.add_line((0, 0), (1, 0))
    block.add_blockref("A", (1, 0))
    document.modelspace().add_blockref("A", (0, 0))
    with pytest.raises(InputError, match="in a circle"):
        read()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"hello\n", "no DXF file"),
        (b"AC1032\0\0\0", "DWG"),
        (b"\0\1\2", "binary"),
        (b"  0\nSECTION\n", "cut off"),
        (b"hello\n  0\nEOF\n", "no DXF|damaged|no curves"),
    ],
)
def test_what_is_no_drawing_is_named(tmp_path, data, message):
    (tmp_path / "a.dxf").write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_dxf(tmp_path / "a.dxf")


def pose(rotation, place):
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation, place
    return out


def make_plan(poses, extra=(), deep=1):
    rng = np.random.default_rng(4)
    size = np.array([1, deep, 1])
    strokes = tuple(Stroke(size * rng.normal(size=(n, 3)), closed) for n, closed in ((5, False), (2, False), (4, True)))
    single = Stroke(FAR + size * rng.normal(size=(3, 3)), False)
    return Plan(
        {"template": (0.0, 0.0, 0.5), "strong": (0.2, 0.6, 1.0)},
        (Symbol("template_0", "template", strokes, np.array(poses)),),
        (("strong", single), *extra),
    )


def every_pose():
    rng = np.random.default_rng(1)
    turns = [np.eye(3), np.diag([1.0, -1, -1]), *Rotation.random(6, random_state=2).as_matrix()]
    return [pose(turn, FAR + rng.normal(0, 10, 3)) for turn in turns]


def test_a_block_for_each_template_and_an_insert_at_any_pose(tmp_path):
    plan = make_plan(every_pose())
    write_dxf(tmp_path / "a.dxf", plan)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert not document.audit().errors and document.units == 6
    space = document.modelspace()
    assert [len(space.query(kind)) for kind in ("INSERT", "POLYLINE")] == [8, 1]
    assert {e.dxf.name for e in space.query("INSERT")} == {"template_0"}
    assert {e.dxf.layer for e in space.query("INSERT")} == {"template"}
    assert {e.dxf.layer for e in space.query("POLYLINE")} == {"strong"}
    assert tuple(document.layers.get("strong").rgb) == (51, 153, 255)
    found = lines(read_dxf(tmp_path / "a.dxf"))
    wanted = [plan.strokes[0][1].points]
    for at in plan.symbols[0].poses:
        for stroke in plan.symbols[0].strokes:
            points = stroke.points @ at[:3, :3].T + at[:3, 3]
            wanted.append(np.r_[points, points[:1]] if stroke.closed else points)
    assert len(found) == len(wanted)
    assert max(np.abs(a - b).max() for a, b in zip(found, wanted)) < 1e-8  # the extent is 60, the places 5e6


@dataclass
class Primitive:
    """Any primitive: only what its kind asks for is there."""

    kind: str
    start: np.ndarray = None
    end: np.ndarray = None
    centre: np.ndarray = None
    radius: float = None
    normal: np.ndarray = None
    angle: float = None
    control: np.ndarray = None

    def beziers(self):
        return self.control[None]


def test_primitives_are_written_as_what_they_are(tmp_path):
    normal, along = np.array([1.0, 2, 2]) / 3, np.array([2.0, -2, 1]) / 3
    centre = FAR + (1, 2, 3)
    control = FAR + np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 1, 1.0)])
    pieces = (
        Primitive("line", start=FAR, end=FAR + 1, control=control),
        Primitive("arc", centre + 2 * along, None, centre, radius=2.0, normal=normal, angle=1.2, control=control),
        Primitive("circle", centre=centre, radius=1.5, normal=normal, control=control),
        Primitive("bezier", control=control),
    )
    plan = make_plan(every_pose()[:1], [("strong", Stroke(FAR + np.eye(3), False, pieces))])
    write_dxf(tmp_path / "a.dxf", plan)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert not document.audit().errors
    kinds = [e.dxftype() for e in document.modelspace()]
    assert kinds == ["POLYLINE", "LINE", "ARC", "CIRCLE", "SPLINE", "INSERT"]
    _, line, arc, circle, spline = lines(read_dxf(tmp_path / "a.dxf"))[:5]
    assert np.allclose(line, [FAR, FAR + 1], rtol=0, atol=1e-8)
    side = np.cross(normal, along)
    assert np.allclose(arc[0], centre + 2 * along, rtol=0, atol=1e-6)
    assert np.allclose(arc[-1], centre + 2 * (np.cos(1.2) * along + np.sin(1.2) * side), rtol=0, atol=1e-6)
    assert np.abs((circle - centre) @ normal).max() < 1e-6
    assert np.linalg.norm(circle - centre, axis=1) == pytest.approx(1.5, abs=2e-3)
    assert np.allclose(spline[[0, -1]], control[[0, 3]], rtol=0, atol=1e-8)
    write_svg(tmp_path / "a.svg", plan)
    paths = re.findall(r'<path d="([^"]*)"/>', (tmp_path / "a.svg").read_text())
    assert [re.sub("[^MLCZ]", "", path) for path in paths][-1] == "MLMCMCMC"


def drawn(path):
    """(symbols by name, uses, points (k, 2) of all paths in the picture) of an SVG."""
    root, names = ElementTree.parse(path).getroot(), "{http://www.w3.org/2000/svg}"

    def points(element):
        return np.array(re.findall(r"-?[\d.]+(?:e-?\d+)?", element.get("d")), float).reshape(-1, 2)

    symbols = {s.get("id"): [points(p) for p in s] for s in root.iter(names + "symbol")}
    uses, out = [], []
    for group in root.iter(names + "g"):
        for element in group:
            if element.tag == names + "path":
                out.append(points(element))
                continue
            uses.append(element.get("href")[1:])
            a, b, c, d, e, f = map(float, element.get("transform")[7:-1].split())
            out += [p @ np.array([[a, b], [c, d]]) + (e, f) for p in symbols[uses[-1]]]
    return symbols, uses, out


@pytest.mark.parametrize("flat", [True, False])
def test_a_symbol_for_each_template_and_a_use_at_each_place(tmp_path, flat):
    if flat:  # on one wall: shifted, turned and mirrored in it
        turns = [np.diag([1.0, 1, 1]), np.diag([-1.0, 1, -1]), Rotation.from_rotvec([0, 0.7, 0]).as_matrix()]
        poses = [pose(turns[i % 3], FAR + (3.0 * i, 0, i % 2)) for i in range(6)]
    else:
        poses = every_pose()
    plan = make_plan(poses, deep=not flat)
    write_svg(tmp_path / "a.svg", plan)
    symbols, uses, found = drawn(tmp_path / "a.svg")
    assert len(uses) == len(poses)
    assert len(symbols) == 1 if flat else len(symbols) > 1
    wanted = []
    for at in poses:
        wanted += [stroke.points @ at[:3, :3].T + at[:3, 3] for stroke in plan.symbols[0].strokes]
    wanted.append(plan.strokes[0][1].points)
    placed = plan.placed()
    middle, axes = (placed.min(axis=0) + placed.max(axis=0)) / 2, main_plane(placed)
    wanted = [(p - middle) @ axes.T * (1, -1) for p in wanted]
    sort = lambda points: points[np.lexsort(np.round(points, 3).T)]  # noqa: E731
    size = np.ptp(np.concatenate(wanted), axis=0).max()
    assert np.allclose(sort(np.concatenate(found)), sort(np.concatenate(wanted)), rtol=0, atol=2e-6 * size)


def test_a_plan_of_nothing_and_of_one_line(tmp_path):
    line = Stroke(np.array([[0, 0, 0], [0, 0, 2.0]]), False)
    for strokes in ((), (("strong", line),)):
        plan = Plan({"strong": (0.0, 0.0, 0.0)}, (), strokes)
        write_svg(tmp_path / "a.svg", plan)
        write_dxf(tmp_path / "a.dxf", plan)
        assert len(drawn(tmp_path / "a.svg")[2]) == len(strokes)
        assert len(ezdxf.readfile(tmp_path / "a.dxf").modelspace()) == len(strokes)


def test_the_unit_of_a_drawing_is_kept_and_two_are_refused(tmp_path):
    for name, units in (("mm", 4), ("m", 6), ("none", 0)):
        document = ezdxf.new(units=units)
        document.modelspace().add_line((0, 0), (1, 0))
        document.saveas(tmp_path / f"{name}.dxf")
    read = {name: read_dxf(tmp_path / f"{name}.dxf") for name in ("mm", "m", "none")}
    assert [r.units for r in read.values()] == [4, 6, 0]
    assert concatenate([read["mm"], read["none"]]).units == 4
    with pytest.raises(InputError, match="different units"):
        concatenate([read["mm"], read["m"]])
