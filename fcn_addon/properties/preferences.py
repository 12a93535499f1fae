# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences: what a new scene begins with, and where help is."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatVectorProperty, IntProperty

from .. import colours
from ..result.writer import FORMS


class FCN_AP_preferences(bpy.types.AddonPreferences):
    """What a new scene begins with."""

    bl_idname = __package__.rpartition(".fcn_addon.")[0]

    form: EnumProperty(name="Objects", description="What completed curves become in new files", items=FORMS)
    threads: IntProperty(
        name="Threads",
        description="Processors that runs take in new files; 0 takes all but one",
        min=0,
        max=256,
    )

    earlier: EnumProperty(
        name="Earlier Result",
        description="What a run does with the earlier result of the same curves in new files",
        items=(("REPLACE", "Replace", "Remove it"), ("KEEP", "Keep", "Leave it beside the new one")),
    )
    template_colour: FloatVectorProperty(
        name="Templates", description="Colour of the curves of templates in new results", subtype="COLOR", size=3,
        min=0.0, max=1.0, default=colours.TEMPLATE,
    )  # fmt: skip
    strong_colour: FloatVectorProperty(
        name="Single Curves", description="Colour of the curves that do not recur in new results", subtype="COLOR",
        size=3, min=0.0, max=1.0, default=colours.STRONG,
    )  # fmt: skip

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "form")
        layout.prop(self, "threads")
        layout.prop(self, "earlier", expand=True)
        layout.prop(self, "template_colour")
        layout.prop(self, "strong_colour")
        layout.operator("fcn.manual", icon="HELP")
        layout.label(text="Shortcuts are off until switched on: Preferences > Keymap, search for Feature Curves")


def of_user():
    """The preferences, None where the add-on was not enabled as one."""
    addon = bpy.context.preferences.addons.get(FCN_AP_preferences.bl_idname)
    return None if addon is None else addon.preferences


def paint(root):
    """Give a new result the colours of the preferences."""
    chosen = of_user()
    if chosen is not None:
        root.fcn_result.template_colour = chosen.template_colour
        root.fcn_result.strong_colour = chosen.strong_colour


def begin(scene):
    """Give a scene that has no settings yet what the preferences say."""
    chosen, settings = of_user(), scene.fcn
    if chosen is None or scene.library is not None or settings.is_property_set("form"):
        return
    settings.form, settings.earlier = chosen.form, chosen.earlier
    if chosen.threads and not settings.parameters.is_property_set("threads"):
        settings.parameters.threads = chosen.threads
