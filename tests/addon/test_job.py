# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread: what it says, gives and raises, and that it stops."""

import threading
import time

import pytest


@pytest.fixture
def job(part):
    return part("fcn_addon.job").Job


def test_the_value(job):
    done = job(lambda progress: 7)
    done.start()
    assert done.join(5)
    assert (done.result, done.error, done.stopped, done.running) == (7, None, False, False)


def test_only_the_latest_news(job):
    def work(progress):
        for i in range(5):
            progress("blast", i / 10)

    done = job(work)
    assert done.news() is None
    done.start()
    done.join(5)
    assert done.news() == ("blast", 0.4)
    assert done.news() is None


def test_it_stops_at_the_next_progress(job):
    reached = threading.Event()

    def work(progress):
        while True:
            progress("voting", 0.1)
            reached.set()
            time.sleep(0.01)

    done = job(work)
    done.start()
    assert reached.wait(5)
    done.stop()
    assert done.join(5)
    assert done.stopped and done.result is None and done.error is None


def test_what_it_raises(job):
    def work(progress):
        raise MemoryError("all of it")

    done = job(work)
    done.start()
    assert done.join(5)
    assert isinstance(done.error, MemoryError) and done.result is None and not done.stopped


def test_waiting_has_an_end(job):
    go = threading.Event()
    done = job(lambda progress: go.wait(10))
    done.start()
    assert not done.join(0.05)
    go.set()
    assert done.join(5)


def test_one_that_never_began_can_be_waited_for(job):
    assert job(lambda progress: 1).join(0.1)


def test_progress_never_goes_back_and_ends_at_one(part):
    progress = part("fcn_addon.progress")
    assert sum(progress.SHARES.values()) == pytest.approx(1)
    assert list(progress.SHARES) == list(part("core.report").STAGES)
    assert list(progress.SCAN) == [*progress.DETECTION, *progress.SHARES] and set(progress.SCAN) == set(progress.LABELS)
    assert sum(progress.DETECTION.values()) == pytest.approx(1) == sum(progress.SCAN.values())
    run, seen = progress.Progress(10, 0.0), []
    for i, stage in enumerate(part("core.report").STAGES):
        for fraction in (0.0, 0.5, 0.2, 1.0):
            run.update(stage, fraction, float(i))
            seen.append(run.fraction)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1)
    assert run.left(5.0) == pytest.approx(0, abs=1e-9)


def test_time_left_starts_with_the_estimate_and_ends_with_what_is_measured(part):
    progress = part("fcn_addon.progress")
    run = progress.Progress(100, 0.0)
    assert run.left(0.0) == 100
    assert run.left(30.0) == 70
    run.update("completion", 0.0, 7.5)
    share = run.fraction
    assert share > 1 / 3  # from there on only what is measured counts
    assert run.left(7.5) == pytest.approx(7.5 * (1 - share) / share)
