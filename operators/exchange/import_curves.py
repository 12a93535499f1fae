# SPDX-License-Identifier: GPL-3.0-or-later
"""Import curves of files."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy_extras.io_utils import ImportHelper

from ...core.errors import InputError
from ...fcn_addon.exchange import incoming
from ...fcn_addon.scene import viewports
from ..base import LEAVE_EDIT_MODE, Polled


class FCN_OT_import_curves(Polled, bpy.types.Operator, ImportHelper):
    """Import feature curves: ridge lines of CGAL or CrestCODE (.txt), lines of .obj and .dxf, edges of .ply"""

    bl_idname = "fcn.import_curves"
    bl_label = "Import Feature Curves"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default=incoming.patterns(), options={"HIDDEN"})

    @classmethod
    def why_not(cls, context):
        return LEAVE_EDIT_MODE if context.mode != "OBJECT" else None

    def execute(self, context):
        try:
            item = incoming.add(context, self.filepath)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        viewports.frame_selected(context)
        self.report({"INFO"}, rpt_("Imported {name!r}").format(name=item.name))
        return {"FINISHED"}
