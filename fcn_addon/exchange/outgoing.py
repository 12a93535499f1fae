# SPDX-License-Identifier: GPL-3.0-or-later
"""What is visible of a result as files: polylines as OBJ, the poses of all occurrences as CSV.

Files have world coordinates: those of the scene and its shift.
"""

from __future__ import annotations

import csv

import numpy as np

from ...core.errors import InputError
from ...core.files.writers.obj import write_obj
from ..result import one_object, selection
from ..scene import origin
from ..scene.curve_data import spline_points
from ..scene.families import children


def write(path, root, form):
    """Write the visible curves of a result; how many curves or poses there are. Raises InputError.

    form : "OBJ" or "CSV"
    """
    objects = one_object.visible_curves(root)
    if not objects:
        raise InputError("no completed curve is visible; switch the view to Result")
    try:
        return FORMS[form](path, root, objects)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); check the folder") from None


def chains(objects, step):
    """(points (k, 3) float64 in the scene, closed, the object) of every curve; points at most `step` apart on arcs."""
    for item in objects:
        matrix = np.array(item.matrix_world, float)
        for points, closed in _of_mesh(item.data) if item.type == "MESH" else _of_curve(item.data, step):
            yield points @ matrix[:3, :3].T + matrix[:3, 3], closed, item


def _of_curve(data, step):
    return [(spline_points(spline, step), spline.use_cyclic_u) for spline in data.splines]


def _of_mesh(data):
    """The one chain of an edge mesh of a result, whose points are in order."""
    points = np.empty(3 * len(data.vertices), np.float32)
    data.vertices.foreach_get("co", points)
    return [(points.reshape(-1, 3).astype(float), len(data.edges) == len(data.vertices))]


def _obj(path, root, objects):
    found = list(chains(objects, root.fcn_result.edge_length))
    points, names = [p + origin.of(root) for p, _, _ in found], [o.name.replace(" ", "_") for *_, o in found]
    write_obj(path, points, [c for _, c, _ in found], names)
    return len(found)


def _csv(path, root, objects):
    """A row an occurrence: template, number, support, and the upper three rows of its matrix."""
    rows = {row.ident: row.name for row in root.fcn_result.template_rows}
    families = children(selection.holders(objects))
    with open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        axes = [f"m{i}{j}" for i in range(1, 4) for j in range(1, 5)]
        table.writerow(["template", "occurrence", "support", "x", "y", "z", *axes])
        for item, parts in families.items():
            supports = [part["support"] for part in parts if "support" in part]
            matrix = np.array(item.matrix_world, float)
            matrix[:3, 3] += origin.of(root)
            support = sum(supports) / max(len(supports), 1)
            name = rows.get(item["template"], item["template"])
            values = [f"{v:.12g}" for v in (support, *matrix[:3, 3], *matrix[:3].ravel())]
            table.writerow([name, item["occurrence"] + 1, *values])
    return len(families)


FORMS = {"OBJ": _obj, "CSV": _csv}
