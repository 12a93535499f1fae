# SPDX-License-Identifier: GPL-3.0-or-later
"""A completion as collections of curve objects. Only bpy.data is used, so it works in any context.

FCN <source>
    Input               the curves that were read, an edge mesh; hidden
    Templates           per transformation a collection; an empty per occurrence holds the template's curves
    Components          per component the same objects again, and the input pieces that show it; those are hidden
    Strong              an object per strong single curve
    Noise               the rest of the input; hidden

Users may rename all of it, so each collection also says what it is in custom properties: its role, the
transformation or the component that it is of.
"""

from __future__ import annotations

import bpy
import numpy as np

from ...core.report import moved
from ...core.values import Curves
from .. import colours
from ..scene.curve_data import DIGEST, OFFSET, TWIN, bezier_data, curve_data, digest, mesh_data
from ..scene.origin import STEP
from ..scene.units import unit_length
from ..shifts import held, held_middle
from ..wording import letters, titles
from .views import ROLE

COARSE = 0.01
"""How far an occurrence may be from where it was computed, in edge lengths, since Blender's matrices are rounded.
Beyond that, far from the origin, each occurrence has curves of its own, about a place that a matrix does hold."""

FORMS = (
    ("HANDLES", "Curves with Handles", "Bezier curves of few points: lines, arcs and what lies between, with handles"),
    ("DENSE", "Dense Curves", "Curves with a point for every edge length of the scan"),
    ("MESH", "Edge Meshes", "Meshes of edges, with a point for every edge length of the scan"),
)
BESIDE = (
    ("INPUT", "Input", "A copy of the curves as they were read; Source Curves needs it"),
    ("COMPONENTS", "Components", "The completed curves by the feature that they show, beside the input that shows it"),
    ("NOISE", "Noise", "What was dropped"),
)
"""What a result may keep beside the completed curves."""


def write(completion, curves, *, source, scene, length=None, fitted=None, form="DENSE", names=None, keep=None):
    """Make the collections and link them to a scene; on any fault everything that was made is removed.

    Parameters
    ----------
    completion, curves : a Completion and the Curves it is of
    source : str, what the curves are called
    length : turns scene units into words, by default with the unit of the scene
    fitted : FittedCompletion, the curves as primitives; needed where form is "HANDLES"
    form : what the objects are, one of `FORMS`
    names : template id -> what it is called; letters if None
    keep : which of `BESIDE` to write, all if None

    Returns
    -------
    bpy.types.Collection, the one that holds all others

    Notes
    -----
    O(objects). Nothing is linked to the scene before all is made: each link into a scene's tree would visit the tree.
    """
    made = []
    try:
        keep = {key for key, *_ in BESIDE} if keep is None else keep
        writer = _Writer(made, completion, curves, fitted, form, names or {}, keep)
        root = writer.write(source, length or unit_length(scene))
        scene.collection.children.link(root)
    except BaseException:
        bpy.data.batch_remove(made)
        raise
    return root


class _Maker:
    """Makes collections, objects and curves of one form; `made` collects all of it."""

    def __init__(self, made, form):
        self.made, self.form = made, form

    def _collection(self, name, parent=None, hidden=False):
        collection = bpy.data.collections.new(name)
        self.made.append(collection)
        collection.hide_viewport = collection.hide_render = hidden
        if parent is not None:
            parent.children.link(collection)
        return collection

    def _role(self, name, root, hidden=False):
        collection = self._collection(name, root, hidden)
        collection[ROLE] = name.lower()
        return collection

    def _object(self, name, data, collection, colour=None):
        made = bpy.data.objects.new(name, data)
        self.made.append(made)
        collection.objects.link(made)
        if colour is not None:
            made.color = (*colour, 1.0)
            made.show_wire = True  # only then a viewport in solid mode draws the curve in its own colour
        return made

    def _curve(self, name, curve, fit, centre):
        """The data of one completed curve about a centre: as its form says, with its handles where it has any."""
        if self.form == "MESH":
            one = Curves.from_list([curve.points], [curve.closed])
            data = mesh_data(name, one, curve.points - centre)
        elif self.form == "HANDLES" and fit is not None and fit.primitives:
            data = bezier_data(name, [fit.beziers() - centre], [fit.closed])
        else:
            data = curve_data(name, [curve.points - centre], [curve.closed])
        self.made.append(data)
        return data


