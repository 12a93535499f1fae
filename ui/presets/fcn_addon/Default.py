# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of a scan: the defaults."""

import bpy

parameters = bpy.context.scene.fcn.parameters

for name in parameters.bl_rna.properties.keys():
    if name not in {"rna_type", "name", "block", "threads"}:
        parameters.property_unset(name)
