# SPDX-License-Identifier: GPL-3.0-or-later
"""A completion as the JSON document `fcn-report/1`; docs/report.md describes it."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from .fitting import FittedCompletion, fit_completion
from .parameters import Parameters
from .stages import STAGES
from .values import Completion, Curves, InputClasses

SCHEMA = "fcn-report/1"


def report(
    completion: Completion,
    curves: Curves,
    *,
    version: str,
    parameters: Parameters,
    fitted: FittedCompletion | None = None,
    count=None,
    shares=None,
    seconds=None,
):
    """The report as a dict of plain Python values.

    Parameters
    ----------
    curves : what was completed; its `source` relates the classes to the input curves
    version : of this program
    parameters : what it was run with
    fitted : the completed curves as primitives; made here if None
    count : number of input curves, where the last of them left no curve; from `curves.source` if None
    shares : of the reading, where input curves were joined; from `curves.source` if None
    seconds : more times, of what is done outside the method ("read", "detect", "write")
    """
    count = int(curves.source.max(initial=-1)) + 1 if count is None else count
    times = {**dict.fromkeys(("read", "detect", *STAGES, "write"), 0.0), **completion.seconds, **(seconds or {})}
    fitted = fit_completion(completion, curves, smoothing=parameters.smoothing) if fitted is None else fitted
    work = {name: int(value) for name, value in completion.work.items()}
    return {
        "schema": SCHEMA,
        "version": version,
        "input": {
            "curves": count,
            "samples": len(curves.points),
            "edge_length": float(completion.edge_length),
            "noise": float(fitted.sigma),
        },
        "parameters": asdict(parameters),
        "seconds": {name: float(value) for name, value in times.items()},
        "work": work,
        "transformations": [_transformation(t) for t in completion.transformations],
        "templates": [_template(t) for t in completion.templates],
        "curves": [*_template_curves(completion.templates, fitted), *_strong_curves(completion.strong, fitted)],
        "inputs": _inputs(classes_of_inputs(completion.inputs, curves, count, shares)),
    }


def classes_of_inputs(classes: InputClasses, curves: Curves, count: int, shares=None) -> InputClasses:
    """Classes of the input curves from those of the curves.

    An input curve that was cut has the class that most of its length has. One that left no length is noise. `shares`
    (`core.files.reading.Shares`) says what became of each where they were joined.
    """
    if shares is None:
        rows = zip(range(len(curves)), curves.source.tolist(), lengths(curves).tolist())
    else:
        rows = zip(shares.curve.tolist(), shares.line.tolist(), shares.length.tolist())
    pieces = {}
    for piece, source, length in rows:
        label = str(classes.kind[piece]), int(classes.transformation[piece]), int(classes.component[piece])
        found = pieces.setdefault(source, {})
        found[label] = found.get(label, 0.0) + length
    none = "noise", -1, -1
    best = [max(pieces[i].items(), key=lambda item: item[1])[0] if i in pieces else none for i in range(count)]
    kind, transformation, component = zip(*best) if best else ((), (), ())
    return InputClasses(np.array(kind, dtype=str), np.array(transformation, np.int64), np.array(component, np.int64))


def lengths(curves: Curves) -> np.ndarray:
    """(m,) float64, the length of each curve in scene units, with its closing edge."""
    if len(curves) == 0:
        return np.zeros(0)
    step = np.linalg.norm(np.diff(curves.points, axis=0), axis=1)
    along = np.r_[0.0, np.cumsum(step)]
    first, last = curves.offsets[:-1], curves.offsets[1:] - 1
    gap = np.linalg.norm(curves.points[last] - curves.points[first], axis=1)
    return along[last] - along[first] + np.where(curves.closed, gap, 0.0)


def moved(points, motion) -> np.ndarray:
    """(k, 3) float64, points under a (4, 4) rigid motion."""
    return points @ motion[:3, :3].T + motion[:3, 3]


def _transformation(t) -> dict:
    return {
        "id": int(t.id),
        "kind": t.kind,
        "generators": np.asarray(t.generators, float).tolist(),
        "extent": np.asarray(t.extent).astype(int).tolist(),
        "log_bayes_factor": float(t.log_bayes_factor),
        "support": float(t.support),
        "e_value": float(t.e_value),
    }


def _template(t) -> dict:
    return {
        "id": int(t.id),
        "transformation": int(t.transformation),
        "components": sorted({int(c.component) for c in t.curves if c.component >= 0}),
        "occurrences": np.asarray(t.occurrences, float).tolist(),
    }


def _template_curves(templates, fitted):
    for t, drawn in zip(templates, fitted.templates):
        for occurrence, motion in enumerate(t.occurrences):
            for curve, support, fit in zip(t.curves, t.evidence[occurrence], drawn):
                yield {
                    "points": moved(curve.points, motion).tolist(),
                    "closed": bool(curve.closed),
                    "kind": "template",
                    "template": int(t.id),
                    "component": _label(curve.component),
                    "occurrence": occurrence,
                    "support": float(support),
                    "primitives": [primitive(p.moved(motion)) for p in fit.primitives],
                    "deviation": fit.deviation,
                }


def _strong_curves(curves, fitted):
    for curve, fit in zip(curves, fitted.strong):
        yield {
            "points": np.asarray(curve.points, float).tolist(),
            "closed": bool(curve.closed),
            "kind": "strong",
            "template": None,
            "component": None,
            "occurrence": None,
            "support": float(curve.support),
            "primitives": [primitive(p) for p in fit.primitives],
            "deviation": fit.deviation,
        }


def primitive(p) -> dict:
    """A line, arc, circle or Bezier segment as plain values."""
    names = {
        "line": ("start", "end"),
        "arc": ("start", "middle", "end", "centre", "normal", "radius", "angle"),
        "circle": ("centre", "normal", "radius", "start"),
        "bezier": ("start", "first", "second", "end"),
    }
    return {"type": p.kind, **{name: np.asarray(getattr(p, name), float).tolist() for name in names[p.kind]}}


def _inputs(classes):
    rows = zip(classes.kind, classes.transformation, classes.component)
    return [
        {"kind": str(kind), "transformation": _label(transformation), "component": _label(component)}
        for kind, transformation, component in rows
    ]


def _label(label):
    """A label, None for none: JSON has null for it."""
    return int(label) if label >= 0 else None
