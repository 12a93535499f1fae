# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in a thread of its own, which can be watched and stopped. Only arrays cross the border; Blender is not known."""

from __future__ import annotations

import threading
import traceback
from queue import Empty, SimpleQueue

from ...core.errors import Cancelled


class Job:
    """Runs `work(progress)` in a thread.

    After it ended one of these holds: `result` is its value, `error` what it raised, `stopped` is True.
    """

    def __init__(self, work):
        self._work = work
        self._news = SimpleQueue()
        self._stop = threading.Event()
        self.result = self.error = None
        self.stopped = False
        # A daemon: an exit that could not wait for it is not held up.
        self._thread = threading.Thread(target=self._run, name="feature curve completion", daemon=True)

    def start(self):
        self._thread.start()

    def _run(self):
        try:
            self.result = self._work(self._progress)
        except Cancelled:
            self.stopped = True
        except Exception as error:
            traceback.clear_frames(error.__traceback__)
            self.error = error

    def _progress(self, stage, fraction):
        if self._stop.is_set():
            raise Cancelled
        self._news.put((stage, float(fraction)))

    def news(self):
        """The latest (stage, fraction), None if nothing has come since the last call."""
        latest = None
        while True:
            try:
                latest = self._news.get_nowait()
            except Empty:
                return latest

    def stop(self):
        """Ask it to stop; it does at its next progress."""
        self._stop.set()

    @property
    def stopping(self) -> bool:
        return self._stop.is_set()

    @property
    def running(self) -> bool:
        return self._thread.is_alive()

    def join(self, seconds=None) -> bool:
        """Wait until it has ended; False if it has not within that time."""
        if self._thread.ident is not None:
            self._thread.join(seconds)
        return not self.running
