# SPDX-License-Identifier: GPL-3.0-or-later
"""Export what is visible of a result."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, StringProperty
from bpy_extras.io_utils import ExportHelper

from ...core.errors import InputError
from ...fcn_addon.exchange import outgoing
from ...fcn_addon.result import stored
from ...fcn_addon.wording import counted
from ..base import OnResult


class FCN_OT_export_curves(OnResult, bpy.types.Operator, ExportHelper):
    """Write the visible completed curves as polylines or as a drawing, or where the occurrences are as a table"""

    bl_idname = "fcn.export_curves"
    bl_label = "Export Feature Curves"
    bl_options = {"REGISTER"}

    form: EnumProperty(
        name="Format",
        description="What is written",
        items=[(key, form.name, form.words) for key, form in outgoing.FORMATS.items()],
    )
    filename_ext = ".obj"
    filter_glob: StringProperty(default=";".join(f"*.{key.lower()}" for key in outgoing.FORMATS), options={"HIDDEN"})

    def check(self, context):
        path = str(Path(self.filepath).with_suffix(f".{self.form.lower()}"))
        changed, self.filepath = path != self.filepath, path
        return changed

    def execute(self, context):
        try:
            count = outgoing.write(self.filepath, stored.active(context.scene), self.form)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        what = counted(count, outgoing.FORMATS[self.form].thing)
        self.report({"INFO"}, rpt_("Wrote {what} to {path}").format(what=what, path=self.filepath))
        return {"FINISHED"}
