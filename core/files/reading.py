# SPDX-License-Identifier: GPL-3.0-or-later
"""Which reader takes which file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError
from .network import Reading, concatenate
from .obj import obj_content, read_obj, read_obj_surface
from .ply import ply_content, read_ply, read_ply_surface
from .ridges import read_ridges
from .stl import read_stl_surface

CURVE_READERS = {".obj": read_obj, ".ply": read_ply, ".txt": read_ridges}
SURFACE_READERS = {".obj": read_obj_surface, ".ply": read_ply_surface, ".stl": read_stl_surface}
CONTENTS = {".obj": obj_content, ".ply": ply_content}


@dataclass(frozen=True)
class Content:
    """Whether a file has faces, and whether it has curves."""

    faces: bool
    curves: bool


def content(path) -> Content:
    """What there is in a file, without reading it all; a file that names neither is for its reader to refuse."""
    suffix = Path(path).suffix.lower()
    if suffix in CONTENTS:
        return Content(*CONTENTS[suffix](path))
    return Content(suffix in SURFACE_READERS, suffix in CURVE_READERS)


def read_curves(paths) -> Reading:
    """Curves of one or more files, in their order (.obj, .ply with edges, .txt with ridge lines)."""
    return concatenate(_reader(path, CURVE_READERS, "curves")(path) for path in paths)


def read_surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of a .ply, .obj or .stl file."""
    return _reader(path, SURFACE_READERS, "a surface")(path)


def mean_edge_length(points, triangles) -> float:
    """Mean length of the edges of a mesh, each counted once, in scene units."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges = np.unique(edges[:, 0] * len(points) + edges[:, 1])
    lengths = np.linalg.norm(points[edges // len(points)] - points[edges % len(points)], axis=1)
    lengths = lengths[lengths > 0]
    if len(lengths) == 0:
        raise InputError("the surface has no edge with a length; give the edge length instead")
    return float(lengths.mean())


def _reader(path, readers, what):
    suffix = Path(path).suffix.lower()
    if suffix not in readers:
        known = ", ".join(sorted(readers))
        raise InputError(f"{path}: {what} cannot be read from a {suffix or 'nameless'} file; give one of {known}")
    return readers[suffix]
