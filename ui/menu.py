# SPDX-License-Identifier: GPL-3.0-or-later
"""The entries of the Object menu, which are also those that the search finds."""

from __future__ import annotations

import bpy

ENTRIES = (
    "fcn.detect",
    "fcn.complete_scan",
    "fcn.complete",
    "fcn.cancel",
    None,
    "fcn.select_template",
    "fcn.select_transformation",
    "fcn.select_occurrence",
    "fcn.select_source",
    "fcn.select_result",
    None,
    "fcn.reject_transformation",
    "fcn.reject_occurrence",
    "fcn.restore",
    "fcn.delete_occurrence",
    None,
    "fcn.make_unique",
    "fcn.edit_template",
    "fcn.apply",
    "fcn.export_curves",
    "fcn.remove_result",
    None,
    "fcn.import_curves",
    "fcn.try_example",
    "fcn.manual",
)


class FCN_MT_object(bpy.types.Menu):
    bl_idname = "FCN_MT_object"
    bl_label = "Feature Curves"

    def draw(self, context):
        for entry in ENTRIES:
            if entry is None:
                self.layout.separator()
            else:
                self.layout.operator(entry)


def _draw(self, context):
    self.layout.separator()
    self.layout.menu(FCN_MT_object.bl_idname)


def _draw_editing(self, context):
    """What makes sense in edit mode: to go back."""
    self.layout.separator()
    self.layout.operator("fcn.edit_template", text="Finish Editing Template")
    self.layout.operator("fcn.select_result")


def _draw_import(self, context):
    self.layout.operator("fcn.import_curves", text="Feature Curves (.txt, .obj, .ply, .dxf)")


def _draw_export(self, context):
    self.layout.operator("fcn.export_curves", text="Feature Curves (.obj, .dxf, .svg, .csv)")


PLACES = (
    ("VIEW3D_MT_object", _draw),
    ("VIEW3D_MT_object_context_menu", _draw),
    ("VIEW3D_MT_edit_curve", _draw_editing),
    ("VIEW3D_MT_edit_curve_context_menu", _draw_editing),
    ("VIEW3D_MT_edit_mesh", _draw_editing),
    ("TOPBAR_MT_file_import", _draw_import),
    ("TOPBAR_MT_file_export", _draw_export),
)


def register():
    for name, draw in PLACES:
        getattr(bpy.types, name).append(draw)


def unregister():
    for name, draw in PLACES:
        getattr(bpy.types, name).remove(draw)
