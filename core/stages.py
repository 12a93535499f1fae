# SPDX-License-Identifier: GPL-3.0-or-later
"""The stages of the method, their times and their progress."""

from __future__ import annotations

import time
from contextlib import contextmanager

STAGES = ("blast", "seeding", "growth", "orbits", "selection", "completion")
"""In the order in which they run; the names of the report and of the progress."""


class Clock:
    """Times the stages and reports the beginning and the end of each.

    report : called as report(stage, fraction), or None; may raise Cancelled
    seconds : dict, stage -> seconds
    """

    def __init__(self, report=None):
        self._report, self._last, self.seconds = report or (lambda stage, fraction: None), (STAGES[0], 0.0), {}

    def progress(self, stage, fraction):
        """Report where things stand."""
        self._last = (stage, fraction)
        self._report(stage, fraction)

    def tick(self, fraction=None):
        """Report where things stand once more, or a fraction of the present stage, so that the run can be stopped."""
        if fraction is not None:
            self._last = (self._last[0], fraction)
        self._report(*self._last)

    @contextmanager
    def stage(self, name):
        """The time in which a stage runs."""
        self.progress(name, 0.0)
        began = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = time.perf_counter() - began
        self.progress(name, 1.0)
