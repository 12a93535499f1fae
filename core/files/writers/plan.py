# SPDX-License-Identifier: GPL-3.0-or-later
"""A plan is what DXF and SVG files are written from: symbols at their places, single strokes, coloured layers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Stroke:
    """A curve of a plan.

    points : (k, 3) float64; closed : the first point is not repeated
    primitives : lines, arcs, circles and Bezier segments in a row, drawn instead of the polyline where there are any.
        Each has a `kind` and `beziers()` (k, 4, 3); a "line" its `start` and `end`, an "arc" and a "circle" their
        `centre`, `radius` and `normal`, an arc also its `start` and its `angle` to the left about the normal
    """

    points: np.ndarray
    closed: bool
    primitives: tuple = ()


@dataclass(frozen=True)
class Symbol:
    """Strokes that stand at several places.

    name : for files
    poses : (a, 4, 4) float64, rigid, from the space of the strokes to the world
    """

    name: str
    layer: str
    strokes: tuple[Stroke, ...]
    poses: np.ndarray


@dataclass(frozen=True)
class Plan:
    """layers : name -> colour, RGB from 0 to 1; strokes : (layer, Stroke) each, in the world"""

    layers: dict
    symbols: tuple[Symbol, ...]
    strokes: tuple

    @property
    def count(self) -> int:
        """How many strokes are drawn, those of symbols at each of their places."""
        return len(self.strokes) + sum(len(symbol.strokes) * len(symbol.poses) for symbol in self.symbols)

    def placed(self) -> np.ndarray:
        """(n, 3) float64, all points in the world."""
        parts = [s.points for _, s in self.strokes]
        for symbol in self.symbols:
            points = np.concatenate([s.points for s in symbol.strokes])
            parts += [points @ pose[:3, :3].T + pose[:3, 3] for pose in symbol.poses]
        return np.concatenate(parts) if parts else np.zeros((0, 3))


def main_plane(points) -> np.ndarray:
    """(2, 3) float64, right and up in the main plane of points (n, 3), turned so that z is up if it can.

    Where the main plane is level, up is the second main axis.
    """
    centred = np.zeros((max(len(points), 3), 3))
    centred[: len(points)] = points - points.mean(axis=0)
    _, _, main = np.linalg.svd(centred, full_matrices=False)
    normal = main[2]
    up = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
    up = main[1] if np.linalg.norm(up) < 0.3 else up / np.linalg.norm(up)
    right = np.cross(up, normal)
    return np.stack([right, up])


def plan_of(completion, colours) -> Plan:
    """A completed network as a plan: a symbol for each template, and the strong curves.

    completion : Completion; its curves may have `primitives`
    colours : of the layers "template" and "strong"
    """
    symbols = tuple(
        Symbol(f"template_{t.id}", "template", tuple(map(_stroke, t.curves)), np.asarray(t.occurrences, float))
        for t in completion.templates
    )
    return Plan(dict(colours), symbols, tuple(("strong", _stroke(c)) for c in completion.strong))


def _stroke(curve) -> Stroke:
    return Stroke(np.asarray(curve.points, float), bool(curve.closed), tuple(getattr(curve, "primitives", None) or ()))
