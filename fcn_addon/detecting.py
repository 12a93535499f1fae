# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that detect the feature curves of a scan, and the curves that are kept for the session to change thresholds."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from math import degrees

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ..core.errors import InputError
from . import curves_object, scans, working_copy
from .identity import Identity

LARGE = 1_000_000  # faces; above this many a smaller copy is offered
SECONDS_PER_FACE = 2.0e-5
KEPT = 4  # objects whose curves are kept


@dataclass(frozen=True)
class Task:
    """All that a run needs; nothing in it is Blender's.

    scan : scans.Scan; kinds : of ridges, valleys, sharp and boundary -> bool
    replace : remove the curves that were detected on this scan before
    method : Parameters to complete the curves with, None to leave them
    """

    label: str
    scene: Identity
    source: Identity
    scan: scans.Scan
    parameters: object
    kinds: dict
    replace: bool
    method: object = None


@dataclass(frozen=True)
class Measured:
    """The measurement of a scan, to try other thresholds on: a TriangleMesh and its Curvature."""

    fingerprint: bytes
    detail: float
    mesh: object
    field: object


@dataclass(frozen=True)
class Made:
    """What a run gave: FeatureCurves, the measurement, and the Completion where it was asked for."""

    found: object
    measured: Measured
    completion: object = None


_measured = {}  # name of the scan -> Measured; the last one only, it is large
_found = {}  # session_uid of the curves object -> (FeatureCurves, the object's origin)


def forget():
    """Drop all that is kept."""
    _measured.clear()
    _found.clear()


def scan_of(context):
    """The mesh with faces that a run would take: the active object if it is selected, else the only one selected."""
    surfaces = [o for o in context.selected_objects if o.type == "MESH" and len(o.data.polygons)]
    if context.active_object in surfaces:
        return context.active_object
    return surfaces[0] if len(surfaces) == 1 else None


def why_not(context) -> str | None:
    """What is missing for a run, None if nothing is. Cheap: it is asked at every redraw."""
    if context.mode != "OBJECT":
        return "Leave the edit mode first"
    if scan_of(context) is None:
        return "Select one mesh with faces"
    settings = context.scene.fcn.detection
    if not (settings.ridges or settings.valleys or settings.sharp or settings.boundary):
        return "Choose ridges, valleys, sharp edges or boundaries"
    return None


def take(context, complete=False) -> Task:
    """Read the scan and the settings. Raises InputError."""
    from ..core.detection.parameters import DetectionParameters
    from . import numbers, properties

    why = why_not(context)
    if why:
        raise InputError(why)
    item, settings = scan_of(context), context.scene.fcn.detection
    parameters = numbers.read(settings, DetectionParameters)
    method = properties.parameters(context.scene.fcn.parameters) if complete else None
    points, triangles = working_copy.read(item, context, settings.faces if settings.use_copy else None)
    return Task(
        item.name,
        Identity.of(context.scene),
        Identity.of(item),
        scans.Scan(f"object {item.name!r}", points, triangles),
        parameters,
        {name: getattr(settings, name) for name in ("ridges", "valleys", "sharp", "boundary")},
        context.scene.fcn.earlier == "REPLACE",
        method,
    )


def work(task, report) -> Made:
    """Detect, and complete where that is asked for; this runs in the thread."""
    scans.require_scipy()
    from ..core import detection

    fingerprint = _fingerprint(task.scan)
    known = _measured.get(task.label)
    try:
        if known is None or known.fingerprint != fingerprint or known.detail != task.parameters.detail:
            mesh = detection.TriangleMesh.of(task.scan.points, task.scan.triangles, progress=report)
            field = detection.measure(mesh, parameters=task.parameters, progress=report)
            known = Measured(fingerprint, task.parameters.detail, mesh, field)
        found = detection.detect(
            known.mesh, parameters=task.parameters, field=known.field, progress=report, **task.kinds
        )
    except InputError as error:
        raise InputError(f"{task.scan.name}: {error}") from None
    scans.require_curves(task.scan.name, found, task.parameters)
    if task.method is None:
        return Made(found, known)
    from ..core.pipeline import complete

    return Made(
        found, known, complete(found.curves, edge_length=found.edge_length, parameters=task.method, progress=report)
    )


def _fingerprint(scan) -> bytes:
    """What changes when the scan is edited, moved or made smaller in another way."""
    digest = hashlib.blake2b(np.ascontiguousarray(scan.points))
    digest.update(np.ascontiguousarray(scan.triangles))
    return digest.digest()


def finish(context, task, made):
    """Put the curves into the scene; their object. Raises InputError where the scan has gone."""
    scene, source = task.scene.find(bpy.data.scenes), task.source.find(bpy.data.objects)
    if scene is None or source is None or source.name not in scene.objects:
        text = rpt_("object {name!r} has gone while its curves were detected; they are not used")
        raise InputError(text.format(name=task.label))
    earlier = [o for o in scene.objects if task.replace and o.fcn_curves.scan == task.label and o.type == "MESH"]
    item = curves_object.make(f"{task.label} curves", made.found)
    scene.collection.objects.link(item)
    kept = item.fcn_curves
    kept.scan, kept.total, kept.shown = task.label, len(made.found), len(made.found)
    for old in earlier:
        remove(old)
    item.name = f"{task.label} curves"
    if context.scene == scene:
        for other in context.selected_objects:
            other.select_set(False)
        item.select_set(True)
        context.view_layer.objects.active = item
    _measured.clear()
    _measured[task.label] = made.measured
    _found[item.session_uid] = made.found, np.array(curves_object.middle(made.found.curves.points))
    while len(_found) > KEPT:
        del _found[next(iter(_found))]
    return item


def remove(item):
    """Remove a detected curves object."""
    data = item.data
    _found.pop(item.session_uid, None)
    bpy.data.objects.remove(item)
    if data.users == 0:
        bpy.data.meshes.remove(data)


def seconds(task) -> float:
    """A rough time for a run."""
    return 1.0 + SECONDS_PER_FACE * len(task.scan.triangles) * (1 if task.method is None else 15)


def can_change(item) -> bool:
    """Whether the thresholds of a detected curves object can be changed in this session."""
    return item.session_uid in _found


def update(group, _context):
    """Called by Blender when a threshold of a curves object changes: its mesh is made anew from the kept curves.

    Curves that the user has edited stay as they are; the thresholds have no say any more.
    """
    item = group.id_data
    kept = _found.get(item.session_uid)
    if kept is None or item.mode != "OBJECT":
        return
    found, centre = kept
    before = found.at_least(fold=degrees(group.applied_fold), length=group.applied_length)
    if not curves_object.holds(item.data, before, centre):
        del _found[item.session_uid]
        return
    now = found.at_least(fold=degrees(group.fold), length=group.length)
    curves_object.fill(item.data, now, centre)
    group.applied_fold, group.applied_length, group.shown = group.fold, group.length, len(now)
