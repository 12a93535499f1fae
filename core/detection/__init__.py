# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature curves of a triangle mesh: ridges, valleys, sharp edges and open boundaries."""

from .mesh.mesh import TriangleMesh
from .parameters import DetectionParameters
from .pipeline import detect, measure
from .values import KINDS, FeatureCurves

__all__ = ["KINDS", "DetectionParameters", "FeatureCurves", "TriangleMesh", "detect", "measure"]
