# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line writes, and what it says of that."""

from __future__ import annotations

import json
import time
from pathlib import Path

from ...core.detection.report import detection_report, settings, summary
from ...core.detection.values import KINDS
from ...core.files.network import concatenate
from .. import installation
from ..wording import duration
from .figure import figure


def described(detected, parameters, kinds):
    """What the report of a completed network says of detection, None where nothing was detected."""
    if not detected:
        return None
    return {"scans": [summary(*_row(d)) for d in detected], "parameters": settings(parameters, kinds)}


def write_detected(detected, parameters, kinds, seconds, wanted, outputs, name) -> str:
    """Write the curves of all scans to what is asked for; a line about them.

    Parameters
    ----------
    detected : list of Detected
    wanted : name of an output -> its path
    outputs : Outputs, which has the temporary name of each path
    """
    began = time.perf_counter()
    if "curves" in wanted:
        _write_detected_curves(detected, outputs.part(wanted["curves"]))
    if "figure" in wanted:
        figure().draw_detected([d.found for d in detected], outputs.part(wanted["figure"]))
    if "out" in wanted:
        from . import blend_file

        blend_file.write_detected(detected, outputs.part(wanted["out"]), name)
    seconds["write"] = time.perf_counter() - began
    if "report" in wanted:
        rows = [_row(d) for d in detected]
        document = detection_report(rows, parameters, kinds, version=installation.version(), seconds=seconds)
        Path(outputs.part(wanted["report"])).write_text(json.dumps(document), encoding="utf-8")
    count = sum(len(d.found) for d in detected)
    return f"{count} feature curves; {duration(sum(seconds.values()))}"


def _row(detected):
    return detected.name, detected.vertices, detected.faces, detected.found


def _write_detected_curves(detected, path):
    """All curves as polylines, an object for each kind."""
    from ...core.files.obj import write_obj

    curves = concatenate([d.reading for d in detected]).curves
    rows = [(KINDS[kind], i) for i, kind in enumerate(kind for d in detected for kind in d.found.kind)]
    rows.sort()
    order = [i for _, i in rows]
    write_obj(path, [curves.curve(i) for i in order], curves.closed[order], [kind for kind, _ in rows])


def write(completion, document, reading, wanted, outputs, name):
    """Everything that is asked for of a completed network."""
    began = time.perf_counter()
    if "curves" in wanted:
        _write_curves(document, outputs.part(wanted["curves"]))
    if "figure" in wanted:
        figure().draw(document, reading.curves, outputs.part(wanted["figure"]))
    if "out" in wanted:
        from . import blend_file

        blend_file.write(completion, reading.curves, outputs.part(wanted["out"]), name)
    document["seconds"]["write"] = time.perf_counter() - began
    if "report" in wanted:
        Path(outputs.part(wanted["report"])).write_text(json.dumps(document), encoding="utf-8")


def _write_curves(document, path):
    from ...core.files.obj import write_obj

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
