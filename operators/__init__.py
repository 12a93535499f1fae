# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender operators, one verb a file."""

from __future__ import annotations

import bpy

CLASSES = ()


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
