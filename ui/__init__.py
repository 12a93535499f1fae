# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels and lists; they draw cached values and reach operators by idname."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..fcn_addon.registration import register_classes, unregister_classes
from . import keymap, manual_links, menu, overlay
from .complete_panel import FCN_PT_advanced, FCN_PT_complete, FCN_PT_parameters
from .detect_panel import FCN_PT_detect, FCN_PT_detect_below, FCN_PT_detect_more, FCN_PT_detect_more_below
from .presets_panel import FCN_PT_presets
from .result_panel import (
    FCN_PT_occurrence,
    FCN_PT_result,
    FCN_PT_transformations,
    FCN_PT_use,
    FCN_UL_places,
    FCN_UL_templates,
    FCN_UL_transformations,
)

CLASSES = (
    FCN_PT_presets,
    FCN_PT_detect,
    FCN_PT_detect_more,
    FCN_PT_complete,
    FCN_PT_parameters,
    FCN_PT_advanced,
    FCN_UL_transformations,
    FCN_UL_templates,
    FCN_UL_places,
    FCN_PT_result,
    FCN_PT_occurrence,
    FCN_PT_transformations,
    FCN_PT_use,
    FCN_PT_detect_below,
    FCN_PT_detect_more_below,
    menu.FCN_MT_object,
)
HERE = str(Path(__file__).resolve().parent)  # Blender looks for presets/fcn_addon in it


def register():
    register_classes(CLASSES)
    try:
        menu.register()
        overlay.register()
        keymap.register()
        manual_links.register()
        bpy.utils.register_preset_path(HERE)
    except BaseException:
        manual_links.unregister()
        keymap.unregister()
        overlay.unregister()
        menu.unregister()
        unregister_classes(CLASSES)
        raise


def unregister():
    bpy.utils.unregister_preset_path(HERE)
    manual_links.unregister()
    keymap.unregister()
    overlay.unregister()
    menu.unregister()
    unregister_classes(CLASSES)
