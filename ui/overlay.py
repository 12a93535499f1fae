# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the curves of results in their colours: Blender draws curves without bevel black, whatever their colour."""

from __future__ import annotations

import bpy
import gpu
from bpy.app.handlers import persistent
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ..fcn_addon import strokes

WIDTH = 2.0  # pixels, on a screen of usual density
NEARER = 5e-4  # of the depth of the view

_handle = None
_batch = None
_known = set()  # session_uid of all that the batch depends on
_scene = None  # session_uid of the scene that the batch is of
_stale = True


def _draw():
    global _batch, _known, _scene, _stale
    context = bpy.context
    space = context.space_data
    if space.local_view or not space.overlay.show_overlays:
        return
    if _stale or _scene != context.scene.session_uid:
        segments, colours, _known = strokes.collect(context)
        _scene, _stale = context.scene.session_uid, False
        _batch = _upload(segments, colours) if len(segments) else None
    if _batch is not None:
        _draw_batch(_batch, WIDTH * context.preferences.system.ui_scale)


def _draw_batch(batch, width):
    shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", width)
    gpu.state.depth_test_set("LESS_EQUAL")
    with gpu.matrix.push_pop_projection():
        # A little nearer than the black lines that Blender draws in the same place.
        nearer = Matrix.Translation((0.0, 0.0, -NEARER)) @ gpu.matrix.get_projection_matrix()
        gpu.matrix.load_projection_matrix(nearer)
        batch.draw(shader)
    gpu.state.depth_test_set("NONE")


def _upload(segments, colours):
    shader = gpu.shader.from_builtin("POLYLINE_FLAT_COLOR")
    content = {"pos": segments.reshape(-1, 3), "color": colours.repeat(2, axis=0)}
    return batch_for_shader(shader, "LINES", content)


@persistent
def _after_update(scene, depsgraph):
    """The batch is stale where something that it shows has changed; a scene changes with what is selected or hidden."""
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
    global _handle, _batch, _known
    if _handle is None:
        return
    bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    for name, function in HANDLERS:
        kept = getattr(bpy.app.handlers, name)
        if function in kept:
            kept.remove(function)
    _handle, _batch, _known = None, None, set()
