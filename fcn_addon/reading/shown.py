# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender shows of objects: their evaluated geometry with all instances, part by part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import drawn, pencil
from .geometry import Surface, Wires, in_world, read_lines, read_mesh
from .left_out import CLOUD, TEXT, VOLUME

REFUSED = {"FONT": TEXT, "POINTCLOUD": CLOUD, "VOLUME": VOLUME}


@dataclass(frozen=True)
class Part:
    """A piece of what an object shows, in world space.

    owner : index of the object that was asked for; what it instances is its own too
    geometry : Wires, Lines or a Surface
    source : the object that the geometry is of, in the file
    matrix : (4, 4), from its own space to the world
    beside : whether it is wires of a mesh that has faces too
    """

    owner: int
    geometry: object
    source: object
    matrix: np.ndarray
    beside: bool = False


@dataclass(frozen=True)
class Shown:
    """parts : list of Part; seen : indices of the objects that are shown at all; refused : (index, reason) pairs"""

    parts: list
    seen: set
    refused: set


def look(objects, depsgraph, quiet=False) -> Shown:
    """What a depsgraph shows of objects; hidden ones are not there.

    Parameters
    ----------
    objects : of the file, not evaluated
    quiet : touch nothing in Blender, and take hidden objects as they are without modifiers; curves are then as coarse
        as their control points, and those that geometry nodes make are missing

    Raises
    ------
    InputError that names an object with a coordinate that is not finite
    """
    layer = depsgraph.view_layer  # it knows at once what was hidden, the depsgraph only when the scene is evaluated
    order = {item: i for i, item in enumerate(objects) if item.visible_get(view_layer=layer)}
    found = Shown([], set(), set())
    reader = _Reader(quiet)
    with_curves, items = set(), []
    # The instances live as long as the loop: what they are of is read within it, once.
    for instance in depsgraph.object_instances:
        top = (instance.parent if instance.is_instance else instance.object).original
        if top not in order:
            continue
        owner, item = order[top], instance.object
        found.seen.add(owner)
        if not instance.is_instance and not instance.show_self:
            continue
        if item.type in REFUSED or item.original.type in REFUSED:
            found.refused.add((owner, REFUSED.get(item.type) or REFUSED[item.original.type]))
            continue
        if _stands_for_curves(instance):
            with_curves.add(item.original)
            continue
        matrix = np.array(instance.matrix_world, float)
        items.append((owner, item.original, matrix, reader.read(item, matrix)))
    for owner, item in enumerate(objects) if quiet else ():
        if item not in order and item.type not in REFUSED:
            matrix = np.array(item.matrix_world, float)
            found.seen.add(owner)
            items.append((owner, item, matrix, reader.read(item.evaluated_get(depsgraph), matrix)))
    for owner, source, matrix, pieces in items:
        if source in with_curves and not quiet:
            pieces = [*pieces, *reader.of_nodes(source)]
        for local, relative, beside in pieces:
            world = matrix if relative is None else relative
            found.parts.append(Part(owner, in_world(source.name, local, world), source, world, beside))
    return found


def _stands_for_curves(instance) -> bool:
    """Whether this stands for curves that geometry nodes make, which only a scene of its own can show."""
    return instance.is_instance and instance.object.type == "CURVE" and not len(instance.object.data.splines)


class _Reader:
    """Reads geometry once, however often it is instanced."""

    def __init__(self, quiet):
        self._quiet = quiet
        self._known = {}

    def read(self, item, world) -> list:
        """Pieces of an item of the depsgraph: geometry, a matrix of its own or None, whether it is beside faces."""
        if item.type == "GREASEPENCIL" and (self._quiet or not pencil.is_curved(item.data)):
            return [(lines, matrix, False) for lines, matrix in pencil.read_new(item.data, world)]
        key = item.type, item.original, item.data.as_pointer() if item.data else 0
        if key not in self._known:
            self._known[key] = self._of(item)
        return self._known[key]

    def of_nodes(self, source) -> list:
        """The curves that the modifiers of an object make."""
        key = "NODES", source, 0
        if key not in self._known:
            self._known[key] = _pieces(drawn.curves_of_nodes(source))
        return self._known[key]

    def _of(self, item) -> list:
        data, original = item.data, item.original
        if item.type == "MESH":
            # A curve object shows its mesh as an instance of its own; it is read as a curve.
            return [] if original.type == "CURVE" and not _has_nodes(original) else _pieces(read_mesh(data))
        if item.type == "CURVE":
            return self._of_curve(item)
        if item.type == "CURVES":
            sizes = np.empty(len(data.curves), np.int32)
            data.curves.foreach_get("points_length", sizes)
            if drawn.needs_drawing(data.attributes, len(sizes)) and not self._quiet:
                return _pieces(drawn.hair_curves(data))
            return [(read_lines(data.attributes, sizes), None, False)] if len(sizes) else []
        if item.type == "GPENCIL":
            return [(lines, None, False) for lines in pencil.read_old(data)]
        if item.type == "GREASEPENCIL":
            return _pieces(drawn.strokes(original))
        return []

    def _of_curve(self, item) -> list:
        original = item.original
        if _has_nodes(original) and not self._quiet:
            return self.of_nodes(original)
        if drawn.is_thick(original.data):
            bare = self._quiet or not original.modifiers
            return _pieces(drawn.plain_path(original.data) if bare else drawn.path(original))
        mesh = item.to_mesh()
        try:
            return [] if mesh is None else _pieces(read_mesh(mesh))
        finally:
            item.to_mesh_clear()


def _has_nodes(item) -> bool:
    return any(modifier.type == "NODES" for modifier in item.modifiers)


def _pieces(parts) -> list:
    """The wires and the surface of a mesh."""
    pieces = [(parts.wires, None, parts.surface is not None), (parts.surface, None, False)]
    return [piece for piece in pieces if piece[0] is not None]


def is_surface(part) -> bool:
    return isinstance(part.geometry, Surface)


def is_wires(part) -> bool:
    return isinstance(part.geometry, Wires)
