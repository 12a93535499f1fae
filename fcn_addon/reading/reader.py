# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of a scene as curves and as scans: what Blender shows of them, in world space.

What an object is, is asked of what it shows, with its modifiers and instances: curves, faces, or both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError
from ...core.files.reading import Reading, concatenate
from ..scene.curve_data import EDGE_LENGTH
from . import left_out, shown
from .geometry import as_reading, mean_scale
from .left_out import LeftOut

CURVE_TYPES = {"CURVE", "CURVES", "GPENCIL", "GREASEPENCIL"}


@dataclass(frozen=True)
class SceneReading:
    """Curves and surfaces of objects.

    names : the objects that were asked for
    reading : their curves, None where they have none
    owner : (reading.count,) int64, which of them each input curve comes from
    surfaces : index of the object -> points (n, 3) float64 and triangles (m, 3) int64 of all faces that it shows
    left_out : what gave neither, or what of an object was left out
    """

    names: tuple[str, ...]
    reading: Reading | None
    owner: np.ndarray
    surfaces: dict
    left_out: LeftOut


def read(objects, depsgraph, *, take_edges=False, quiet=False) -> SceneReading:
    """Read objects in the order given.

    Parameters
    ----------
    take_edges : of meshes with faces and loose edges take the edges as curves, and leave out the faces
    quiet : touch nothing in Blender, see `shown.look`

    Raises
    ------
    InputError that names an object with a coordinate that is not finite
    """
    objects = list(objects)
    found = shown.look(objects, depsgraph, quiet)
    readings, owner, surfaces = [], [], {}
    reasons = dict(sorted(found.refused))
    gave, extra = set(), {}
    with_edges = {part.owner for part in found.parts if part.beside}
    for part in found.parts:
        if shown.is_surface(part):
            if take_edges and part.owner in with_edges:
                extra[part.owner] = left_out.FACES
                continue
            surfaces.setdefault(part.owner, []).append(part.geometry)
        elif part.beside and not take_edges:
            extra[part.owner] = left_out.LOOSE
            continue
        else:
            try:
                reading = as_reading(part.source.name, part.geometry)
            except InputError:
                extra[part.owner] = left_out.POINTS
                continue
            readings.append(_with_edge_length(reading, part))
            owner += [part.owner] * reading.count
        gave.add(part.owner)
    rows = [(objects[i].name, extra[i]) for i in sorted(extra)]
    rows += [(objects[i].name, reason) for i, reason in sorted(found.refused) if i in gave]
    for i, item in enumerate(objects):
        if i not in gave and i not in extra:
            rows.append((item.name, reasons.get(i) or _reason(item, i in found.seen)))
    return SceneReading(
        tuple(item.name for item in objects),
        concatenate(readings) if readings else None,
        np.array(owner, np.int64),
        {i: _as_one(pieces) for i, pieces in surfaces.items()},
        LeftOut(tuple(rows)),
    )


def read_curves(objects, depsgraph, *, take_edges=False, quiet=False) -> SceneReading:
    """Read the curves of objects. Raises InputError where there are none, with the reason."""
    if not objects:
        raise InputError("no curves are chosen; choose edge meshes or curve objects")
    found = read(objects, depsgraph, take_edges=take_edges, quiet=quiet)
    if found.reading is not None:
        rows = tuple((found.names[i], left_out.SCAN) for i in found.surfaces)
        return replace(found, left_out=found.left_out + LeftOut(rows))
    raise InputError(_why_no_curves(found))


def _why_no_curves(found) -> str:
    if found.surfaces:
        first = next(iter(found.surfaces))
        text = rpt_("object {name!r} is a surface of {faces} triangles; detect its feature curves first")
        return text.format(name=found.names[first], faces=len(found.surfaces[first][1]))
    name, reason = found.left_out.objects[0]
    text = rpt_("object {name!r} gives no curves ({reason}); choose edge meshes or curve objects")
    return text.format(name=name, reason=reason)


def read_surface(item, depsgraph):
    """Points (n, 3) float64 and triangles (m, 3) int64 of all faces that an object shows.

    Raises InputError where it shows none, or a coordinate that is not finite.
    """
    found = read([item], depsgraph)
    if found.surfaces:
        return found.surfaces[0]
    text = rpt_("object {name!r} has no faces; choose a scan, or complete its curves directly")
    raise InputError(text.format(name=item.name))


def evaluated_faces(item, depsgraph) -> int:
    """How many faces a mesh object has under its modifiers, without its instances; 0 for other types. Cheap."""
    data = _evaluated_mesh(item, depsgraph)
    return 0 if data is None else len(data.polygons)


def may_hold_curves(item, depsgraph, take_edges=False) -> bool:
    """Whether to read an object for its curves. Cheap, so it may be wrong where nodes or instances decide."""
    if item.type in CURVE_TYPES or _instances(item):
        return True
    data = _evaluated_mesh(item, depsgraph)
    if data is None:
        return False
    if len(data.polygons):
        return take_edges or any(m.type == "NODES" for m in item.modifiers)
    return len(data.edges) > 0 or any(m.type == "NODES" for m in item.modifiers)


def _instances(item) -> bool:
    """Whether an object instances others."""
    if item.instance_type == "COLLECTION":
        return item.instance_collection is not None
    return item.instance_type in {"VERTS", "FACES"} and bool(item.children)


def _evaluated_mesh(item, depsgraph):
    """The mesh of an object under its modifiers, or as it is where the object is hidden; None for other types."""
    if item.type != "MESH":
        return None
    data = item.evaluated_get(depsgraph).data if depsgraph is not None else item.data
    return data if isinstance(data, bpy.types.Mesh) else item.data


def _reason(item, seen) -> str:
    """Why an object gave nothing."""
    if item.type in shown.REFUSED:
        return shown.REFUSED[item.type]
    if not seen and (item.type in CURVE_TYPES or item.type in {"MESH", "SURFACE", "META"} or _instances(item)):
        return left_out.HIDDEN
    return left_out.EMPTY if item.type == "MESH" or item.type in CURVE_TYPES else left_out.OTHER


def _with_edge_length(reading, part) -> Reading:
    """With the mean edge length of the scan that detected curves come from, where they know it."""
    value = part.source.get(EDGE_LENGTH)
    if not isinstance(value, float) or not np.isfinite(value) or value <= 0:
        return reading
    return replace(reading, edge_length=value * mean_scale(part.matrix) or None)


def _as_one(surfaces):
    """Points and triangles of several surfaces."""
    first = np.cumsum([0] + [len(s.points) for s in surfaces])
    triangles = [s.triangles + n for s, n in zip(surfaces, first)]
    return np.concatenate([s.points for s in surfaces]), np.concatenate(triangles)
