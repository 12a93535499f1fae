# SPDX-License-Identifier: GPL-3.0-or-later
"""Where "Online Manual" in the menu of a button leads: to its part of the manual that comes with the extension."""

from __future__ import annotations

import bpy

from ..fcn_addon import manual

DETECT, COMPLETE = "From a scan to curves", "From curves to a result"
PARTS, OCCURRENCE = "The parts of the panel", "Occurrences"
FILES = "Files in and out"
PREFERENCES, START, KNOW = "Preferences", "Install in three steps", "Good to know"
SECTIONS = (  # pattern of what Blender calls a button, in small letters -> heading
    ("bpy.ops.fcn.detect*", DETECT),
    ("bpy.types.fcn_pg_detection*", DETECT),
    ("bpy.types.fcn_pg_curves*", DETECT),
    ("bpy.ops.fcn.complete_scan*", DETECT),
    ("bpy.ops.fcn.complete*", COMPLETE),
    ("bpy.ops.fcn.cancel*", COMPLETE),
    ("bpy.types.fcn_pg_parameters*", COMPLETE),
    ("bpy.ops.fcn.*_occurrence*", OCCURRENCE),
    ("bpy.ops.fcn.select_source*", OCCURRENCE),
    ("bpy.ops.fcn.select_result*", OCCURRENCE),
    ("bpy.ops.fcn.edit_template*", OCCURRENCE),
    ("bpy.ops.fcn.make_unique*", OCCURRENCE),
    ("bpy.ops.fcn.import_curves*", FILES),
    ("bpy.ops.fcn.export_curves*", FILES),
    ("bpy.ops.fcn.try_example*", START),
    ("bpy.ops.fcn.manual*", KNOW),
    ("bpy.types.fcn_ap_preferences*", PREFERENCES),
    ("bpy.ops.fcn.*", PARTS),
    ("bpy.types.fcn_*", PARTS),
    ("bpy.types.scene.fcn*", PARTS),
)


def links():
    """What `bpy.utils.register_manual_map` asks for; the page is written then."""
    page = manual.write(bpy.app.tempdir)
    return page.as_uri() + "#", tuple((pattern, manual.anchor(heading)) for pattern, heading in SECTIONS)


_registered = False


def register():
    global _registered
    bpy.utils.register_manual_map(links)
    _registered = True


def unregister():
    global _registered
    if _registered:
        bpy.utils.unregister_manual_map(links)
    _registered = False
