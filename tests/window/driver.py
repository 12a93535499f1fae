# SPDX-License-Identifier: GPL-3.0-or-later
"""Drives a real window of Blender as a user would: mouse, keys, pictures. Runs inside Blender.

A session is a generator. It yields a number of seconds to wait, or a function to wait for until it is true.
"""

import os
import subprocess
import sys
import threading
import time
import traceback

import bpy

EXTENSION = "bl_ext.user_default.fcn_addon"
STEP = 0.02  # seconds between two looks at what the session waits for
ROUNDS = 2  # of Blender's main loop, at least: a busy machine is slow to take in what the mouse does
PATIENCE = 300.0
SHARES, LEFT, RIGHT = (33, 62, 74), (11,), (83, 75)  # of the width of the sidebar, per cent: where buttons are


class Driver:
    """Mouse, keys and pictures of the first window; `pictures` is the folder for these."""

    def __init__(self, pictures):
        self.pictures = pictures
        os.makedirs(pictures, exist_ok=True)
        self.notes = []
        self.last = 0  # where a button was found last
        self.clicks = 0  # of the left button, that a user would make
        self.places = {}  # what was seen under the mouse -> where

    @property
    def window(self):
        return bpy.context.window_manager.windows[0]

    @property
    def area(self):
        return next(a for a in self.window.screen.areas if a.type == "VIEW_3D")

    def region(self, kind):
        return next(r for r in self.area.regions if r.type == kind)

    def context(self, kind="WINDOW"):
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.region(kind))

    def run(self, session):
        """Start; Blender ends with the session, with 1 where it failed."""
        bpy.context.preferences.view.show_splash = False
        bpy.context.preferences.view.smooth_view = 0
        self._session, self._wait, self._since, self._rounds = session, 0.5, time.monotonic(), 0
        bpy.app.timers.register(self._step, first_interval=0.5, persistent=True)

    def _step(self):
        now = time.monotonic()
        try:
            if callable(self._wait):
                if not self._wait():
                    if now - self._since > PATIENCE:
                        raise TimeoutError(f"waited {PATIENCE:g} s in vain")
                    return STEP
            elif now - self._since < self._wait or self._rounds < ROUNDS:
                self._rounds += 1
                return STEP
            self._wait, self._since, self._rounds = next(self._session), time.monotonic(), 0
            return STEP
        except StopIteration:
            print("window session: all as it should be", flush=True)
            self._quit(0)
        except BaseException:
            traceback.print_exc()
            frame = self._session.gi_frame
            print(f"window session: failed{f' at line {frame.f_lineno}' if frame else ''}", flush=True)
            self.picture("failed")
            self._quit(1)
        return None

    def _quit(self, code):
        sys.stdout.flush()
        sys.stderr.flush()
        if code:
            os._exit(code)
        bpy.ops.wm.quit_blender()

    # mouse and keys

    def event(self, kind, value, x=0, y=0, **more):
        self.window.event_simulate(type=kind, value=value, x=int(x), y=int(y), **more)

    def move(self, x, y):
        self.event("MOUSEMOVE", "NOTHING", x, y)

    def click(self, x, y):
        """Move there and press the left button; a generator."""
        self.clicks += 1
        self.move(x - 1, y)
        yield 0.05
        self.move(x, y)
        yield 0.1
        self.event("LEFTMOUSE", "PRESS", x, y)
        yield 0.05
        self.event("LEFTMOUSE", "RELEASE", x, y)
        yield 0.1

    def drag(self, x, y, to_x, steps=12):
        """Press at a place, move sideways, release; a generator."""
        self.move(x, y)
        yield 0.1
        self.event("LEFTMOUSE", "PRESS", x, y)
        yield 0.05
        for i in range(1, steps + 1):
            self.move(x + (to_x - x) * i / steps, y)
            yield 0.05
        self.event("LEFTMOUSE", "RELEASE", to_x, y)
        yield 0.2

    def key(self, kind, x=None, y=None, **more):
        """Press a key over the middle of the viewport, or at a place; a generator."""
        region = self.region("WINDOW")
        x = region.x + region.width // 3 if x is None else x
        y = region.y + region.height // 2 if y is None else y
        self.move(x, y)
        yield 0.1
        self.event(kind, "PRESS", x, y, **more)
        yield 0.05
        self.event(kind, "RELEASE", x, y)
        yield 0.1

    def find(self, wanted, found, near=False, shares=SHARES):
        """Look for a button of the sidebar by moving the mouse over it; a generator that fills the list `found`.

        wanted : part of what "Copy Python Command" or "Copy Data Path" gives for the button
        found : gets (x, y) of the first place, from the top
        near : look about the button that was found last first
        shares : of the width, per cent, where it is looked for
        """
        region = self.region("UI")
        for place in [self.places[name] for name in self.places if wanted in name]:  # where it was before
            self.move(*place)
            yield 0.2
            if wanted in self.under_mouse():
                found.append(place)
                return
        top, bottom = region.y + region.height - 40, region.y + 10
        rows = [*range(top, bottom, -18), *range(top - 9, bottom, -18)]  # a button is 20 high
        if near and self.last:
            rows.sort(key=lambda y: abs(y - self.last))
        for y in rows:
            for x in (region.x + region.width * share // 100 for share in shares):
                self.move(x, y)
                yield 0.03
                said = self.under_mouse()
                if said:
                    self.places[said] = x, y
                if wanted in said:
                    self.last = y
                    found.append((x, y))
                    return
        raise LookupError(f"no button {wanted!r} in the sidebar; there are {sorted(self.places)}")

    def under_mouse(self):
        """What Blender says of the button under the mouse, "" where there is none."""
        manager = bpy.context.window_manager
        for name in ("copy_python_command_button", "copy_data_path_button"):
            operator = getattr(bpy.ops.ui, name)
            with self.context("UI"):
                if operator.poll():
                    manager.clipboard = ""
                    operator()
                    if manager.clipboard:
                        return manager.clipboard
        return ""

    def press(self, wanted, near=False, shares=SHARES):
        """Find a button of the sidebar and click it, see `find`; a generator."""
        found = []
        yield from self.find(wanted, found, near, shares)
        yield from self.click(*found[0])

    def choose(self, name, column, row):
        """Click a button of a switch with two columns in the sidebar, the property of which is known; a generator."""
        found = []
        yield from self.find(name, found)
        region = self.region("UI")
        x = region.x + region.width * (1 + 2 * column) // 4 - 10
        yield from self.click(x, found[0][1] - 4 - 22 * row)
        yield 0.3

    # what is seen

    def sidebar(self, category):
        """Open the sidebar at a tab; a generator."""
        self.area.spaces.active.show_region_ui = True
        yield 0.4
        region = self.region("UI")
        while region.active_panel_category != category:  # it has no tabs before it is drawn
            region.active_panel_category = category
            region.tag_redraw()
            yield 0.1
        self.move(region.x + 60, region.y + region.height // 2)
        yield 0.4

    def picture(self, name):
        """Take a picture of the screen (Blender's own screenshot is black without a graphics card)."""
        path = os.path.join(self.pictures, f"{name}.png")
        with bpy.context.temp_override(window=self.window):  # what was tagged may not be drawn yet
            bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
        subprocess.run(["import", "-window", "root", "+dither", "-colors", "255", path], check=True)

    def note(self, text):
        self.notes.append(text)
        print("measured:", text, flush=True)


class Redraws:
    """Measures how long the window goes without a redraw; asks for one all the time.

    It is the header of the viewport that is drawn: without a graphics card the scene alone takes longer than what is
    to be measured.
    """

    REGION = "HEADER"

    def __init__(self, driver):
        self.driver, self.times = driver, []

    def __enter__(self):
        self._handle = bpy.types.SpaceView3D.draw_handler_add(self._drawn, (), self.REGION, "POST_PIXEL")
        self._asking = self._ask  # Blender knows a timer by its function object, and each self._ask is a new one
        bpy.app.timers.register(self._asking)
        return self

    def __exit__(self, *_):
        bpy.app.timers.unregister(self._asking)
        bpy.types.SpaceView3D.draw_handler_remove(self._handle, self.REGION)

    def _drawn(self):
        self.times.append(time.monotonic())

    def _ask(self):
        self.driver.region(self.REGION).tag_redraw()
        return 0.0

    @property
    def longest(self):
        """Seconds of the longest gap."""
        return max((b - a for a, b in zip(self.times, self.times[1:])), default=float("inf"))

    @property
    def median(self):
        gaps = sorted(b - a for a, b in zip(self.times, self.times[1:]))
        return gaps[len(gaps) // 2] if gaps else float("inf")


class Held:
    """Measures how long Python is not to be had for the window: a thread sees how late it wakes."""

    PAUSE = 0.001

    def __init__(self):
        self.longest, self._over = 0.0, threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()

    def _look(self):
        while not self._over.is_set():
            before = time.perf_counter()
            time.sleep(self.PAUSE)
            self.longest = max(self.longest, time.perf_counter() - before - self.PAUSE)
