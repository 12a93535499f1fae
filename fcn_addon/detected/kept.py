# SPDX-License-Identifier: GPL-3.0-or-later
"""What is kept of detections for the session, so that thresholds can be changed without detecting again."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, pi

import bpy
import numpy as np
from bpy.props import FloatProperty, IntProperty, StringProperty
from bpy.types import PropertyGroup

from . import edge_mesh

KEPT = 4  # objects whose curves are kept


@dataclass(frozen=True)
class Measured:
    """The measurement of a scan, to try other thresholds on: a TriangleMesh and its Curvature, and its edge length."""

    fingerprint: bytes
    detail: float
    mesh: object
    field: object
    edge_length: float


_measured = {}  # name of the scan -> Measured; the last one only, it is large
_found = {}  # session_uid of the curves object -> (FeatureCurves, the object's origin)


def forget():
    """Drop all that is kept."""
    _measured.clear()
    _found.clear()


def measured(label):
    """The Measured of a scan, None where it is not kept."""
    return _measured.get(label)


def keep(label, measurement, item, found):
    """Keep the measurement of a scan, and the FeatureCurves that an object shows."""
    _measured.clear()
    _measured[label] = measurement
    _found[item.session_uid] = found, np.array(edge_mesh.middle(found.curves.points))
    while len(_found) > KEPT:
        del _found[next(iter(_found))]


def remove(item):
    """Remove a detected curves object."""
    data = item.data
    _found.pop(item.session_uid, None)
    bpy.data.objects.remove(item)
    if data.users == 0:
        bpy.data.meshes.remove(data)


def has(uid) -> bool:
    """Whether curves are kept for the object of a session_uid."""
    return uid in _found


def can_change(item) -> bool:
    """Whether the thresholds of a detected curves object can be changed in this session."""
    return has(item.session_uid)


def shown(item):
    """The FeatureCurves that a detected curves object shows by its thresholds, and its origin (3,) among them."""
    found, centre = _found[item.session_uid]
    curves = item.fcn_curves
    return found.at_least(fold=degrees(curves.applied_fold), length=curves.applied_length), centre


def update(group, _context):
    """Called by Blender when a threshold of a curves object changes: its mesh is made anew from the kept curves.

    Curves that the user has edited stay as they are; the thresholds have no say any more.
    """
    item = group.id_data
    kept = _found.get(item.session_uid)
    if kept is None or item.mode != "OBJECT":
        return
    found, centre = kept
    before = found.at_least(fold=degrees(group.applied_fold), length=group.applied_length)
    if not edge_mesh.holds(item.data, before, centre):
        del _found[item.session_uid]
        return
    now = found.at_least(fold=degrees(group.fold), length=group.length)
    edge_mesh.fill(item.data, now, centre)
    group.applied_fold, group.applied_length, group.shown = group.fold, group.length, len(now)


class FCN_PG_curves(PropertyGroup):
    """What a detected curves object keeps: which of its curves are shown.

    scan : name of the object that they were detected on, empty for all other objects
    applied_fold, applied_length : what the mesh was made with
    remarks : what is to be said of the scan
    """

    scan: StringProperty()
    fold: FloatProperty(
        name="Least Fold",
        description="Leave out curves that are on average not as sharp as a fold by this angle",
        subtype="ANGLE",
        min=0.0,
        max=pi,
        soft_max=pi / 2,
        update=update,
    )
    length: FloatProperty(
        name="Least Length",
        description="Leave out curves that are shorter than this many edge lengths of the scan",
        min=0.0,
        soft_max=200.0,
        precision=1,
        step=100,
        update=update,
    )
    applied_fold: FloatProperty()
    applied_length: FloatProperty()
    remarks: StringProperty(name="Remarks", description="What is to be said of the scan")
    detail: FloatProperty(name="Detail", description="The smoothing that was used, in edge lengths of the scan")
    total: IntProperty()
    shown: IntProperty()
