# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that something ends: undo, a source that goes, a file that is loaded, the add-on switched off, Blender quit."""

import sys
import threading
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
from driver import EXTENSION, Driver  # noqa: E402
from whole_session import CATEGORY, settings, small  # noqa: E402

THREAD = "feature curve completion"


def threads():
    return [t for t in threading.enumerate() if t.name == THREAD]


def counts():
    return [len(c) for c in (bpy.data.objects, bpy.data.curves, bpy.data.meshes, bpy.data.collections)]


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]

    def start():
        with driver.context():
            assert bpy.ops.fcn.complete("INVOKE_DEFAULT") == {"RUNNING_MODAL"}

    small(driver)
    yield from driver.sidebar(CATEGORY)
    bpy.ops.ed.undo_push(message="ready")

    print("-- edits, undo and redo while it runs; the result comes all the same", flush=True)
    start()
    yield 0.5
    place = bpy.data.objects["Facade"].location.x
    bpy.data.objects["Facade"].location.x = place + 3
    bpy.ops.ed.undo_push(message="moved")
    with driver.context():
        bpy.ops.ed.undo()
    yield 0.5
    assert bpy.data.objects["Facade"].location.x == place and running.running()
    yield lambda: not running.running()
    yield 0.3
    assert settings().result is not None and not threads()
    with driver.context():
        bpy.ops.ed.undo()
    yield 0.5
    assert settings().result is None and not bpy.data.objects["Facade"].hide_get()
    with driver.context():
        bpy.ops.ed.redo()
    yield 0.5
    assert settings().result.fcn_result.templates
    driver.picture("after-redo")
    with driver.context():
        bpy.ops.ed.undo()
    bpy.data.orphans_purge()
    yield 0.3

    print("-- the source goes while it runs: the result is refused", flush=True)
    bpy.data.objects["Facade"].select_set(True)
    before = counts()
    start()
    yield 0.5
    bpy.data.objects.remove(bpy.data.objects["Facade"])
    yield lambda: not running.running()
    yield 0.5
    driver.picture("refused")
    assert settings().result is None and not threads()
    assert counts() == [before[0] - 1, *before[1:]], (before, counts())

    print("-- a file is loaded while it runs", flush=True)
    small(driver)
    start()
    yield 0.5
    assert threads()
    bpy.ops.wm.read_homefile(use_empty=True)
    yield 0.5
    assert not threads() and not running.running() and not len(bpy.data.curves)

    print("-- the add-on is switched off while it runs, and on again", flush=True)
    bpy.ops.wm.read_homefile()
    yield 0.5
    small(driver)
    before = counts()
    start()
    yield 0.5
    assert threads()
    bpy.ops.preferences.addon_disable(module=EXTENSION)
    yield 0.5
    assert not threads() and not hasattr(bpy.types.Scene, "fcn") and counts() == before
    # Blender lets go of the operator's handler with the next event of the window, and trips over it before.
    driver.move(300, 300)
    yield 0.2
    driver.move(310, 310)
    yield 0.2
    bpy.ops.preferences.addon_enable(module=EXTENSION)
    yield 0.5
    assert settings().result is None

    print("-- Blender is quit while it runs", flush=True)
    start()
    yield 0.5
    assert threads()


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
