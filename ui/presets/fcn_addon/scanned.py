# SPDX-License-Identifier: GPL-3.0-or-later
"""The defaults: curves of a scan."""

import bpy

parameters = bpy.context.scene.fcn.parameters

parameters.l0 = 25.0
parameters.s = 1.0
parameters.t = 2.0
parameters.delta_l = 5.0
parameters.strong_curvature = 0.5
parameters.bin_translation = 2.0
parameters.bin_rotation = 0.026179939
parameters.cluster_translation = 2.0
parameters.cluster_rotation = 0.026179939
parameters.bayes_ratio = 10.0
parameters.keep_length = 3.0
parameters.keep_curvature = 1.0
parameters.smoothing = 1.5
parameters.link_gap = 6.0
parameters.epsilon = 2.0
