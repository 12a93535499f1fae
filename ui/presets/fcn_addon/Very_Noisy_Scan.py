# SPDX-License-Identifier: GPL-3.0-or-later
"""Jagged curves with many gaps."""

import bpy

parameters = bpy.context.scene.fcn.parameters

for name in parameters.bl_rna.properties.keys():
    if name not in {"rna_type", "name", "block", "threads"}:
        parameters.property_unset(name)

parameters.smoothing = 5.0
parameters.s = 1.5
parameters.t = 3.0
parameters.epsilon = 3.0
parameters.link_gap = 40.0
parameters.keep_odds = 10.0
