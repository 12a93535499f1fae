# SPDX-License-Identifier: GPL-3.0-or-later
"""What other thresholds would add to detected curves and drop of them, before a run: an outline in the viewport.

While the measurement of a scan is kept, its curves are traced again in a thread, a moment after a threshold changed.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...core.errors import InputError
from ...core.values import Curves
from .. import timers
from ..detected import kept
from ..properties import from_parameters
from ..scene import viewports
from . import detecting, session
from .thread import Job

DELAY, TICK = 0.3, 0.1  # seconds of quiet before it is looked at, and between two looks at the thread
SAME = 0.25  # edge lengths within which a stretch of curve counts as the same


@dataclass(frozen=True)
class Trial:
    """What a change of thresholds would do.

    added, dropped : (k, 2, 3) float64, segments in the world
    longer, shorter : how much of all curves that is, as a share of what is shown now
    """

    added: np.ndarray
    dropped: np.ndarray
    longer: float
    shorter: float


_latest = None  # Trial, or words that say why there is none
_about = -1  # session_uid of the curves that it is about
_job = None


def latest():
    """The Trial, or words that say why there is none, or None where nothing was tried or its curves have gone."""
    return _latest if kept.has(_about) else None


def changed():
    """Look again, soon: a threshold has changed."""
    timers.soon(_start, DELAY)


def stop():
    """Forget what was tried, and try nothing more."""
    global _latest, _about, _job
    timers.never(_start, _watch)
    if _job is not None:
        _job.stop()
    _latest, _about, _job = None, -1, None


def _start():
    global _job, _latest, _about
    if session.running():
        return DELAY
    if _job is not None:
        _job.stop()
    about, work = prepare(bpy.context)
    _job, _about = None, about
    if not callable(work):
        _latest = work
        viewports.redraw(bpy.context)
        return None
    _job = Job(work)
    _job.start()
    timers.soon(_watch, TICK)
    return None


def _watch():
    global _job, _latest
    if _job is None:
        return None
    if _job.running:
        return TICK
    if not _job.stopped:
        _latest = str(_job.error) if isinstance(_job.error, InputError) else _job.result
    _job = None
    viewports.redraw(bpy.context)
    return None


def prepare(context):
    """The session_uid of the detected curves, and a function (report) -> Trial, or words that say why there is none.

    Nothing of Blender is touched by the function.
    """
    chosen = shown_curves(context)
    if chosen is None:
        return -1, None
    item, label = chosen
    settings, known = context.scene.fcn.detection, kept.measured(label)
    try:
        parameters = from_parameters.read(settings, detecting.DetectionParameters)
    except InputError as error:
        return item.session_uid, str(error)
    if parameters.detail != known.detail:
        return item.session_uid, "Another detail is measured by the run"
    kinds = {name: getattr(settings, name) for name in detecting.KINDS}
    if not any(kinds.values()):
        return item.session_uid, detecting.NO_KIND
    now, centre = kept.shown(item)
    matrix = np.array(item.matrix_world, float)
    matrix[:3, 3] -= matrix[:3, :3] @ centre

    def work(report):
        from ...core import detection

        then = detection.detect(known.mesh, parameters=parameters, field=known.field, progress=report, **kinds)
        return compare(now.curves, then.curves, SAME * then.edge_length, matrix)

    return item.session_uid, work


def shown_curves(context):
    """(object, name of its scan) of the detected curves that a trial is about, None where nothing is kept of any.

    Those that are active, or those of the scan that is.
    """
    item, scan = context.active_object, detecting.scan_of(context)
    if item is None or not item.fcn_curves.scan:
        found = [o for o in context.scene.objects if scan is not None and o.fcn_curves.scan == scan.name]
        item = next((o for o in found if kept.can_change(o)), None)
    if item is None or not kept.can_change(item) or kept.measured(item.fcn_curves.scan) is None:
        return None
    return item, item.fcn_curves.scan


def compare(now: Curves, then: Curves, near, matrix) -> Trial:
    """Which stretches of `then` are not near `now`, and the other way round.

    near : how far apart stretches of the same curve are, in the units of the curves
    matrix : (4, 4), from their space to the world
    """
    a, b = _segments(now), _segments(then)
    added, dropped = b[_far(b, a, near)], a[_far(a, b, near)]
    whole = max(_length(a), 1e-300)

    def placed(segments):
        return segments @ matrix[:3, :3].T + matrix[:3, 3]

    return Trial(placed(added), placed(dropped), _length(added) / whole, _length(dropped) / whole)


def _segments(curves):
    """(k, 2, 3) float64."""
    if not len(curves.points):
        return np.zeros((0, 2, 3))
    after = np.arange(1, len(curves.points) + 1)
    ends = curves.offsets[1:] - 1
    after[ends] = np.where(curves.closed, curves.offsets[:-1], ends)
    segments = np.stack([curves.points, curves.points[after]], axis=1)
    return segments[(segments[:, 0] != segments[:, 1]).any(axis=1)]


def _far(segments, others, near):
    """(k,) bool, segments whose middle is further than that from all of the others."""
    from scipy.spatial import cKDTree

    if not len(segments) or not len(others):
        return np.ones(len(segments), bool)
    t = np.linspace(0, 1, 5)[:, None, None]
    points = ((1 - t) * others[:, 0] + t * others[:, 1]).reshape(-1, 3)
    return cKDTree(points).query(segments.mean(axis=1), distance_upper_bound=near)[0] > near


def _length(segments):
    return float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum())
