# SPDX-License-Identifier: GPL-3.0-or-later
"""A completed network leaves as what it is drawn with: in the report, and in a drawing."""

import numpy as np
import pytest

from core.files.writers.dxf import write_dxf
from core.files.writers.plan import plan_of
from core.files.writers.svg import write_svg
from core.fitting import drawn, fit_completion
from core.parameters import Parameters
from core.report import report
from core.values import CompletedCurve, Completion, Curves, InputClasses, Template, Transformation

EDGE = 0.05
TURN = np.arange(0, 2 * np.pi, EDGE)
RING = np.stack([np.cos(TURN), 0 * TURN, np.sin(TURN)], axis=1)
SIDE = np.arange(0, 3, EDGE)[:, None] * [1.0, 0, 0]
FRAME = np.concatenate([SIDE, [3.0, 0, 0] + np.arange(0, 2, EDGE)[:, None] * [0, 0, 1.0]])


@pytest.fixture
def completion():
    """Half a circle, a corner and a circle at two places, the second turned; and a straight line."""
    parts = [(RING[:63], False), (FRAME + [2, 0, 0], False), (0.5 * RING + [0, 0, 4], True)]
    curves = tuple(CompletedCurve(p, closed, i, 1.0) for i, (p, closed) in enumerate(parts))
    places = np.array([np.eye(4), [[0, -1, 0, 9], [1, 0, 0, 2], [0, 0, 1, 1], [0, 0, 0, 1]]], float)
    step = Transformation(0, "single", places[1:], np.array([[0, 1]]), 10.0, 1.0)
    template = Template(0, 0, curves, places, np.ones((2, 3)))
    classes = InputClasses(np.array(["template"] * 6), np.zeros(6, np.int64), np.zeros(6, np.int64))
    return Completion(EDGE, (step,), (template,), (CompletedCurve(SIDE - 9, False, -1, 1.0),), classes, {}, {})


def test_lines_arcs_and_circles_go_out_as_such(completion, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    (template,) = completion.templates
    curves = Curves.from_list(
        [c.points @ m[:3, :3].T + m[:3, 3] for m in template.occurrences for c in template.curves],
        [c.closed for _ in template.occurrences for c in template.curves],
    )
    fitted = fit_completion(completion, curves, smoothing=0.0)
    said = report(completion, curves, version="1", parameters=Parameters(), fitted=fitted)["curves"]
    kinds = [[piece["type"] for piece in curve["primitives"]] for curve in said]
    assert kinds == [["arc"], ["line", "line"], ["circle"]] * 2 + [["line"]]
    assert [said[i]["primitives"][0]["radius"] for i in (0, 2, 3, 5)] == pytest.approx([1, 0.5] * 2, abs=1e-3)

    plan = plan_of(drawn(completion, fitted), {"template": (0, 0, 1), "strong": (0, 1, 1)})
    write_dxf(tmp_path / "out.dxf", plan)
    document = ezdxf.readfile(tmp_path / "out.dxf")
    inserts = document.modelspace().query("INSERT")
    assert [e.dxftype() for e in document.blocks[inserts[0].dxf.name]] == ["ARC", "LINE", "LINE", "CIRCLE"]
    assert len(inserts) == 2 and [e.dxftype() for e in document.modelspace()].count("LINE") == 1
    for insert, there in zip(inserts, (said[:3], said[3:])):
        arc = next(e for e in insert.virtual_entities() if e.dxftype() == "ARC")
        ends = np.array([arc.start_point.xyz, arc.end_point.xyz])
        assert np.allclose(ends, [there[0]["primitives"][0][end] for end in ("start", "end")], atol=1e-9)
    write_svg(tmp_path / "out.svg", plan)
    assert (tmp_path / "out.svg").read_text().count(" C") >= 4
