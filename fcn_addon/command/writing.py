# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line writes, and what it says of that."""

from __future__ import annotations

import json
import time
from pathlib import Path

from ...core.detection.report import detection_report, settings, summary
from ...core.detection.values import KINDS
from ...core.files.reading import concatenate
from .. import colours, installation
from ..wording import duration
from .figure import figure

CURVE_FILES = (".obj", ".dxf", ".svg")
"""What --curves can write."""


def described(detected, parameters, kinds):
    """What the report of a completed network says of detection, None where nothing was detected."""
    if not detected:
        return None
    scans = [{**summary(*_row(d)), "remarks": list(d.remarks)} for d in detected]
    return {"scans": scans, "parameters": settings(parameters, kinds)}


def write_detected(detected, parameters, kinds, seconds, wanted, outputs, name, given) -> str:
    """Write the curves of all scans to what is asked for; a line about them.

    Parameters
    ----------
    detected : list of Detected
    wanted : name of an output -> its path
    outputs : Outputs, which has the temporary name of each path
    given : Inputs that they come from
    """
    began = time.perf_counter()
    if "curves" in wanted:
        _write_detected_curves(detected, outputs.part(wanted["curves"]))
    if "figure" in wanted:
        figure().draw_detected([d.found for d in detected], outputs.part(wanted["figure"]))
    if "out" in wanted:
        from . import blend_file

        blend_file.write_detected(detected, outputs.part(wanted["out"]), name, given.shift)
    seconds["write"] = time.perf_counter() - began
    if "report" in wanted:
        rows = [_row(d) for d in detected]
        document = detection_report(rows, parameters, kinds, version=installation.version(), seconds=seconds)
        document["left_out"] = given.left_out
        for row, d in zip(document["scans"], detected):
            row["remarks"] = list(d.remarks)
        Path(outputs.part(wanted["report"])).write_text(json.dumps(document), encoding="utf-8")
    count = sum(len(d.found) for d in detected)
    return f"{count} feature curves; {duration(sum(seconds.values()))}"


def _row(detected):
    return detected.name, detected.vertices, detected.faces, detected.found


def _write_detected_curves(detected, path):
    """All curves: polylines with an object for each kind, or a plan with a layer for each."""
    curves = concatenate([d.reading for d in detected]).curves
    rows = [(KINDS[kind], i) for i, kind in enumerate(kind for d in detected for kind in d.found.kind)]
    rows.sort()
    order = [i for _, i in rows]
    if _suffix(path) == ".obj":
        from ...core.files.writers.obj import write_obj

        write_obj(path, [curves.curve(i) for i in order], curves.closed[order], [kind for kind, _ in rows])
        return
    from ...core.files.writers.plan import Plan, Stroke

    layers = {kind: colour for kind, colour in zip(KINDS, colours.KINDS) if kind in {kind for kind, _ in rows}}
    strokes = tuple((kind, Stroke(curves.curve(i), bool(curves.closed[i]))) for kind, i in rows)
    _write_plan(Plan(layers, (), strokes), path)


def _write_plan(plan, path, units=0):
    if _suffix(path) == ".dxf":
        from ...core.files.writers.dxf import METRES, write_dxf

        write_dxf(path, plan, units=units or METRES)
    else:
        from ...core.files.writers.svg import write_svg

        write_svg(path, plan)


def _suffix(path) -> str:
    return Path(path).suffix.lower()


def write(completion, document, reading, wanted, outputs, name, shift=None, *, fitted, parameters):
    """Everything that is asked for of a completed network; `fitted` has its curves as primitives."""
    began = time.perf_counter()
    if "curves" in wanted:
        _write_curves(completion, fitted, document, reading.units, outputs.part(wanted["curves"]))
    if "figure" in wanted:
        figure().draw(document, reading.curves, outputs.part(wanted["figure"]))
    if "out" in wanted:
        from . import blend_file

        made = blend_file.Made(name, parameters)
        blend_file.write(completion, reading.curves, outputs.part(wanted["out"]), made, shift, fitted=fitted)
    document["seconds"]["write"] = time.perf_counter() - began
    if "report" in wanted:
        Path(outputs.part(wanted["report"])).write_text(json.dumps(document), encoding="utf-8")


def _write_curves(completion, fitted, document, units, path):
    if _suffix(path) != ".obj":
        from ...core.files.writers.plan import plan_of
        from ...core.fitting import drawn

        layers = {"template": colours.TEMPLATE, "strong": colours.STRONG}
        _write_plan(plan_of(drawn(completion, fitted), layers), path, units)
        return
    from ...core.files.writers.obj import write_obj

    curves = document["curves"]
    groups = [
        f"template_{c['template']}_occurrence_{c['occurrence']}" if c["kind"] == "template" else "strong"
        for c in curves
    ]
    write_obj(path, [c["points"] for c in curves], [c["closed"] for c in curves], groups)


def summary_line(document) -> str:
    templates, curves = document["templates"], document["curves"]
    occurrences = sum(len(t["occurrences"]) for t in templates)
    strong = sum(c["kind"] == "strong" for c in curves)
    return (
        f"{len(document['transformations'])} transformations, {len(templates)} templates at {occurrences} places, "
        f"{len(curves)} curves of which {strong} strong single ones; {duration(sum(document['seconds'].values()))}"
    )


def written(wanted) -> str:
    if not wanted:
        return "; nothing was written, --out, --curves, --report or --figure say where to"
    return "; wrote " + ", ".join(str(path) for path in wanted.values())
