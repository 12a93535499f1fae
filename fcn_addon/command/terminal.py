# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line says while it works, on stderr."""

from __future__ import annotations

import sys
import time

from ..wording import duration


class Terminal:
    """Messages and progress.

    In a terminal the progress stays on one line; in a log it is a line every tenth, not more than one a second, and
    one when a stage is done.
    """

    def __init__(self, quiet=False, stream=None, clock=time.monotonic):
        self.stream = stream or sys.stderr
        self.quiet = quiet
        self._clock = clock
        self._live = hasattr(self.stream, "isatty") and self.stream.isatty()
        self._stage, self._began, self._shown, self._at, self._open = None, 0.0, -1, -1.0, False

    def say(self, message):
        """A line of its own."""
        if not self.quiet:
            self._end_line()
            print(message, file=self.stream, flush=True)

    def error(self, message):
        """A line that quiet does not silence."""
        self._end_line()
        print(" ".join(f"error: {message}".split()), file=self.stream, flush=True)

    def progress(self, stage, fraction):
        """Show the stage, its percentage and the time it will still take."""
        now = self._clock()
        if stage != self._stage:
            self._stage, self._began, self._shown = stage, now, -1
        if self.quiet:
            return
        percent = int(100 * min(max(fraction, 0.0), 1.0))
        step = 1 if self._live else 10
        done = percent == 100
        if percent // step == self._shown // step and not (done and self._shown < 100):
            return
        if now - self._at < (0.1 if self._live else 1.0) and not done:
            return
        self._shown, self._at = percent, now
        elapsed = now - self._began
        left = f"{duration(elapsed / fraction - elapsed)} left" if 0 < fraction < 1 else duration(elapsed) * done
        line = f"{stage:<11} {percent:3d}%  {left}".rstrip()
        if self._live:
            self.stream.write("\r" + line.ljust(60))
            self._open = True
            if done:
                self._end_line()
        else:
            self.stream.write(line + "\n")
        self.stream.flush()

    def _end_line(self):
        if self._open:
            self.stream.write("\n")
            self._open = False
