# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves without noise: drawn, or of a CAD model."""

import bpy

parameters = bpy.context.scene.fcn.parameters

for name in parameters.bl_rna.properties.keys():
    if name not in {"rna_type", "name", "block", "threads"}:
        parameters.property_unset(name)

parameters.smoothing = 0.5
parameters.s = 0.5
parameters.t = 1.0
parameters.epsilon = 1.0
parameters.link_gap = 10.0
