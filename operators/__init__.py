# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender operators, one verb a file."""

from __future__ import annotations

import bpy

from .apply import FCN_OT_apply
from .cancel import FCN_OT_cancel
from .complete import FCN_OT_complete
from .complete_scan import FCN_OT_complete_scan
from .delete_occurrence import FCN_OT_delete_occurrence
from .detect import FCN_OT_detect
from .edit_template import FCN_OT_edit_template
from .make_unique import FCN_OT_make_unique
from .measure import FCN_OT_measure
from .reject_occurrence import FCN_OT_reject_occurrence
from .reject_transformation import FCN_OT_reject_transformation
from .remove_result import FCN_OT_remove_result
from .restore import FCN_OT_restore
from .save_preset import FCN_OT_save_preset
from .select_occurrence import FCN_OT_select_occurrence
from .select_result import FCN_OT_select_result
from .select_source import FCN_OT_select_source
from .select_transformation import FCN_OT_select_transformation

CLASSES = (
    FCN_OT_detect,
    FCN_OT_complete_scan,
    FCN_OT_complete,
    FCN_OT_cancel,
    FCN_OT_measure,
    FCN_OT_select_transformation,
    FCN_OT_select_occurrence,
    FCN_OT_select_source,
    FCN_OT_select_result,
    FCN_OT_reject_transformation,
    FCN_OT_reject_occurrence,
    FCN_OT_delete_occurrence,
    FCN_OT_restore,
    FCN_OT_make_unique,
    FCN_OT_edit_template,
    FCN_OT_apply,
    FCN_OT_remove_result,
    FCN_OT_save_preset,
)


def register():
    done = []
    try:
        for cls in CLASSES:
            bpy.utils.register_class(cls)
            done.append(cls)
    except BaseException:
        for cls in reversed(done):
            bpy.utils.unregister_class(cls)
        raise


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