class _Writer(_Maker):
    """Makes the data of one result."""

    def __init__(self, made, completion, curves, fitted, form, names, keep):
        super().__init__(made, form)
        self.names, self.keep, self.fitted = names, keep, fitted
        self.completion = completion
        self.curves = curves
        self.components = {}
        self.step = 0.0

    def write(self, source, length):
        root = self._collection(f"FCN {source}"[:63])
        if "INPUT" in self.keep:
            self._input(self._role("Input", root, hidden=True))
        self._templates(self._role("Templates", root), titles(self.completion.transformations, length))
        if "COMPONENTS" in self.keep:
            self._components(self._role("Components", root))
        self._strong(self._role("Strong", root))
        if "NOISE" in self.keep:
            self._noise(self._role("Noise", root, hidden=True))
        if self.step:
            root[STEP] = self.step
        return root

    def _noise(self, collection):
        pieces = np.flatnonzero(self.completion.inputs.kind == "noise")
        if len(pieces):
            self._pieces("Noise", pieces, collection, colours.NOISE)

    def _input(self, collection):
        """The input as one edge mesh, about its own centre, so that float32 holds it far from the origin too."""
        curves = self.curves
        centre = held_middle(curves.points)
        mesh = mesh_data("Input", curves, curves.points - centre)
        self.made.append(mesh)
        size = np.diff(curves.offsets)
        for name, labels in (("source", curves.source), ("component", self.completion.inputs.component)):
            owner = np.repeat(labels, size).astype(np.int32)
            mesh.attributes.new(name, "INT", "POINT").data.foreach_set("value", owner)
        if curves.strength is not None:
            strength = curves.strength.astype(np.float32)
            mesh.attributes.new("curvature", "FLOAT", "POINT").data.foreach_set("value", strength)
        _place(self._object("Input", mesh, collection, colours.NOISE), centre)

    def _templates(self, collection, named):
        homes = {id: self._collection(title[:63], collection) for id, title in named.items()}
        for id, home in homes.items():
            home["transformation"] = int(id)
        for t, template in enumerate(self.completion.templates):
            home = homes[template.transformation]
            # The empties stand in the middle of what they hold; the template's space may be far from it.
            centre = held_middle(np.concatenate([c.points for c in template.curves]))
            poses = np.array(template.occurrences, float)
            poses[:, :3, 3] = [moved(centre, pose) for pose in poses]
            off = poses[:, :3, 3] - held(poses[:, :3, 3])
            is_far = np.abs(off).max() > COARSE * self.completion.edge_length
            parts = None if is_far else self._parts(t, centre)
            for occurrence, pose in enumerate(poses):
                if is_far:
                    offset = pose[:3, :3].T @ off[occurrence]
                    pose[:3, 3] = held(pose[:3, 3])
                    parts = self._parts(t, centre - offset, f" at {occurrence + 1}")
                holder = self._holder(template, occurrence, pose, centre, home, self._name(t))
                if is_far:
                    holder[OFFSET] = offset.tolist()
                    self.step = max(self.step, float(np.spacing(np.abs(pose[:3, 3]).max().astype(np.float32))))
                self._occurrence(template, holder, pose, parts, home, self._name(t))

    def _name(self, t):
        """What template number t of the completion is called."""
        return self.names.get(self.completion.templates[t].id, f"Template {letters(t)}")

    def _parts(self, t, centre, place=""):
        """The curves of template number t about a centre, and their data; of one occurrence if its `place` is named."""
        template, name, made = self.completion.templates[t], self._name(t), []
        fits = [None] * len(template.curves) if self.fitted is None else self.fitted.templates[t]
        for i, (curve, fit) in enumerate(zip(template.curves, fits)):
            data = self._curve(f"{name} {i + 1}{place}", curve, fit, centre)
            data["part"] = i
            if place:
                data[TWIN], data[DIGEST] = f"{template.id} {i}", digest(data)
            made.append((curve, data))
        return made

    def _holder(self, template, occurrence, pose, centre, home, name):
        holder = self._object(f"{name} at {occurrence + 1}", None, home)
        holder.matrix_world = pose.T.tolist()  # nested sequences are columns here
        holder.empty_display_size = 0.1 * max(_radius(template, centre), 1e-6)
        holder["template"], holder["occurrence"] = int(template.id), occurrence
        return holder

    def _occurrence(self, template, holder, pose, parts, home, name):
        occurrence, place, back = holder["occurrence"], pose.T.tolist(), np.linalg.inv(pose).T.tolist()
        for (curve, data), support in zip(parts, template.evidence[occurrence].tolist()):
            part = self._object(f"{name} {data['part'] + 1} at {occurrence + 1}", data, home, colours.TEMPLATE)
            part.parent = holder
            if OFFSET not in holder:
                # Each has the occurrence as its own matrix, so that it stays where it is if the empty is deleted. Far
                # from the origin a matrix times its inverse is not one in single precision.
                part.matrix_parent_inverse, part.matrix_basis = back, place
            part["template"], part["occurrence"] = int(template.id), occurrence
            part["component"], part["support"] = int(curve.component), support
            if curve.component >= 0:
                self.components.setdefault(int(curve.component), []).append(part)

    def _components(self, collection):
        shown = self.completion.inputs.component
        for label in sorted({*self.components, *(int(c) for c in np.unique(shown) if c >= 0)}):
            home = self._collection(f"Component {label}", collection)
            home["component"] = label
            for part in self.components.get(label, ()):
                home.objects.link(part)
            pieces = np.flatnonzero(shown == label)
            if len(pieces):
                made = self._pieces(f"Component {label} input", pieces, home, colours.distinct(label))
                made.hide_viewport = made.hide_render = True
                made["component"] = label

    def _strong(self, collection):
        for i, curve in enumerate(self.completion.strong):
            centre = held_middle(curve.points)
            data = self._curve(f"Strong {i}", curve, self.fitted.strong[i] if self.fitted else None, centre)
            made = self._object(data.name, data, collection, colours.STRONG)
            _place(made, centre)
            made["template"] = made["occurrence"] = made["component"] = -1
            made["support"] = float(curve.support)

    def _pieces(self, name, pieces, collection, colour):
        """Input curves as one object."""
        polylines = [self.curves.curve(i) for i in pieces]
        centre = held_middle(np.concatenate(polylines))
        data = curve_data(name, [p - centre for p in polylines], self.curves.closed[pieces])
        self.made.append(data)
        made = self._object(name, data, collection, colour)
        _place(made, centre)
        return made


def _place(item, centre):
    """Move an object, so that its matrix is right at once: a hidden one is not evaluated."""
    matrix = np.eye(4)
    matrix[3, :3] = centre
    item.matrix_world = matrix.tolist()


def _radius(template, centre) -> float:
    return max(float(np.linalg.norm(c.points - centre, axis=1).max()) for c in template.curves)
