# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects of a result as a plan: a symbol for each template, as its curves are now, at the places where they are now.

Occurrences that share all of their visible curves are one symbol. What was made unique, or has a part that was moved
or hidden, is a symbol of its own; what was scaled or has lost its empty is drawn stroke by stroke.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...core.files.writers.plan import Plan, Stroke, Symbol
from ...core.fitting.recognised import recognised
from ...core.geometry.chains import chains_of_edges
from .. import colours
from ..result import selection
from ..scene.curve_data import OFFSET, bezier_path, spline_points, twin
from ..scene.families import children

RIGID = 1e-4
"""How far a matrix of single precision may be from a rotation."""


def matrix_of(item) -> np.ndarray:
    """(4, 4) float64, where an object stands in the scene; occurrences that are far, finer than single precision."""
    matrix = np.array(item.matrix_world, float)
    offset = item.get(OFFSET)
    if offset is not None:
        matrix[:3, 3] += matrix[:3, :3] @ np.array(offset, float)
    return matrix


def occurrences(objects) -> list:
    """The empties of the occurrences that curves belong to."""
    return selection.holders(objects)


def strokes(data, step=None) -> list[Stroke]:
    """The curves of curve data or of an edge mesh, in its own space.

    step : most that points on bent Bezier segments are apart; see `curve_data.spline_points`
    """
    if hasattr(data, "vertices"):
        return _of_mesh(data)
    return [_of_spline(spline, step) for spline in data.splines]


def _of_spline(spline, step):
    closed = bool(spline.use_cyclic_u)
    primitives = recognised(bezier_path(spline), closed) if spline.type == "BEZIER" else ()
    return Stroke(spline_points(spline, step), closed, primitives)


def _of_mesh(data):
    """A stroke for each chain of edges."""
    points, edges = np.empty(3 * len(data.vertices), np.float32), np.empty(2 * len(data.edges), np.int32)
    data.vertices.foreach_get("co", points)
    data.edges.foreach_get("vertices", edges)
    points, chains = points.reshape(-1, 3).astype(float), chains_of_edges(edges)
    ranges = zip(chains.offsets[:-1], chains.offsets[1:], chains.closed)
    return [Stroke(points[chains.vertices[a:b]], bool(closed)) for a, b, closed in ranges]


def plan(root, objects, shift=0.0) -> Plan:
    """The plan of the visible curves of a result.

    objects : its completed curves that are to be in it
    shift : (3,), added to all places
    """
    names = {row.ident: row.name for row in root.fcn_result.template_rows}
    shared, loose = _grouped(objects)
    symbols, taken = [], set()
    for holder, parts, poses in shared:
        name = _free(names.get(holder["template"], f"Template {holder['template']}"), taken)
        own = tuple(stroke for part, matrix in parts for stroke in _placed(part, matrix))
        symbols.append(Symbol(name, "template", own, np.array(poses) + _moved_by(shift)))
    single = [
        ("template" if selection.is_part(item) else "strong", stroke)
        for item in loose
        for stroke in _placed(item, matrix_of(item) + _moved_by(shift))
    ]
    layers = {"template": colours.TEMPLATE, "strong": colours.STRONG}
    return Plan(layers, tuple(symbols), tuple(single))


def _moved_by(shift):
    out = np.zeros((4, 4))
    out[:3, 3] = shift
    return out


def _grouped(objects):
    """[first empty, [(curve, its matrix in the occurrence)], [pose, ...]] of each symbol; and the other curves."""
    wanted, groups, loose = set(objects), {}, [item for item in objects if not selection.is_part(item)]
    families = children(selection.holders([item for item in objects if selection.is_part(item)]))
    for holder, family in families.items():
        parts, pose = [part for part in family if part in wanted], matrix_of(holder)
        if not _is_rigid(pose):
            loose += parts
            continue
        inverse = np.linalg.inv(pose)
        relative = [inverse @ matrix_of(part) for part in parts]
        key = holder["template"], tuple(_key(part, holder, pose, m) for part, m in zip(parts, relative))
        group = groups.setdefault(key, [holder, list(zip(parts, relative)), []])
        group[2].append(pose)
    with_empty = {part for family in families.values() for part in family}
    loose += [item for item in objects if selection.is_part(item) and item not in with_empty]
    return list(groups.values()), loose


def _key(part, holder, pose, relative):
    """What two parts have in common that are drawn alike: their data, and where they stand in their occurrence.

    That differs by single precision at the place of the occurrence; where it has an offset, not at all.
    """
    away, grain, far = relative - np.eye(4), np.full((4, 4), 1e-3), np.abs(pose[:3, 3]).max()
    if OFFSET in holder:
        away[:3, 3] += holder[OFFSET]
        grain[:3, 3] = np.spacing(np.float32(far))
    else:
        grain[:3, 3] = 1e-4 * max(far, 1.0)
    return twin(part.data) or part.data.name, tuple((np.round(away / grain) + 0.0).ravel())


def _is_rigid(matrix) -> bool:
    turn = matrix[:3, :3]
    return bool(np.abs(turn.T @ turn - np.eye(3)).max() <= RIGID and np.linalg.det(turn) > 0)


def _placed(item, matrix):
    """The strokes of an object under a matrix; only where it is rigid do arcs stay arcs."""
    turn, place = matrix[:3, :3], matrix[:3, 3]
    for stroke in strokes(item.data):
        points = stroke.points @ turn.T + place
        if _is_rigid(matrix):
            primitives = tuple(piece.moved(matrix) for piece in stroke.primitives)
        else:
            path = [piece.beziers() for piece in stroke.primitives]
            primitives = recognised(np.concatenate(path) @ turn.T + place, stroke.closed) if path else ()
        yield replace(stroke, points=points, primitives=primitives)


def _free(name, taken):
    """A name that no symbol has yet."""
    found, i = name, 2
    while found in taken:
        found, i = f"{name} {i}", i + 1
    taken.add(found)
    return found
