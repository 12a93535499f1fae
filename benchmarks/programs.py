# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs run as processes of their own, with what they took."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DEFAULT = (sys.executable, str(ROOT / "run.py"))
"""The headless program, under this Python."""


@dataclass(frozen=True)
class Run:
    """What a process took.

    code : exit code; negative where a signal ended it
    wall, cpu : seconds
    peak : bytes of resident memory at most
    in_time : whether it ended by itself
    said : the last lines of what it printed
    """

    code: int
    wall: float
    cpu: float
    peak: int
    in_time: bool
    said: str


def run(command, *, limit: float) -> Run:
    """Run a command, a list of words, in the project's folder; it is ended after `limit` seconds.

    Time and memory are those that the system counts for the process and for the children it waited for.
    """
    begin, late = time.perf_counter(), threading.Event()
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, cwd=ROOT)

        def end():
            late.set()
            process.kill()

        timer = threading.Timer(limit, end)
        timer.start()
        try:
            _, status, usage = os.wait4(process.pid, 0)
        finally:
            timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.perf_counter() - begin
        said.seek(0)
        text = said.read().decode(errors="replace")
    unit = 1 if sys.platform == "darwin" else 1024
    return Run(
        code=process.returncode,
        wall=wall,
        cpu=usage.ru_utime + usage.ru_stime,
        peak=usage.ru_maxrss * unit,
        in_time=not late.is_set(),
        said="\n".join(text.strip().splitlines()[-5:]),
    )
