# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender operators, one verb a file."""

from __future__ import annotations

from ..fcn_addon.registration import register_classes, unregister_classes
from .exchange.export_curves import FCN_OT_export_curves
from .exchange.import_curves import FCN_OT_import_curves
from .exchange.try_example import FCN_OT_try_example
from .manual import FCN_OT_manual
from .occurrence.delete_occurrence import FCN_OT_delete_occurrence
from .occurrence.edit_template import FCN_OT_edit_template
from .occurrence.make_unique import FCN_OT_make_unique
from .occurrence.reject_occurrence import FCN_OT_reject_occurrence
from .occurrence.select_occurrence import FCN_OT_select_occurrence
from .occurrence.select_source import FCN_OT_select_source
from .result.apply import FCN_OT_apply
from .result.reject_transformation import FCN_OT_reject_transformation
from .result.remove_result import FCN_OT_remove_result
from .result.restore import FCN_OT_restore
from .result.select_result import FCN_OT_select_result
from .result.select_template import FCN_OT_select_template
from .result.select_transformation import FCN_OT_select_transformation
from .run.cancel import FCN_OT_cancel
from .run.complete import FCN_OT_complete
from .run.complete_scan import FCN_OT_complete_scan
from .run.detect import FCN_OT_detect
from .run.measure import FCN_OT_measure
from .save_preset import FCN_OT_save_preset

CLASSES = (
    FCN_OT_detect,
    FCN_OT_complete_scan,
    FCN_OT_complete,
    FCN_OT_cancel,
    FCN_OT_measure,
    FCN_OT_select_template,
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
    FCN_OT_import_curves,
    FCN_OT_export_curves,
    FCN_OT_try_example,
    FCN_OT_manual,
)


def register():
    register_classes(CLASSES)


def unregister():
    unregister_classes(CLASSES)
