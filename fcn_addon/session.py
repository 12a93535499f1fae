# SPDX-License-Identifier: GPL-3.0-or-later
"""The one run that may be under way: it begins from the scene, is watched, and ends with a result in the scene."""

from __future__ import annotations

import os
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..core.errors import Cancelled, InputError
from . import progress, results, scene_writer, sources, summary, views
from .job import Job

PATIENCE = 5.0  # seconds to wait for a thread that was asked to stop
GRACE = 0.3  # seconds that the window waits for it; what is still at work then is left to end by itself


@dataclass(frozen=True)
class Doing:
    """What a run does.

    take : (context) -> the task, with arrays instead of Blender's data; raises InputError
    seconds : (task) -> about how long it takes; in the thread
    work : (task, report) -> what comes out of it, in the thread
    finish : (context, task, what came out) -> what was put into the scene; raises InputError
    shares : stage -> share of the time that it takes, in the order of the stages
    beside : (task) -> the task for a thread beside the window
    """

    take: Callable
    seconds: Callable
    work: Callable
    finish: Callable
    shares: dict
    beside: Callable = lambda task: task


@dataclass
class Run:
    """A task at work.

    timer : of the window, kept here so that whatever ends the run can remove it
    asked : when it was asked to stop
    """

    doing: Doing
    task: object
    job: Job
    progress: progress.Progress
    timer: object = None
    shown: tuple = field(default=())
    asked: float | None = None

    @property
    def over(self) -> bool:
        """Whether there is nothing more to wait for."""
        late = self.asked is not None and time.monotonic() - self.asked > GRACE
        return late or not self.job.running


_run = None
_leaving = []  # jobs that were asked to stop and have not yet


def running() -> bool:
    """Whether a run is under way."""
    return _run is not None


def current():
    """The run that is under way, None if there is none."""
    return _run


def begin(context, doing=None) -> Run:
    """Take the task from the scene and start to work on it in a thread; it completes curves unless told otherwise.

    Raises InputError.
    """
    global _run
    if _run is not None:
        raise InputError("a run is under way; wait for it or cancel it")
    doing = doing or COMPLETE
    task = doing.take(context)
    ahead = progress.Progress(0.0, time.monotonic(), doing.shares)
    ours = doing.beside(task)

    def work(report):
        ahead.expect(doing.seconds(ours))  # that takes long enough for many curves to be felt in the window
        return doing.work(ours, report)

    _run = Run(doing, task, Job(work), ahead)
    _run.job.start()
    return _run


def leaving_room(parameters):
    """The parameters with one processor left to the window, unless the number of threads is set."""
    return parameters if parameters.threads else replace(parameters, threads=max(1, (os.cpu_count() or 2) - 1))


def run_now(context, report=None, doing=None):
    """The whole run at once, without a thread; what it put into the scene."""
    doing = doing or COMPLETE
    task = doing.take(context)
    return doing.finish(context, task, doing.work(task, report or (lambda stage, fraction: None)))


def _seconds(task) -> float:
    return summary.summarise(task.reading.curves, task.edge_length, task.parameters).seconds


def _work(task, report):
    """The method; this runs in the thread."""
    try:
        from ..core.pipeline import complete
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "scipy":
            raise
        raise InputError("scipy is missing: install the extension's zip for this platform again") from None
    return complete(task.reading.curves, edge_length=task.edge_length, parameters=task.parameters, progress=report)


def tick() -> bool:
    """Take in what the thread has said; whether what is shown has changed."""
    now = time.monotonic()
    news = _run.job.news()
    if news is not None:
        _run.progress.update(*news, now)
    shown = (_run.job.stopping, _run.progress.label, round(_run.progress.fraction, 2), round(_run.progress.left(now)))
    changed, _run.shown = shown != _run.shown, shown
    return changed


def outcome(run):
    """The Completion of a run that has ended. Raises Cancelled or InputError."""
    if run.job.stopped or run.job.stopping:
        raise Cancelled
    error = run.job.error
    if isinstance(error, InputError):
        raise error
    if isinstance(error, MemoryError):
        raise InputError("there is not enough memory for this; choose fewer curves or a longer edge length")
    if error is not None:
        traceback.print_exception(error)
        raise InputError(rpt_("a fault of the program: {error!r}; the console has the details").format(error=error))
    return run.job.result


def finish(context, task, completion):
    """Put a completion into the scene; the result's collection.

    Raises InputError where the source has gone. On any fault nothing is left behind.
    """
    gone = sources.missing(task)
    if gone:
        text = rpt_("{gone} has gone while its curves were completed; the result is not used")
        raise InputError(text.format(gone=gone))
    scene = task.scene.find(bpy.data.scenes)
    earlier = [r for r in results.of_scene(scene) if task.replace and r.fcn_result.source == task.label]
    length = scene_writer.unit_length(scene)
    root = scene_writer.write(completion, task.reading.curves, source=task.label, scene=scene, length=length)
    try:
        results.describe(root, completion, task, length)
        views.refresh(root)
    except BaseException:
        results.remove(root)
        raise
    for old in earlier:
        results.remove(old)
    root.name = f"FCN {task.label}"[:63]
    scene.fcn.result = root
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


COMPLETE = Doing(
    sources.take,
    _seconds,
    lambda task, report: _work(task, report),
    finish,
    progress.SHARES,
    lambda task: replace(task, parameters=leaving_room(task.parameters)),
)


def cancel():
    """Ask the run to stop; it ends within its next steps."""
    if _run is not None and _run.asked is None:
        _run.asked = time.monotonic()
        _run.job.stop()


def leave(context):
    """Forget the run without waiting for its thread, which ends at its next step; nothing takes its result then."""
    global _leaving
    if _run.job.running:
        _run.job.stop()
        _leaving = [job for job in (*_leaving, _run.job) if job.running]
    _forget(context)


def end(context=None):
    """Forget the run, and wait for all threads, which are asked to stop. Harmless where there is none."""
    if _run is not None:
        leave(context or bpy.context)
    until = time.monotonic() + PATIENCE
    while _leaving:
        _leaving.pop().join(max(until - time.monotonic(), 0.1))


def _forget(context):
    global _run
    run, _run = _run, None
    if run.timer is not None:
        timer, run.timer = run.timer, None
        context.window_manager.event_timer_remove(timer)
