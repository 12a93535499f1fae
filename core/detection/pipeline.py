# SPDX-License-Identifier: GPL-3.0-or-later
"""From a mesh to its feature curves: the stages in their order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import InputError
from ..values import Curves
from .curvature.tensor import Curvature, curvature
from .lines.extremality import Extremality, crest_lines
from .lines.hysteresis import clear_segments, without_faint_tails
from .lines.junctions import met
from .lines.lines import Lines, weights
from .lines.linking import linked
from .lines.merging import without_doubles, without_spurs
from .lines.sharp import boundary_lines, sharp_lines
from .lines.surface import Surface
from .mesh.memory import room_for
from .mesh.mesh import TriangleMesh
from .parameters import DetectionParameters
from .scale import curvature_at_own_scale
from .values import BOUNDARY, RIDGE, SHARP, VALLEY, FeatureCurves

DEFAULTS = DetectionParameters()

_ITERATIONS = 60
"""About how often smoothing calls back at the default detail; only the progress shown depends on it."""

_ALONG_GAPS = 0.6
"""Share of the weak fold that the surface must be bent by on average along a gap. On example scans bridges that follow
a crease have 0.7 and mostly more than 2, those between things that only face each other 0.2 to 0.6."""

_STEPS = 15
"""About how often the lines of one kind call back; the same holds."""


def detect(
    mesh: TriangleMesh,
    *,
    detail: float | None = None,
    ridges: bool = True,
    valleys: bool = True,
    sharp: bool = False,
    boundary: bool = False,
    parameters: DetectionParameters = DEFAULTS,
    field: Curvature | None = None,
    progress=None,
) -> FeatureCurves:
    """Feature curves of a triangle mesh.

    Parameters
    ----------
    mesh : made with `TriangleMesh.of(vertices, faces)`
    detail : smoothing scale in edge lengths, 0 to choose it from the scan; given here it replaces `parameters.detail`
    ridges, valleys, sharp, boundary : the kinds to look for
    field : the result of `measure` for this mesh and detail, to try other thresholds without measuring again
    progress : called as progress(stage, fraction) with the stages "curvature" and "lines"; may raise Cancelled

    Raises
    ------
    InputError
        a parameter out of its bounds, no kind asked for, a field of another mesh, too little memory

    Notes
    -----
    Near linear in the number of faces, about 0.6 KB a face.
    """
    if detail is not None:
        parameters = replace(parameters, detail=detail)
    parameters.validate()
    if not (ridges or valleys or sharp or boundary):
        raise InputError("no kind of curve is asked for: choose ridges, valleys, sharp edges or boundaries")
    if field is not None and len(field.high) != len(mesh.vertices):
        raise InputError(f"the field has {len(field.high)} values for {len(mesh.vertices)} vertices: measure this mesh")
    kinds = [k for k, wanted in ((RIDGE, ridges), (VALLEY, valleys), (SHARP, sharp), (BOUNDARY, boundary)) if wanted]
    with room_for(len(mesh.faces)):
        if field is None:
            field = measure(mesh, parameters=parameters, progress=progress)
        return _found(mesh, field, kinds, parameters, progress)


def _found(mesh, field, kinds, parameters, progress) -> FeatureCurves:
    surface = Surface(mesh)
    found = []
    for i, kind in enumerate(kinds):
        done = 0

        def tick(i=i):
            nonlocal done
            done += 1
            if progress is not None:
                progress("lines", (i + done / (done + _STEPS)) / len(kinds))

        found.append(_lines(kind, mesh, field, surface, parameters, tick))
    reach, turn = parameters.junction * mesh.edge_length, np.radians(parameters.turn)
    least = 0.5 * parameters.folds(field.noise)[1]
    found = met(found, kinds, surface, field, reach=reach, turn=turn, fold=least, tick=tick)
    if progress is not None:
        progress("lines", 1.0)
    return _collected(found, kinds, mesh, field)


def measure(mesh: TriangleMesh, *, parameters: DetectionParameters = DEFAULTS, progress=None) -> Curvature:
    """The smoothed curvature of a mesh at `parameters.detail`, or at its own scale; most of the work of `detect`."""
    done = 0

    def tick():
        nonlocal done
        done += 1
        progress("curvature", done / (done + _ITERATIONS / 2))

    parameters.validate()
    with room_for(len(mesh.faces)):
        watched = tick if progress is not None else None
        if parameters.detail > 0:
            field = curvature(mesh, parameters.detail * mesh.edge_length, tick=watched)
        else:
            field = curvature_at_own_scale(mesh, tick=watched)
    if progress is not None:
        progress("curvature", 1.0)
    return field


def _lines(kind, mesh, field, surface, parameters, tick) -> Lines:
    """The finished lines of one kind."""
    h = mesh.edge_length
    tick()
    if kind == SHARP:
        return sharp_lines(mesh, field, np.radians(parameters.sharp_angle))
    if kind == BOUNDARY:
        return boundary_lines(mesh, field)
    strong_fold, weak = parameters.folds(field.noise)
    lines, sound, _ = crest_lines(mesh, field, kind, 0.5 * weak, tick)
    tick()
    clear = sound & (lines.fold >= weak) & ~surface.near_boundary(lines.points, parameters.margin * h)
    lines = lines.with_segments(clear_segments(lines.segments, lines.points, clear, parameters.bridge * h, tick))
    tick()
    lines = without_doubles(lines, parameters.merge * h, tick)
    tick()
    traced = len(lines.points)
    for _ in range(2):  # what was short before the first round may be long enough for a wider gap in the second
        lines = linked(
            lines, surface, field, gap=parameters.gap * h, turn=np.radians(parameters.turn),
            value=Extremality.of(field, kind).value, least=_ALONG_GAPS * weak, tick=tick,
        )  # fmt: skip
        tick()
    strong = lines.fold >= strong_fold
    bridge = np.arange(len(lines.points)) >= traced
    lines = lines.with_segments(without_faint_tails(lines.segments, len(lines.points), strong & ~bridge, bridge))
    tick()
    lines = without_spurs(lines, parameters.min_length * h)
    tick()
    return _strong(lines, strong_fold, parameters, h)


def _strong(lines: Lines, strong_fold: float, parameters: DetectionParameters, h: float) -> Lines:
    """The curves that are long enough, and strong over enough of their length."""
    pieces = lines.chains()
    share = weights(pieces, lines.points)
    strong = lines.fold[pieces.nodes] >= strong_fold
    strong_length = np.bincount(pieces.label, share * strong, len(pieces))
    keep = (strong_length >= parameters.strong_length * h) & (strong_length > 0)
    keep &= pieces.lengths(lines.points) >= parameters.min_length * h
    a, b = pieces.following()
    return lines.with_segments(np.stack([pieces.nodes[a], pieces.nodes[b]], axis=1)[keep[pieces.label[a]]])


def _collected(found, kinds, mesh, field) -> FeatureCurves:
    """Every chain of every kind as one curve, longest first."""
    parts = [(kind, lines, lines.chains()) for kind, lines in zip(kinds, found)]
    kind = np.concatenate([np.full(len(c), k) for k, _, c in parts]).astype(np.int64)
    length = np.concatenate([c.lengths(x.points) for _, x, c in parts])
    points = np.concatenate([x.points[c.nodes] for _, x, c in parts])
    normals = np.concatenate([x.normals[c.nodes] for _, x, c in parts])
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    strength = np.concatenate([x.strength[c.nodes] for _, x, c in parts])
    mean_strength = np.concatenate([_mean(c, x, x.strength) for _, x, c in parts])
    mean_fold = np.degrees(np.concatenate([_mean(c, x, x.fold) for _, x, c in parts]))
    sizes = np.concatenate([np.diff(c.offsets) for _, _, c in parts])
    closed = np.concatenate([c.closed for _, _, c in parts])
    offsets = np.r_[0, np.cumsum(sizes)].astype(np.int64)
    curves = Curves(points, offsets, closed, strength, normals=normals, kind=np.repeat(kind, sizes))
    h = mesh.edge_length
    found = FeatureCurves(curves, kind, length, mean_strength, mean_fold, h, field.scale / h)
    return found.select(np.lexsort((kind, -length)))


def _mean(pieces, lines, values) -> np.ndarray:
    """(c,) float64, average of node values along each chain by length."""
    weight = weights(pieces, lines.points)
    total = np.bincount(pieces.label, weight, len(pieces))
    return np.bincount(pieces.label, weight * values[pieces.nodes], len(pieces)) / np.maximum(total, 1e-300)
