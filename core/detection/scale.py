# SPDX-License-Identifier: GPL-3.0-or-later
"""The smoothing scale that suits a scan, from its noise and from how wide its folds are.

A crease is placed best with the least smoothing that the noise allows. On a rounding that bends evenly over several
edges there is no crest at that scale, only noise; there a wider one finds its middle. Which of the two a scan has is
seen when its curvature is smoothed further: that of a crease falls as the smoothing widens (so that the fold it stands
for stays), that of a wide rounding does not.
"""

from __future__ import annotations

import numpy as np

from .curvature.noise import noise_level
from .curvature.smoothing import Diffusion
from .curvature.tensor import Curvature, curvature, vertex_normals
from .lines.extremality import crest_lines, fold_angle
from .mesh.mesh import TriangleMesh
from .values import RIDGE, VALLEY

LEAST, PER_NOISE, WIDE = 0.35, 1.75, 1.0
"""Scale of creases without noise, what each edge length of noise (its deviation) adds, and the scale of wide roundings;
edge lengths."""

GROWTH = 1.1, 1.27
"""By what factor the fold that typical crests stand for grows, between the scales `PROBES`, on creases at most and on
wide roundings at least. Creases give 0.8 to 1.05, roundings of seven edges 1.3 to 1.5."""

PROBES, WORTH = (0.7, 1.4), 1.1
"""The scales in edge lengths, and by what factor another scale must be wider to be worth measuring again."""

CLEAR, FOLDS, FEWEST = 5.0, 20.0, 100
"""Crests that are asked: so many times as sharp as the noise makes a plane, folded by so many degrees; and the fewest
crest points from which something is concluded."""


def curvature_at_own_scale(mesh: TriangleMesh, *, tick=None) -> Curvature:
    """The curvature of a mesh at the smoothing scale that its noise and its folds ask for."""
    call = tick or (lambda: None)
    h = mesh.edge_length
    call()
    level = noise_level(mesh.vertices, vertex_normals(mesh.vertices, mesh, call), mesh, call)
    diffusion = Diffusion.of(mesh, call)
    scale = LEAST * h + PER_NOISE * level
    field = curvature(mesh, scale, diffusion=diffusion, tick=tick)
    wider = scale + width_of_folds(mesh, field, diffusion, call) * (WIDE * h - scale)
    return curvature(mesh, wider, diffusion=diffusion, tick=tick) if wider > WORTH * scale else field


def width_of_folds(mesh: TriangleMesh, field: Curvature, diffusion: Diffusion, tick=lambda: None) -> float:
    """0 where the typical crest is a crease, 1 where it is a rounding several edges wide, and between."""
    h = mesh.edge_length
    least = max(np.radians(FOLDS), CLEAR * field.noise)
    near = []
    for kind in (RIDGE, VALLEY):
        lines, sound, vertex = crest_lines(mesh, field, kind, 0.5 * least, tick)
        near.append(vertex[sound & (lines.fold >= least)])
    near = np.concatenate(near)
    if len(near) < FEWEST:
        return 0.0
    # Twice the mean curvature: of a crest about the curvature across it, and one field in place of six.
    bend, width, folds = (field.high + field.low)[:, None], field.width, []
    for probe in PROBES:
        wider = np.maximum(width, probe * h)
        bend = diffusion.smooth(bend, np.sqrt(wider**2 - width**2), 2, tick)
        width = wider
        folds.append(fold_angle(np.abs(bend[near, 0]), width[near], h))
    growth = float(np.median(folds[1] / np.maximum(folds[0], 1e-300)))
    return float(np.clip((growth - GROWTH[0]) / (GROWTH[1] - GROWTH[0]), 0, 1))
