# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of detection, and what detected curves keep of it."""

from __future__ import annotations

from math import pi

from bpy.props import BoolProperty, FloatProperty, IntProperty, StringProperty
from bpy.types import PropertyGroup

from ..core.detection.parameters import DetectionParameters
from . import detecting, numbers

KINDS = {
    "ridges": (True, "Ridges", "Where the surface is bent outwards"),
    "valleys": (True, "Valleys", "Where it is bent inwards"),
    "sharp": (False, "Sharp Edges", "Edges of the mesh that bend it by the sharp angle, for CAD-like meshes"),
    "boundary": (False, "Boundaries", "Open borders of the mesh"),
}
ADVANCED = tuple(name for name in DetectionParameters.__dataclass_fields__ if name != "detail")

COPY = BoolProperty(
    name="Decimated Copy",
    description="Measure a copy of the scan with fewer faces, which is gone afterwards. The scan itself is not changed",
)
FACES = IntProperty(
    name="Faces",
    description="About how many faces the copy has",
    default=detecting.LARGE,
    min=1000,
    soft_max=detecting.LARGE,
)

FCN_PG_detection = type(
    "FCN_PG_detection",
    (PropertyGroup,),
    {
        "__doc__": "How feature curves are detected, made from `DetectionParameters`.",
        "__annotations__": {
            **{name: BoolProperty(name=n, description=d, default=on) for name, (on, n, d) in KINDS.items()},
            **numbers.annotations(DetectionParameters, {}),
            "use_copy": COPY,
            "faces": FACES,
        },
    },
)


class FCN_PG_curves(PropertyGroup):
    """What a detected curves object keeps: which of its curves are shown.

    scan : name of the object that they were detected on, empty for all other objects
    applied_fold, applied_length : what the mesh was made with
    """

    scan: StringProperty()
    fold: FloatProperty(
        name="Least Fold",
        description="Leave out curves that are on average not as sharp as a fold by this angle",
        subtype="ANGLE",
        min=0.0,
        max=pi,
        soft_max=pi / 2,
        update=detecting.update,
    )
    length: FloatProperty(
        name="Least Length",
        description="Leave out curves that are shorter than this many edge lengths of the scan",
        min=0.0,
        soft_max=200.0,
        precision=1,
        step=100,
        update=detecting.update,
    )
    applied_fold: FloatProperty()
    applied_length: FloatProperty()
    total: IntProperty()
    shown: IntProperty()


CLASSES = (FCN_PG_detection, FCN_PG_curves)
