# SPDX-License-Identifier: GPL-3.0-or-later
"""The run that completes the chosen curves."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError
from ...core.files.reading import WELD, Reading
from ...core.parameters import Parameters
from .. import rates
from ..detected import scan_lock
from ..installation import require_scipy
from ..properties import preferences
from ..properties.settings import parameters
from ..reading import reader
from ..reading.left_out import LeftOut
from ..reading.visibility import shown
from ..result import stored, templates, views, writer
from ..scene import libraries, origin
from ..scene.identity import Identity
from ..scene.units import unit_length
from . import chosen
from .estimate import summarise
from .session import RunKind


@dataclass(frozen=True)
class Task:
    """All that a run needs, taken from the scene at once; nothing in it is Blender's.

    owner : (reading.count,) int64, which of `sources` each input curve comes from
    edge_length : scene units, None to estimate it
    replace : remove the earlier result of the same curves
    left_out : what of the chosen objects is not taken
    """

    label: str
    scene: Identity
    sources: tuple[Identity, ...]
    reading: Reading
    owner: np.ndarray
    edge_length: float | None
    parameters: Parameters
    replace: bool
    left_out: LeftOut = LeftOut()


def take(context, hidden=True) -> Task:
    """Read what the settings choose. Raises InputError where that cannot be used.

    hidden : evaluate hidden objects too, for which they are shown for a moment, draw curves as Blender does, and join
        them by position, as a run needs it; otherwise nothing in Blender is touched
    """
    why = chosen.why_not(context)
    if why:
        raise InputError(why)
    objects = chosen.chosen(context)
    libraries.require_of(objects)
    with shown(context, objects if hidden else ()):
        depsgraph = context.evaluated_depsgraph_get()
        read = reader.read_curves(objects, depsgraph, take_edges=context.scene.fcn.take_edges, quiet=not hidden)
        unit = chosen.edge_length(context, depsgraph) or (read.reading and read.reading.edge_length)
    gave = np.unique(read.owner)
    objects = [objects[i] for i in gave]
    return Task(
        chosen.label(context, objects),
        Identity.of(context.scene),
        tuple(Identity.of(item) for item in objects),
        _joined(read.reading, unit) if hidden else read.reading,
        np.searchsorted(gave, read.owner),
        unit,
        parameters(context.scene.fcn.parameters),
        context.scene.fcn.earlier == "REPLACE",
        chosen.passed_over(context) + read.left_out,
    )


def _joined(reading, edge_length) -> Reading:
    """The curves joined by position, as those of files are; input curves and their order stay."""
    require_scipy()
    from ...core.files.joining import join
    from ...core.network.edge_length import estimate_edge_length

    return join(reading, WELD * (edge_length or estimate_edge_length(reading.curves, crossings=reading.crossings)))


def leaving_room(parameters):
    """The parameters with one processor left to the window, unless the number of threads is set."""
    return parameters if parameters.threads else replace(parameters, threads=max(1, (os.cpu_count() or 2) - 1))


def _expected(task) -> dict:
    return rates.completing(summarise(task.reading.curves, task.edge_length, task.parameters).samples)


def _work(task, report):
    """The method; this runs in the thread."""
    require_scipy()
    from ...core.pipeline import complete

    return complete(task.reading.curves, edge_length=task.edge_length, parameters=task.parameters, progress=report)


def _work_and_fit(task, report):
    completion = _work(task, report)
    report("fitting", 0.0)
    return completion, _fitted(task, completion)


def _fitted(task, completion):
    """The curves of a completion as primitives; this runs in the thread."""
    from ...core.fitting import fit_completion

    return fit_completion(completion, task.reading.curves, smoothing=task.parameters.smoothing)


def finish(context, task, completion, fitted=None):
    """Put a completion into the scene; the result's collection. The primitives are made here if they were not before.

    Raises InputError where the source has gone. On any fault nothing is left behind.
    """
    gone = missing(task)
    if gone:
        text = rpt_("{gone} has gone while its curves were completed; the result is not used")
        raise InputError(text.format(gone=gone))
    scene = task.scene.find(bpy.data.scenes)
    earlier = [r for r in stored.of_scene(scene) if task.replace and r.fcn_result.source == task.label]
    length = unit_length(scene)
    form = scene.fcn.form
    fitted = _fitted(task, completion) if form == "HANDLES" and fitted is None else fitted
    names = templates.kept_names(earlier, completion)
    root = writer.write(
        completion, task.reading.curves, source=task.label, scene=scene, length=length, fitted=fitted, form=form,
        names=names, keep=preferences.keep(),
    )  # fmt: skip
    try:
        stored.describe(root, completion, task, length, names)
        origin.keep(root, origin.of(scene))
        preferences.paint(root)
        views.refresh(root)
    except BaseException:
        stored.remove(root)
        raise
    for old in earlier:
        stored.remove(old)
    if earlier:
        templates.settle_names(root)
    sources = [source.find(bpy.data.objects) for source in task.sources]
    preferences.put(scene, root)
    scan_lock.lock(root, scan_lock.scans_of(sources, scene.fcn))
    root.name = f"FCN {task.label}"[:63]
    scene.fcn.result = root
    scene.fcn.show_source = False
    _hide(context, scene, task)
    return root


def _hide(context, scene, task):
    """Hide the source, in the view layer only, and deselect it; the objects themselves are not changed."""
    layer = context.view_layer if context.scene == scene else scene.view_layers[0]
    for source in task.sources:
        item = source.find(bpy.data.objects)
        if item.name in layer.objects:
            item.select_set(False, view_layer=layer)
            item.hide_set(True, view_layer=layer)


def missing(task) -> str | None:
    """What of a task has gone from the file, in words; None if all is there."""
    scene = task.scene.find(bpy.data.scenes)
    if scene is None:
        return rpt_("scene {name!r}").format(name=task.scene.name)
    for source in task.sources:
        item = source.find(bpy.data.objects)
        if item is None or item.name not in scene.objects:
            return rpt_("object {name!r}").format(name=source.name)
    return None


COMPLETE = RunKind(
    take,
    _expected,
    lambda task, report, expect: _work_and_fit(task, report),
    lambda context, task, made: finish(context, task, *made),
    lambda task: replace(task, parameters=leaving_room(task.parameters)),
)
