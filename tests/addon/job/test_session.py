# SPDX-License-Identifier: GPL-3.0-or-later
"""A run under way: it is watched, stopped, and ends with the file and with the add-on."""

import dataclasses
import threading
import time

import pytest


def count(bpy):
    return [len(c) for c in (bpy.data.objects, bpy.data.curves, bpy.data.meshes, bpy.data.collections)]


@pytest.fixture
def slow(bpy, part, wall, completion, monkeypatch):
    """A run that goes on until it is stopped."""
    session, completing = part("fcn_addon.job.session"), part("fcn_addon.job.completing")

    def work(task, report):
        for i in range(2000):
            report("growth", i / 2000)
            time.sleep(0.005)
        return completion

    monkeypatch.setattr(completing, "_work", work)
    run = session.begin(bpy.context, completing.COMPLETE)
    yield run
    session.end()


def wait(run, session):
    for _ in range(200):
        if session.tick():
            return
        time.sleep(0.01)
    raise AssertionError("no news")


def test_a_run_is_watched_and_stopped(bpy, part, slow):
    session = part("fcn_addon.job.session")
    before = count(bpy)
    wait(slow, session)
    time.sleep(0.05)
    assert session.tick() or slow.shown
    assert slow.shown[1] == "Growing what recurs" and 0 < slow.shown[2] < 0.6 and slow.shown[3] > 0
    with pytest.raises(RuntimeError, match="under way"):
        bpy.ops.fcn.complete()
    assert bpy.ops.fcn.cancel() == {"FINISHED"}
    assert slow.job.join(5)
    session.end()
    with pytest.raises(part("core.errors").Cancelled):
        session.outcome(slow)
    assert count(bpy) == before and not session.running()


def test_the_time_is_estimated_beside_the_window(bpy, part, wall, work, monkeypatch):
    session, completing = part("fcn_addon.job.session"), part("fcn_addon.job.completing")
    where = []

    def expected(task):
        where.append(threading.current_thread())
        return {"blast": 1000.0, "growth": 234.0}

    kind = dataclasses.replace(completing.COMPLETE, expected=expected, work=lambda task, report, expect: 1)
    run = session.begin(bpy.context, kind)
    try:
        assert run.job.join(5) and where == [run.job._thread]
        session.tick()
        assert 1200 < run.shown[3] <= 1234
    finally:
        session.end()


def test_only_one_run_at_a_time(bpy, part, slow):
    with pytest.raises(part("core.errors").InputError, match="under way"):
        part("fcn_addon.job.session").begin(bpy.context, part("fcn_addon.job.completing").COMPLETE)


def test_loading_a_file_ends_the_run(bpy, part, slow):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not slow.job.running and slow.job.stopped
    assert not part("fcn_addon.job.session").running()


def test_disabling_ends_the_run(bpy, part, slow):
    registration = part("fcn_addon.registration")
    registration.unregister()
    try:
        assert not slow.job.running and slow.job.stopped
    finally:
        registration.register()


def test_undo_does_not_disturb_a_run(bpy, part, wall, monkeypatch, completion):
    session, completing = part("fcn_addon.job.session"), part("fcn_addon.job.completing")
    bpy.ops.ed.undo_push(message="before")
    bpy.data.objects["Wall"].location.x = 5
    bpy.ops.ed.undo_push(message="moved")
    monkeypatch.setattr(completing, "_work", lambda task, report: completion)
    run = session.begin(bpy.context, completing.COMPLETE)
    assert run.job.join(5)
    bpy.ops.ed.undo()
    session.tick()
    session.end()
    root = completing.finish(bpy.context, run.task, *session.outcome(run))
    assert root.fcn_result.occurrences == 6
    assert bpy.data.objects["Wall"].location.x == 0 and bpy.data.objects["Wall"].hide_get()
