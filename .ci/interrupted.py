# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs run.py in Blender and presses Ctrl-C once it works, as a terminal would."""

import os
import runpy
import signal
import sys
import threading
import time
from pathlib import Path

root = Path(__file__).resolve().parent.parent
folder = Path(sys.argv[-1])


def press():
    while not list(folder.glob(".never.*")):  # there as soon as the run has begun
        time.sleep(0.01)
    time.sleep(0.1)
    os.kill(os.getpid(), signal.SIGINT)


threading.Thread(target=press, daemon=True).start()
sys.argv = [*sys.argv[: sys.argv.index("--") + 1], str(root / "examples/facade.obj")]
sys.argv += ["--report", str(folder / "never.json"), "--quiet"]
runpy.run_path(str(root / "run.py"), run_name="__main__")
