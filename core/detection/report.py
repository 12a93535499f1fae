# SPDX-License-Identifier: GPL-3.0-or-later
"""What was detected as plain Python values, for JSON; docs/report.md describes it."""

from __future__ import annotations

from dataclasses import asdict

from .parameters import DetectionParameters
from .values import KINDS, FeatureCurves

SCHEMA = "fcn-detection/1"


def summary(name: str, vertices: int, faces: int, found: FeatureCurves) -> dict:
    """What one scan gave, without its curves."""
    counts = {kind: int((found.kind == i).sum()) for i, kind in enumerate(KINDS)}
    return {
        "name": name,
        "vertices": int(vertices),
        "faces": int(faces),
        "edge_length": float(found.edge_length),
        "detail": float(found.detail),
        "curves": len(found),
        "kinds": counts,
        "length": float(found.length.sum()),
    }


def settings(parameters: DetectionParameters, kinds: dict) -> dict:
    """Every parameter by name, and which kinds were asked for."""
    return {**asdict(parameters), **{name: bool(wanted) for name, wanted in kinds.items()}}


def detection_report(scans, parameters: DetectionParameters, kinds: dict, *, version: str, seconds: dict) -> dict:
    """The document of detection alone.

    Parameters
    ----------
    scans : (name, vertices, faces, FeatureCurves) of each
    kinds : of ridges, valleys, sharp and boundary -> bool
    """
    return {
        "schema": SCHEMA,
        "version": version,
        "parameters": settings(parameters, kinds),
        "seconds": {name: float(value) for name, value in seconds.items()},
        "scans": [summary(*scan) for scan in scans],
        "curves": [curve for i, (_, _, _, found) in enumerate(scans) for curve in _curves(i, found)],
    }


def _curves(scan, found):
    c = found.curves
    for i in range(len(found)):
        yield {
            "scan": scan,
            "kind": KINDS[found.kind[i]],
            "closed": bool(c.closed[i]),
            "length": float(found.length[i]),
            "mean_strength": float(found.mean_strength[i]),
            "mean_fold": float(found.mean_fold[i]),
            "points": c.curve(i).tolist(),
            "strength": c.strength[c.offsets[i] : c.offsets[i + 1]].tolist(),
        }
