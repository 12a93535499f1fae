# SPDX-License-Identifier: GPL-3.0-or-later
"""How a run of the tests ends.

Blender 4.2 as a module brings the process down in exit() once anything was exported as glTF, with nothing of ours
loaded: `import bpy; bpy.ops.export_scene.gltf(filepath="cube.glb")` ends with signal 11. Its static data are freed
after Python is gone (`SpaceType::~SpaceType` calls `bpy_class_free`). Blender 4.5 may wait in exit() without end: what
it frees there is in use by a thread of its own (`delayed_close_thread_run`); this was seen once. Later versions end as
they should. With these two the process therefore ends right after pytest's last word, with pytest's own exit code. A
crash within a test comes before that and shows; that our own program ends well is tested where it runs in a process of
its own.
"""

import atexit
import os
import sys

import pytest

_code = pytest.StashKey[int]()


def pytest_sessionfinish(session, exitstatus):
    session.config.stash[_code] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    bpy = sys.modules.get("bpy")
    if bpy is None or bpy.app.version >= (5, 0) or _code not in config.stash:
        return
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(config.stash[_code])
