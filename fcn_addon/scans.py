# SPDX-License-Identifier: GPL-3.0-or-later
"""From scans to the curves that the method takes. Blender is not known here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..core.errors import InputError
from ..core.files.network import Reading
from .installation import require_scipy


@dataclass(frozen=True)
class Scan:
    """A surface as it was read: name is what messages call it; points (n, 3) float64, triangles (m, 3) int64."""

    name: str
    points: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class Detected:
    """What detection gave: `found` is a FeatureCurves; vertices and faces count the cleaned mesh."""

    name: str
    vertices: int
    faces: int
    found: object

    @property
    def reading(self) -> Reading:
        """The curves as an input of the method."""
        return Reading(self.found.curves, len(self.found), edge_length=self.edge_length)

    @property
    def edge_length(self) -> float:
        return self.found.edge_length


def detect(scan: Scan, parameters, kinds, progress=None) -> Detected:
    """The feature curves of a scan.

    Parameters
    ----------
    parameters : DetectionParameters
    kinds : dict, of ridges, valleys, sharp and boundary -> bool
    progress : called with the stages mesh, curvature and lines; may raise Cancelled

    Raises
    ------
    InputError that names the scan, also where no curve is found
    """
    require_scipy()
    from ..core import detection

    try:
        mesh = detection.TriangleMesh.of(scan.points, scan.triangles, progress=progress)
        found = detection.detect(mesh, parameters=parameters, progress=progress, **kinds)
    except InputError as error:
        raise InputError(f"{scan.name}: {error}") from None
    require_curves(scan.name, found, parameters)
    return Detected(scan.name, len(mesh.vertices), len(mesh.faces), found)


def require_curves(name, found, parameters):
    """Raise InputError where nothing was found."""
    if not len(found):
        raise InputError(
            f"{name}: no feature curve is found; lower strong_fold, {parameters.strong_fold:g} degrees, or min_length, "
            f"{parameters.min_length:g} edge lengths, or ask for other kinds"
        )
