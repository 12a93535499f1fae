# SPDX-License-Identifier: GPL-3.0-or-later
"""Which reader takes which file, and the table of it that README shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError
from .readers.dxf import read_dxf
from .readers.obj import obj_content, read_obj, read_obj_surface
from .readers.ply import ply_content, read_ply, read_ply_surface
from .readers.polylines import read_polylines
from .readers.ridges import read_text
from .readers.stl import read_stl_surface
from .reading import WELD, Reading, concatenate


@dataclass(frozen=True)
class Format:
    """How files with certain endings are read.

    endings : the longest that fits a name decides
    surface, curves : what the file may hold, in the words of README; empty where it does not hold that
    read_surface : path -> points (n, 3) float64 and triangles (m, 3) int64, or None
    read_curves : path -> Reading, not joined, or None
    content : path -> whether it has faces, whether it has curves; None where the ending tells
    """

    endings: tuple[str, ...]
    surface: str
    curves: str
    read_surface: Callable | None = None
    read_curves: Callable | None = None
    content: Callable | None = None


FORMATS = (
    Format(
        (".obj",), "faces", "`l` lines, polylines or single edges", read_obj_surface, read_obj, obj_content,
    ),
    Format(
        (".ply",), "faces, triangle strips", "edges; the vertex property `curvature` is the strength",
        read_ply_surface, read_ply, ply_content,
    ),
    Format((".stl",), "facets, binary or ascii, all solids of the file", "", read_stl_surface),
    Format(
        (".dxf",), "",
        "LINE, POLYLINE, LWPOLYLINE, SPLINE, ARC, CIRCLE, ELLIPSE, and INSERT of blocks of these", None, read_dxf,
    ),
    Format((".polylines.txt", ".cgal"), "", "CGAL's polylines, `n x y z x y z ...`", None, read_polylines),
    Format(
        (".txt",), "",
        "ridge lines of CGAL's Ridges_3, `ridges.txt` / `ravines.txt` of CrestCODE, or CGAL's polylines",
        None, read_text,
    ),
)  # fmt: skip

BLENDER = (
    Format((".blend",), "what is shown with faces", "what is shown of edges, curves and Grease Pencil"),
    Format(
        (".glb", ".gltf", ".fbx", ".usd", ".usda", ".usdc", ".usdz", ".abc", ".dae"), "faces",
        "lines and curves; through Blender's importers",
    ),
)  # fmt: skip
"""What only Blender reads; the command line does that."""


@dataclass(frozen=True)
class Content:
    """Whether a file has faces, and whether it has curves."""

    faces: bool
    curves: bool


def endings(what=None) -> list[str]:
    """The endings of files that may hold a "surface" or "curves", all if None; sorted."""
    return sorted(e for f in (*FORMATS, *BLENDER) if what is None or getattr(f, what) for e in f.endings)


def is_blenders(path) -> bool:
    """Whether a file is one that only Blender reads."""
    return any(Path(path).suffix.lower() in form.endings for form in BLENDER)


def format_of(path) -> Format | None:
    """The format that the end of a file's name says, None for one that is not known."""
    name = Path(path).name.lower()
    fitting = [(len(ending), f) for f in FORMATS for ending in f.endings if name.endswith(ending)]
    return max(fitting, key=lambda pair: pair[0])[1] if fitting else None


def content(path) -> Content:
    """What there is in a file, without reading it all; a file that has neither is for its reader to refuse."""
    form = format_of(path)
    if form is None:
        return Content(False, False)
    if form.content is not None:
        return Content(*form.content(path))
    return Content(form.read_surface is not None, form.read_curves is not None)


def read_lines(path) -> Reading:
    """The curves of a file as they stand in it, not joined yet. Raises InputError, NoCurves where it has none."""
    return _reader(path, "read_curves", "curves")(path)


def read_curves(paths, *, weld=WELD) -> Reading:
    """Curves of one or more files, in their order, joined by position.

    weld : ends this near are one, in edge lengths, which are estimated here
    """
    from ..network.edge_length import estimate_edge_length
    from .joining import join

    reading = concatenate(read_lines(path) for path in paths)
    edge_length = estimate_edge_length(reading.curves, crossings=reading.crossings)
    return join(reading, weld * edge_length)


def read_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of a file with faces."""
    return _reader(path, "read_surface", "a surface")(path)


def _reader(path, name, what):
    form = format_of(path)
    reader = getattr(form, name, None)
    if reader is None:
        known = ", ".join(sorted(e for f in FORMATS if getattr(f, name) for e in f.endings))
        suffix = Path(path).suffix.lower()
        raise InputError(f"{path}: {what} cannot be read from a {suffix or 'nameless'} file; give one of {known}")
    return reader


def table() -> str:
    """README's table of what is read."""
    rows = ["| file | scan: its feature curves are detected first | curves |", "|---|---|---|"]
    for form in (*FORMATS, *BLENDER):
        names = ", ".join(f"`{ending}`" for ending in form.endings)
        rows.append(f"| {names} | {form.surface} | {form.curves} |".replace("  ", " "))
    return "\n".join(rows) + "\n"


def mean_edge_length(points, triangles) -> float:
    """Mean length of the edges of a mesh, each counted once, in scene units."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(edges[:, 0] * len(points) + edges[:, 1])
    lengths = np.linalg.norm(points[edges // len(points)] - points[edges % len(points)], axis=1)
    lengths = lengths[lengths > 0]
    if len(lengths) == 0:
        raise InputError("the surface has no edge with a length; give the edge length instead")
    return float(lengths.mean())
