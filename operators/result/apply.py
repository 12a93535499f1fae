# SPDX-License-Identifier: GPL-3.0-or-later
"""Make one plain object of the visible result."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty

from ...core.errors import InputError
from ...fcn_addon.result import one_object, selection, stored
from ..base import OnResult


class FCN_OT_apply(OnResult, bpy.types.Operator):
    """Make one plain object of all completed curves that are visible, for export or for geometry nodes.
    The result stays as it is"""

    bl_idname = "fcn.apply"
    bl_label = "Apply to One Object"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(
        name="Type",
        items=(
            ("CURVE", "Curve", "A curve object with a poly spline per curve"),
            ("MESH", "Edge Mesh", "A mesh of edges, with support, component, template and occurrence on its points"),
            ("CURVES", "Hair Curves", "The newer curve type, with support and labels per curve for geometry nodes"),
        ),
    )

    def execute(self, context):
        try:
            item = one_object.make(stored.active(context.scene), context, self.kind)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        selection.select(context, [item], active=item)
        self.report({"INFO"}, rpt_("Made {name!r}").format(name=item.name))
        return {"FINISHED"}
