# SPDX-License-Identifier: GPL-3.0-or-later
"""What is visible of a result as files: polylines as OBJ, drawings as DXF and SVG, the poses of occurrences as CSV.

Files have world coordinates: those of the scene and its shift.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass

from ...core.errors import InputError
from ...core.files.writers.obj import write_obj
from ..result import one_object
from ..scene import origin
from ..scene.families import children
from ..scene.units import dxf_units
from . import outlines


@dataclass(frozen=True)
class Format:
    """How one format is written.

    name, words : for the menu
    thing : what is counted
    write : (path, root, objects) -> how many there are
    """

    name: str
    words: str
    thing: str
    write: object


def write(path, root, form):
    """Write what is visible of a result; how many curves, strokes or poses there are. Raises InputError.

    form : a key of FORMATS
    """
    objects = one_object.visible_curves(root)
    if not objects:
        raise InputError("no completed curve is visible; switch the view to Result")
    try:
        return FORMATS[form].write(path, root, objects)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); check the folder") from None


def _obj(path, root, objects):
    shift, found = origin.of(root), []
    for item in objects:
        matrix = outlines.matrix_of(item)
        for stroke in outlines.strokes(item.data, root.fcn_result.edge_length):
            points = stroke.points @ matrix[:3, :3].T + matrix[:3, 3] + shift
            found.append((points, stroke.closed, item.name.replace(" ", "_")))
    write_obj(path, *zip(*found))
    return len(found)


def _dxf(path, root, objects):
    from ...core.files.writers.dxf import write_dxf

    plan = outlines.plan(root, objects, origin.of(root))
    write_dxf(path, plan, units=dxf_units(_scene_of(root)))
    return plan.count


def _svg(path, root, objects):
    from ...core.files.writers.svg import write_svg

    plan = outlines.plan(root, objects, origin.of(root))
    write_svg(path, plan)
    return plan.count


def _scene_of(root):
    import bpy

    return next((s for s in bpy.data.scenes if root in s.collection.children_recursive), bpy.context.scene)


def _csv(path, root, objects):
    """A row an occurrence: template, number, support, and the upper three rows of its matrix."""
    rows = {row.ident: row.name for row in root.fcn_result.template_rows}
    families = children(outlines.occurrences(objects))
    with open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        axes = [f"m{i}{j}" for i in range(1, 4) for j in range(1, 5)]
        table.writerow(["template", "occurrence", "support", "x", "y", "z", *axes])
        for item, parts in families.items():
            supports = [part["support"] for part in parts if "support" in part]
            matrix = outlines.matrix_of(item)
            matrix[:3, 3] += origin.of(root)
            support = sum(supports) / max(len(supports), 1)
            name = rows.get(item["template"], item["template"])
            values = [f"{v:.12g}" for v in (support, *matrix[:3, 3], *matrix[:3].ravel())]
            table.writerow([name, item["occurrence"] + 1, *values])
    return len(families)


FORMATS = {
    "OBJ": Format("Polylines (.obj)", "Every visible curve as one polyline, named after its object", "curve", _obj),
    "DXF": Format(
        "Drawing (.dxf)",
        "Lines, arcs, circles and splines for CAD: a block for each template, an insert for each of its occurrences",
        "curve", _dxf,
    ),
    "SVG": Format(
        "Picture (.svg)", "The same as seen along the normal of its main plane, for drawing programs", "curve", _svg
    ),
    "CSV": Format(
        "Occurrences (.csv)", "A row for each visible occurrence: its template, support and matrix", "occurrence", _csv
    ),
}  # fmt: skip
