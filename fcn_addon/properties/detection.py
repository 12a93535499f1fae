# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of detection."""

from __future__ import annotations

from bpy.props import BoolProperty, IntProperty
from bpy.types import PropertyGroup

from ...core.detection.parameters import DetectionParameters
from . import from_parameters

LARGE = 1_000_000  # faces; above this many a smaller copy is offered

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
    default=LARGE,
    min=1000,
    soft_max=LARGE,
)

FCN_PG_detection = type(
    "FCN_PG_detection",
    (PropertyGroup,),
    {
        "__doc__": "How feature curves are detected, made from `DetectionParameters`.",
        "__annotations__": {
            **{name: BoolProperty(name=n, description=d, default=on) for name, (on, n, d) in KINDS.items()},
            **from_parameters.annotations(DetectionParameters, {}),
            "use_copy": COPY,
            "faces": FACES,
        },
    },
)
