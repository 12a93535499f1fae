# SPDX-License-Identifier: GPL-3.0-or-later
"""From an occurrence to the input curves that show it, and back."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from ...core.parameters import Parameters
from ..scene.curve_data import spline_points
from ..scene.families import within
from . import selection, stored

MOST = 0.5  # share of a curve's points that must lie at an occurrence for the curve to belong to it


@dataclass(frozen=True)
class InputMesh:
    """The input copy of a result: item is its object.

    points : (n, 3) float64, world space; source, component : (n,) int64, of the input curve that a point is on
    """

    item: object
    points: np.ndarray
    source: np.ndarray
    component: np.ndarray


def input_mesh(root):
    """The InputMesh of a result, None where it was removed."""
    home = stored.child(root, "input")
    for item in home.objects if home else ():
        if item.type == "MESH" and "source" in item.data.attributes and "component" in item.data.attributes:
            mesh = item.data
            points = np.empty(3 * len(mesh.vertices), np.float32)
            mesh.vertices.foreach_get("co", points)
            labels = [np.empty(len(mesh.vertices), np.int32) for _ in range(2)]
            for name, values in zip(("source", "component"), labels):
                mesh.attributes[name].data.foreach_get("value", values)
            matrix = np.array(item.matrix_world, float)
            points = points.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
            return InputMesh(item, points, *(values.astype(np.int64) for values in labels))
    return None


def radius(root) -> float:
    """How far from a completed curve its input may lie, in scene units: the feature radius and as much for noise."""
    saved = json.loads(root.fcn_result.parameters or "{}")
    return 2.0 * saved.get("epsilon", Parameters().epsilon) * root.fcn_result.edge_length


def points_of(parts, step):
    """(k, 3) float64 and (k,) int64: points of curve objects in world space, at most `step` apart where they are on a
    Bezier spline, and which object each is of."""
    points, owner = [np.zeros((0, 3))], [np.zeros(0, np.int64)]
    for i, item in enumerate(parts):
        matrix = np.array(item.matrix_world, float)
        for spline in item.data.splines:
            row = spline_points(spline, step)
            points.append(row @ matrix[:3, :3].T + matrix[:3, 3])
            owner.append(np.full(len(row), i))
    return np.concatenate(points), np.concatenate(owner)


def source_points(root, parts, mesh):
    """(n,) bool, the points of the input curves that show these parts.

    An input curve does if it is of the same component and most of it lies at the part.
    """
    from scipy.spatial import cKDTree

    near = np.zeros(len(mesh.points), bool)
    for component in {item["component"] for item in parts}:
        points, _ = points_of([o for o in parts if o["component"] == component], root.fcn_result.edge_length)
        asked = np.flatnonzero(mesh.component == component)
        if len(points) and len(asked):
            distance, _ = cKDTree(points).query(mesh.points[asked], distance_upper_bound=radius(root))
            near[asked] = np.isfinite(distance)
    size = np.maximum(np.bincount(mesh.source), 1)
    return (np.bincount(mesh.source, weights=near) / size >= MOST)[mesh.source]


def parts_of_points(root, chosen, mesh) -> list:
    """The curves of occurrences that the chosen input points, (n,) bool, show."""
    from scipy.spatial import cKDTree

    templates = stored.child(root, "templates")
    found = []
    for component in np.unique(mesh.component[chosen & (mesh.component >= 0)]):
        parts = [o for o in within(templates) if selection.is_part(o) and o["component"] == component]
        points, owner = points_of(parts, root.fcn_result.edge_length)
        if len(points):
            asked = mesh.points[chosen & (mesh.component == component)]
            distance, nearest = cKDTree(points).query(asked, distance_upper_bound=radius(root))
            found += [parts[i] for i in np.unique(owner[nearest[np.isfinite(distance)]])]
    return found


def select_points(mesh, chosen):
    """Select points of a mesh, (n,) bool, with the edges between them and nothing else; not in edit mode."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    mesh.vertices.foreach_set("select", chosen)
    mesh.edges.foreach_set("select", chosen[edges.reshape(-1, 2)].all(axis=1))
    mesh.update()


def selected_points(mesh) -> np.ndarray:
    """(n,) bool, the selected points of a mesh; not in edit mode."""
    chosen = np.zeros(len(mesh.vertices), bool)
    mesh.vertices.foreach_get("select", chosen)
    return chosen
