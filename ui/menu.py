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
    "fcn.remove_result",
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


def register():
    bpy.types.VIEW3D_MT_object.append(_draw)


def unregister():
    bpy.types.VIEW3D_MT_object.remove(_draw)
