# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread: what it says, gives and raises, and that it stops."""

import threading
import time

import pytest


@pytest.fixture
def job(part):
    return part("fcn_addon.job.thread").Job


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
            progress("seeding", 0.1)
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
