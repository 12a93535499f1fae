# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the curves of results in their colours: Blender draws curves without bevel black, whatever their colour."""

from __future__ import annotations

import bpy
import gpu
import numpy as np
from bpy.app.handlers import persistent
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ..fcn_addon.colours import ADDED, DROPPED
from ..fcn_addon.job import trial
from ..fcn_addon.result import strokes

WIDTH = 2.0  # pixels, on a screen of usual density
FAINT = 0.3  # of their strength, while a template is edited
NEARER = 5e-4  # of the depth of the view

_handle = None
_batches = {}  # (scene, the viewport in local view or 0) -> what is drawn there, None for nothing
_known = set()  # session_uid of all that the batches depend on
_stale = True
_trial = None, None  # the outline that was drawn last, and its batch


def _draw():
    global _stale
    context = bpy.context
    space = context.space_data
    if not space.overlay.show_overlays:
        return
    if _stale:
        _batches.clear()
        _known.clear()
        _stale = False
    scene, pointer = context.scene.session_uid, space.as_pointer()
    if not space.local_view:
        _batches.pop((scene, pointer), None)  # the next local view may be of other objects
        pointer = 0
    if (scene, pointer) not in _batches:
        segments, colours, known = strokes.collect(context, space)
        _known.update(known)
        if context.mode != "OBJECT":
            colours[:, 3] *= FAINT
        _batches[scene, pointer] = _upload(segments, colours) if len(segments) else None
    for batch in (_batches[scene, pointer], _trial_batch()):
        if batch is not None:
            _draw_batch(batch, WIDTH * context.preferences.system.ui_scale)


def _trial_batch():
    """The outline of what other thresholds of detection would add and drop, None without one."""
    global _trial
    found = trial.latest()
    if not isinstance(found, trial.Trial):
        _trial = None, None
    elif _trial[0] is not found:
        segments = np.concatenate([found.added, found.dropped]).astype(np.float32)
        sizes = [len(found.added), len(found.dropped)]
        colours = np.repeat(np.array([(*ADDED, 1.0), (*DROPPED, 1.0)], np.float32), sizes, axis=0)
        _trial = found, _upload(segments, colours) if len(segments) else None
    return _trial[1]


def _draw_batch(batch, width):
    shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width)
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.blend_set("ALPHA")
    with gpu.matrix.push_pop_projection():
        # A little nearer than the black lines that Blender draws in the same place.
        nearer = Matrix.Translation((0.0, 0.0, -NEARER)) @ gpu.matrix.get_projection_matrix()
        gpu.matrix.load_projection_matrix(nearer)
        batch.draw(shader)
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")


def _upload(segments, colours):
    shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
    content = {"pos": segments.reshape(-1, 3), "color": colours.repeat(2, axis=0)}
    return batch_for_shader(shader, "LINES", content)


@persistent
def _after_update(scene, depsgraph):
    """The batches are stale where something in them has changed; a scene changes with what is selected or hidden."""
    global _stale
    if not _stale:
        _stale = any(
            update.id.session_uid in _known or update.id.id_type in {"SCENE", "COLLECTION"}
            for update in depsgraph.updates
        )


@persistent
def _after_change(*_):
    global _stale
    _stale = True


HANDLERS = (
    ("depsgraph_update_post", _after_update),
    ("load_post", _after_change),
    ("undo_post", _after_change),
    ("redo_post", _after_change),
)


def register():
    global _handle, _stale
    if bpy.app.background:
        return
    _handle, _stale = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_VIEW"), True
    for name, function in HANDLERS:
        getattr(bpy.app.handlers, name).append(function)


def unregister():
    global _handle, _trial
    if _handle is None:
        return
    _trial = None, None
    bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    for name, function in HANDLERS:
        kept = getattr(bpy.app.handlers, name)
        if function in kept:
            kept.remove(function)
    _handle = None
    _batches.clear()
    _known.clear()
