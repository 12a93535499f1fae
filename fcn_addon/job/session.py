# SPDX-License-Identifier: GPL-3.0-or-later
"""The one run that may be under way: it begins from the scene, is watched, and ends; what it does it is told."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import Cancelled, InputError
from .. import progress
from ..wording import duration
from .thread import Job

PATIENCE = 5.0  # seconds to wait for a thread that was asked to stop
GRACE = 0.3  # seconds that the window waits for it; what is still at work then is left to end by itself


@dataclass(frozen=True)
class RunKind:
    """What a run does.

    take : (context) -> the task, with arrays instead of Blender's data; raises InputError
    expected : (task) -> stage -> seconds that it takes, about, in the order of the stages; in the thread
    work : (task, report, expect) -> what comes out of it, in the thread; it calls expect with other seconds when it
        knows better
    finish : (context, task, what came out) -> what was put into the scene; raises InputError
    beside : (task) -> the task for a thread beside the window
    """

    take: Callable
    expected: Callable
    work: Callable
    finish: Callable
    beside: Callable = lambda task: task


@dataclass
class Run:
    """A task at work.

    timer : of the window, kept here so that whatever ends the run can remove it
    asked : when it was asked to stop
    """

    kind: RunKind
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


def begin(context, kind) -> Run:
    """Take the task from the scene and start to work on it in a thread.

    Raises InputError.
    """
    global _run
    if _run is not None:
        raise InputError("a run is under way; wait for it or cancel it")
    task = kind.take(context)
    ahead = progress.Progress({}, time.monotonic())
    ours = kind.beside(task)

    def work(report):
        ahead.expect(kind.expected(ours))  # that takes long enough for many curves to be felt in the window
        return kind.work(ours, report, ahead.expect)

    _run = Run(kind, task, Job(work), ahead)
    _run.job.start()
    context.window_manager.progress_begin(0, 100)
    return _run


def run_now(context, kind, report=None):
    """The whole run at once, without a thread; what it put into the scene."""
    task = kind.take(context)
    return kind.finish(context, task, kind.work(task, report or (lambda stage, fraction: None), lambda seconds: None))


def tick() -> bool:
    """Take in what the thread has said; whether what is shown has changed."""
    if _run is None:
        return False
    now = time.monotonic()
    news = _run.job.news()
    if news is not None:
        stage, fraction = news
        _run.progress.update(stage, fraction, now)
    else:
        _run.progress.look(now)
    share = min(round(_run.progress.fraction, 2), 0.99)  # all of it is over when the result is there
    shown = (_run.job.stopping, _run.progress.label, share, round(_run.progress.left(now)))
    changed, _run.shown = shown != _run.shown, shown
    if changed:
        _say(shown)
    return changed


def _say(shown):
    """The progress in the status bar and at the mouse, for those who have the sidebar closed."""
    stopping, label, fraction, left = shown
    text = rpt_("Feature Curves: {label}, {share:.0%}, {time} left. Esc over the viewport cancels")
    text = text.format(label=label, share=fraction, time=duration(left))
    bpy.context.window_manager.progress_update(round(100 * fraction))
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(rpt_("Feature Curves: stopping") if stopping else text)


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
    context.window_manager.progress_end()
    for window in context.window_manager.windows:
        window.workspace.status_text_set(None)
    if run.timer is not None:
        timer, run.timer = run.timer, None
        context.window_manager.event_timer_remove(timer)
