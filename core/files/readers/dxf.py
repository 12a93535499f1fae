# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF drawings: what is drawn in model space as lines, in world coordinates. ezdxf reads them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import LARGEST, load

CURVES = ("LINE", "POLYLINE", "LWPOLYLINE", "SPLINE", "ARC", "CIRCLE", "ELLIPSE")
"""Entities that are read; INSERT stands for those of its block."""

SAGITTA = 5e-4
"""How far a chord may lie off its arc, as a share of the size of the entity."""

MOST = 2_000_000
"""Entities and points that a drawing may come to when its blocks are put in: some refer to each other endlessly."""

DEEPEST = 50
"""Blocks in blocks; more go in a circle."""


def require_ezdxf():
    """The module ezdxf. Raises InputError where it is missing, in words that help."""
    try:
        import ezdxf
    except ModuleNotFoundError:
        raise InputError(
            "DXF needs ezdxf: `pip install ezdxf` for the Python that runs this, `python3 build.py --wheels` for a "
            "Blender, or install the extension's zip again"
        ) from None
    return ezdxf


def read_dxf(path) -> Reading:
    """The lines of a drawing's model space, blocks put in; what is hidden or is no line is left out and named.

    Its entities are pieces of curves, which become one by joining: no input curve has a name in the file.
    """
    drawing = _open(path)
    left_out, lines, count = Counter(), [], 0
    try:
        for entity in _Expansion(path, drawing, left_out).of(drawing.modelspace()):
            lines.append(_points(entity))
            count += len(lines[-1])
            if count > MOST:
                raise InputError(f"{path}: over {MOST} points with all blocks put in; simplify the drawing")
    except InputError:
        raise
    except Exception as error:  # ezdxf raises whatever the damage leads to
        raise InputError(f"{path}: the drawing is damaged ({_words(error)}); save it again") from None
    lines = [line for line in lines if len(line) > 1]
    told = ", ".join(f"{count} {name}" for name, count in sorted(left_out.items()))
    if not lines:
        hint = f"left out are {told}; show its layers, or explode it to lines" if told else f"draw {', '.join(CURVES)}"
        raise NoCurves(f"{path}: no curves in its model space; {hint}")
    points = np.concatenate(lines)
    wrong = np.flatnonzero(~(np.abs(points) <= LARGEST).all(axis=1))
    if len(wrong):
        raise InputError(f"{path}: {points[wrong[0]]} is not finite or too large; remove the point from the drawing")
    offsets = np.r_[0, np.cumsum([len(line) for line in lines])]
    reading = lines_of_points(path, points, np.arange(len(points)), offsets, named=np.zeros(len(lines), bool))
    return replace(reading, left_out=told, units=int(drawing.units))


def _open(path):
    ezdxf = require_ezdxf()
    from ezdxf import recover

    data = load(path)
    binary = data.startswith(b"AutoCAD Binary DXF")
    if data[:6] in (b"AC1012", b"AC1014", b"AC1015", b"AC1018", b"AC1021", b"AC1024", b"AC1027", b"AC1032"):
        raise InputError(f"{path}: this is a DWG file; save it as DXF")
    if not binary and b"\0" in data[:65536]:
        raise InputError(f"{path}: this is binary data, not a DXF file; check the file's format and its ending")
    if b"EOF" not in data.rstrip()[-256:]:
        raise InputError(f"{path}: this is no DXF file or it was cut off, it has no EOF at its end; save it again")
    try:
        try:
            return ezdxf.readfile(path)
        except Exception:  # whatever the damage leads to
            drawing, audit = recover.readfile(path)
    except (ezdxf.DXFError, OSError) as error:
        raise InputError(f"{path}: this is no DXF file or it was cut off ({_words(error)}); save it again") from None
    except Exception as error:
        raise InputError(f"{path}: the drawing is damaged ({_words(error)}); save it again") from None
    if audit.has_errors:
        raise InputError(f"{path}: the drawing is damaged ({_words(audit.errors[0].message)}); save it again")
    return drawing


def _words(error) -> str:
    return " ".join(str(error).split())[:120] or type(error).__name__


class _Expansion:
    """Entities with the blocks put in, as far as they are shown."""

    def __init__(self, path, drawing, left_out):
        self._path, self._left_out, self._count = path, left_out, 0
        self._hidden = {layer.dxf.name.lower() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}

    def of(self, entities, depth=0):
        """Yield the curve entities among these, those of blocks in world coordinates."""
        if depth > DEEPEST:
            raise InputError(f"{self._path}: its blocks refer to each other in a circle; save the drawing again")
        for entity in entities:
            self._count += 1
            if self._count > MOST:
                raise InputError(f"{self._path}: over {MOST} entities with all blocks put in; simplify the drawing")
            name = entity.dxftype()
            if entity.dxf.get("invisible", 0) or entity.dxf.get("layer", "0").lower() in self._hidden:
                self._left_out[f"hidden {name}"] += 1
            elif name == "INSERT":
                for one in self._single(entity):
                    yield from self.of(one.virtual_entities(skipped_entity_callback=self._skipped), depth + 1)
            elif name in CURVES and not (name == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
                yield entity
            else:
                self._left_out[name] += 1

    def _single(self, entity):
        if entity.mcount > MOST:
            raise InputError(f"{self._path}: an INSERT of {entity.mcount} copies; simplify the drawing")
        return entity.multi_insert() if entity.mcount > 1 else [entity]

    def _skipped(self, entity, reason):
        self._left_out[entity.dxftype()] += 1


def _points(entity) -> np.ndarray:
    """(k, 3) float64, an entity as a polyline in world coordinates; a closed one repeats its first point."""
    from ezdxf.path import make_path

    if entity.dxftype() == "LINE":
        return np.array([entity.dxf.start.xyz, entity.dxf.end.xyz])
    path = make_path(entity)
    corners = np.array([p.xyz for p in path.control_vertices()]).reshape(-1, 3)
    if not path.has_curves or not len(corners):
        return corners
    size = float(np.ptp(corners, axis=0).max())
    if not np.isfinite(size):
        return corners
    return np.array([p.xyz for p in path.flattening(max(SAGITTA * size, 1e-300), segments=4)])
