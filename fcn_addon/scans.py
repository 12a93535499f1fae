# SPDX-License-Identifier: GPL-3.0-or-later
"""From scans to the curves that the method takes. Blender is not known here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.errors import InputError, NoCurves
from ..core.files.reading import Reading
from .coarse import rounding_step
from .installation import require_scipy


@dataclass(frozen=True)
class Scan:
    """A surface as it was read: name is what messages call it; points (n, 3) float64, triangles (m, 3) int64."""

    name: str
    points: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class Detected:
    """What detection gave: `found` is a FeatureCurves; vertices and faces count the cleaned mesh.

    remarks : what is to be said of the scan, sentences
    """

    name: str
    vertices: int
    faces: int
    found: Any
    remarks: tuple[str, ...] = ()

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
    InputError that names the scan; NoCurves where no curve is found
    """
    require_scipy()
    from ..core import detection

    try:
        mesh = detection.TriangleMesh.of(scan.points, scan.triangles, progress=progress)
        found = detection.detect(mesh, parameters=parameters, progress=progress, **kinds)
    except InputError as error:
        raise InputError(f"{scan.name}: {error}") from None
    require_curves(scan.name, found, parameters)
    return Detected(scan.name, len(mesh.vertices), len(mesh.faces), found, remarks(scan, mesh, found.edge_length))


def remarks(scan, mesh, edge_length) -> tuple[str, ...]:
    """What is to be said of a scan and of the TriangleMesh that it was cleaned to."""
    said = []
    dropped = len(scan.triangles) - len(mesh.faces)
    if dropped > 0:
        said.append(f"{dropped} of {len(scan.triangles)} faces have no area or are there twice; they are left out")
    step = rounding_step(scan.points, scan.triangles, edge_length)
    if step is not None:
        said.append(
            f"its coordinates are rounded to {step:.3g}, which is coarse beside its edge length of {edge_length:.3g}: "
            "steps of the rounding show as ridges; export the scan with more digits, or about its own origin"
        )
    return tuple(said)


def require_curves(name, found, parameters):
    """Raise NoCurves where nothing was found."""
    if not len(found):
        raise NoCurves(
            f"{name}: no feature curve is found; lower strong_fold, {parameters.strong_fold:g} degrees, or min_length, "
            f"{parameters.min_length:g} edge lengths, or ask for other kinds"
        )
