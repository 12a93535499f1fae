# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the window stands still while 16,000 samples and more are completed, from the button to the result.

By hand, on a machine that does nothing else: `.ci/real_blender .ci/in_window out/pictures large_session`.
"""

import sys
import time
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
from driver import EXTENSION, Driver, Held, Redraws  # noqa: E402
from whole_session import CATEGORY, prepare, result, settings  # noqa: E402

COPIES = 3  # of the example, side by side: each has 6,879 samples


def several():
    """The example several times over, as one edge mesh."""
    item = bpy.data.objects["Facade"]
    width = 1.25 * item.dimensions.x
    array = item.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = COPIES, False, True
    array.constant_offset_displace = (width, 0, 0)


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    running = sys.modules[f"{EXTENSION}.fcn_addon.job.session"]
    latest = sys.modules[f"{EXTENSION}.fcn_addon.job.summary"]
    prepare(driver)
    several()
    yield from driver.sidebar(CATEGORY)
    yield lambda: not isinstance(latest.latest(), str | None) and latest.latest().samples >= 16_000
    driver.note(f"{latest.latest().samples:,} samples, {latest.latest().strong} strong curves")
    found = []
    yield from driver.find("bpy.ops.fcn.complete()", found)
    with Redraws(driver) as idle:
        yield 3.0
    driver.note(f"redraws without a run: {1000 * idle.median:.0f} ms, longest {1000 * idle.longest:.0f} ms")
    with Redraws(driver) as start:
        yield from driver.click(*found[0])
        yield running.running
        yield 1.0
    driver.note(f"the button: longest {1000 * start.longest:.0f} ms")
    began = time.monotonic()
    with Redraws(driver) as busy, Held() as held:
        yield lambda: running.current() is None or not running.current().job.running
    driver.note(f"during the run: {1000 * busy.median:.0f} ms, longest {1000 * busy.longest:.0f} ms")
    driver.note(f"Python was held for at most {1000 * held.longest:.0f} ms of it")
    with Redraws(driver) as end:
        yield lambda: not running.running()
        yield 1.0
    count = len(settings().result.all_objects)
    driver.note(f"the result appears: longest {1000 * end.longest:.0f} ms, {count:,} objects")
    driver.note(f"{time.monotonic() - began:.0f} s in all, the method itself {result().seconds:.0f} s")
    assert result().templates
    driver.picture("large-result")


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
