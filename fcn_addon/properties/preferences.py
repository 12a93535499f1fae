# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences: what a new scene begins with, and where help is."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatVectorProperty, IntProperty, StringProperty

from .. import colours
from ..result.writer import BESIDE, FORMS


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
    collection: StringProperty(
        name="Collection",
        description="Name of the collection that new results and detected curves are put into. It is made where it is "
        "missing; without a name they are put into that of the scene",
        maxlen=63,
    )
    keep: EnumProperty(
        name="Keep",
        description="What new results have beside the completed curves",
        items=BESIDE,
        options={"ENUM_FLAG"},
        default={key for key, *_ in BESIDE},
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
        layout.prop(self, "collection", placeholder="Scene Collection")
        layout.prop(self, "keep")
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


def keep():
    """What new results have beside the completed curves, see `writer.BESIDE`; None for all."""
    chosen = of_user()
    return None if chosen is None else set(chosen.keep)


def put(scene, made):
    """Move a result or an object, which is in the collection of the scene, into that which the preferences name."""
    chosen = of_user()
    name = chosen.collection.strip() if chosen is not None else ""
    if not name:
        return
    top = scene.collection
    inside = (c for c in top.children_recursive if c.name == name and c.library is None)
    home = next((c for c in inside if not c.fcn_result.is_result), None)
    if home is None:
        home = bpy.data.collections.new(name)
        top.children.link(home)
    kind = "objects" if isinstance(made, bpy.types.Object) else "children"
    getattr(home, kind).link(made)
    getattr(top, kind).unlink(made)


def begin(scene):
    """Give a scene that has no settings yet what the preferences say."""
    chosen, settings = of_user(), scene.fcn
    if chosen is None or scene.library is not None or settings.is_property_set("form"):
        return
    settings.form, settings.earlier = chosen.form, chosen.earlier
    if chosen.threads and not settings.parameters.is_property_set("threads"):
        settings.parameters.threads = chosen.threads
