# SPDX-License-Identifier: GPL-3.0-or-later
"""What must be done when Blender loads a file or the add-on goes."""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .detected import kept
from .job import session, summary, trial
from .properties import changes, preferences


@persistent
def _before_load(*_):
    session.end()
    summary.stop()
    trial.stop()
    kept.forget()


@persistent
def _after_load(path, *_):
    summary.changed()
    if not bpy.data.filepath:  # a new file
        for scene in bpy.data.scenes:
            preferences.begin(scene)


@persistent
def _after_update(scene, depsgraph):
    summary.watch(scene, depsgraph)


HANDLERS = (("load_pre", _before_load), ("load_post", _after_load), ("depsgraph_update_post", _after_update))


def register():
    for name, function in HANDLERS:
        getattr(bpy.app.handlers, name).append(function)
    changes.listen(summary.changed)
    changes.listen(trial.changed, changes.DETECTION)
    summary.changed()


def unregister():
    changes.forget(summary.changed)
    changes.forget(trial.changed)
    session.end()
    summary.stop()
    trial.stop()
    kept.forget()
    for name, function in HANDLERS:
        called = getattr(bpy.app.handlers, name)
        if function in called:
            called.remove(function)
