# SPDX-License-Identifier: GPL-3.0-or-later
"""The run that detects the feature curves of a scan."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.detection.parameters import DetectionParameters
from ...core.errors import InputError
from .. import rates, scans
from ..detected import edge_mesh, kept
from ..detected.kept import Measured
from ..installation import require_scipy
from ..properties import from_parameters, preferences
from ..properties import settings as of_scene
from ..reading import reader, working_copy
from ..scene import libraries
from ..scene.identity import Identity
from ..wording import LEAVE_EDIT_MODE
from .session import RunKind

NO_KIND = "Choose ridges, valleys, sharp edges or boundaries"
KINDS = ("ridges", "valleys", "sharp", "boundary")


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
class Made:
    """What a run gave: FeatureCurves, the measurement, and where it was asked for the Completion and its primitives."""

    found: object
    measured: Measured
    completion: object = None
    fitted: object = None
    remarks: tuple[str, ...] = ()


def scan_of(context):
    """The mesh with faces, or the instances, that a run would take: the active object, else the only one selected."""
    depsgraph = context.view_layer.depsgraph
    surfaces = [o for o in context.selected_objects if reader.evaluated_faces(o, depsgraph) or _instances(o)]
    if context.active_object in surfaces:
        return context.active_object
    return surfaces[0] if len(surfaces) == 1 else None


def _instances(item) -> bool:
    return item.instance_type == "COLLECTION" and item.instance_collection is not None


def why_not(context) -> str | None:
    """What is missing for a run, None if nothing is. Cheap: it is asked at every redraw."""
    if context.mode != "OBJECT":
        return LEAVE_EDIT_MODE
    if scan_of(context) is None:
        return "Select one mesh with faces"
    settings = context.scene.fcn.detection
    if not any(getattr(settings, name) for name in KINDS):
        return NO_KIND
    return None


def take(context, complete=False) -> Task:
    """Read the scan and the settings. Raises InputError."""
    why = why_not(context)
    if why:
        raise InputError(why)
    item, settings = scan_of(context), context.scene.fcn.detection
    libraries.require_of([item])
    parameters = from_parameters.read(settings, DetectionParameters)
    method = of_scene.parameters(context.scene.fcn.parameters) if complete else None
    points, triangles = working_copy.read(item, context, settings.faces if settings.use_copy else None)
    return Task(
        item.name,
        Identity.of(context.scene),
        Identity.of(item),
        scans.Scan(f"object {item.name!r}", points, triangles),
        parameters,
        {name: getattr(settings, name) for name in KINDS},
        context.scene.fcn.earlier == "REPLACE",
        method,
    )


def work(task, report, expect=lambda seconds: None) -> Made:
    """Detect, and complete where that is asked for; this runs in the thread."""
    require_scipy()
    from ...core import detection

    fingerprint = _fingerprint(task.scan)
    known = kept.measured(task.label)
    try:
        if known is None or known.fingerprint != fingerprint or known.detail != task.parameters.detail:
            mesh = detection.TriangleMesh.of(task.scan.points, task.scan.triangles, progress=report)
            field = detection.measure(mesh, parameters=task.parameters, progress=report)
            known = Measured(fingerprint, task.parameters.detail, mesh, field, mesh.edge_length)
        found = detection.detect(
            known.mesh, parameters=task.parameters, field=known.field, progress=report, **task.kinds
        )
    except InputError as error:
        raise InputError(f"{task.scan.name}: {error}") from None
    scans.require_curves(task.scan.name, found, task.parameters)
    remarks = scans.remarks(task.scan, known.mesh, found.edge_length)
    if task.method is None:
        return Made(found, known, remarks=remarks)
    from ...core.fitting import fit_completion
    from ...core.pipeline import complete

    samples = _length(found.curves) / found.edge_length
    expect(rates.detecting(len(task.scan.triangles)) | rates.completing(samples))
    completion = complete(found.curves, edge_length=found.edge_length, parameters=task.method, progress=report)
    report("fitting", 0.0)
    fitted = fit_completion(completion, found.curves, smoothing=task.method.smoothing)
    return Made(found, known, completion, fitted, remarks)


def _length(curves) -> float:
    """Of all curves together."""
    step = np.linalg.norm(np.diff(curves.points, axis=0), axis=1)
    return float(step.sum() - step[curves.offsets[1:-1] - 1].sum())


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
    item = edge_mesh.make(f"{task.label} curves", made.found)
    scene.collection.objects.link(item)
    curves = item.fcn_curves
    curves.scan, curves.total, curves.shown = task.label, len(made.found), len(made.found)
    curves.remarks = "; ".join(made.remarks)
    curves.detail = made.found.detail
    for old in earlier:
        kept.remove(old)
    item.name = f"{task.label} curves"
    preferences.put(scene, item)
    context.view_layer.update()
    if context.scene == scene and item.name in context.view_layer.objects:  # which may exclude its collection
        for other in context.selected_objects:
            other.select_set(False)
        item.select_set(True)
        context.view_layer.objects.active = item
    kept.keep(task.label, made.measured, item, made.found)
    return item


def expected(task) -> dict:
    """Stage -> seconds that a run takes, about."""
    faces = len(task.scan.triangles)
    return rates.detecting(faces) | ({} if task.method is None else rates.completing(rates.PER_FACE * faces))


DETECT = RunKind(take, expected, work, finish)
