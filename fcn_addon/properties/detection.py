# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of detection."""

from __future__ import annotations

from bpy.props import BoolProperty, IntProperty
from bpy.types import PropertyGroup

from ...core.detection.parameters import EDGES, DetectionParameters
from . import changes, from_parameters

LARGE = 1_000_000  # faces; above this many a smaller copy is offered

KINDS = {
    "ridges": (True, "Ridges", "Where the surface is bent outwards"),
    "valleys": (True, "Valleys", "Where it is bent inwards"),
    "sharp": (False, "Sharp Edges", "Edges of the mesh that bend it by the sharp angle, for CAD-like meshes"),
    "boundary": (False, "Boundaries", "Open borders of the mesh"),
}
ADVANCED = tuple(name for name in DetectionParameters.__dataclass_fields__ if name != "detail")
IN_EDGES = from_parameters.with_unit(DetectionParameters, EDGES)

WORDS = {
    "detail": (
        "Detail",
        "Width of the smoothing, in edge lengths of the scan: what is finer is taken for noise. 0 lets the scan decide",
    ),
    "strong_fold": ("Clear Fold", "A curve must somewhere be as sharp as a fold by this angle"),
    "weak_fold": ("Faint Fold", "A curve goes on while it is as sharp as a fold by this angle"),
    "noise": ("Above Noise", "How many times as sharp as the noise of a plane a curve must be"),
    "strong_length": ("Clear Length", "Length over which a curve must be clear, in edge lengths of the scan"),
    "min_length": ("Shortest Curve", "Shortest curve that is kept, in edge lengths of the scan"),
    "bridge": ("Bridge", "Longest faint stretch between two clear ones that stays, in edge lengths"),
    "gap": ("Gap", "Longest gap that is closed between pieces that continue each other, in edge lengths"),
    "turn": ("Turn", "Largest turn from a piece into the gap and out of it"),
    "junction": ("Junction", "How near an end must come to a line ahead to be led on to it, in edge lengths"),
    "merge": ("Merge", "How near lines of one kind that run beside each other are made one, in edge lengths"),
    "margin": ("Margin", "Curves nearer than this to an open border of the scan are left out, in edge lengths"),
    "sharp_angle": ("Sharp Angle", "A sharp edge bends the surface by at least this angle"),
}
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


def _strong_changed(group, context):
    """Called by Blender: a curve never goes on more clearly than it must be clear somewhere."""
    if group.weak_fold > group.strong_fold:
        group.weak_fold = group.strong_fold
    changes.update_detection(group, context)


def _weak_changed(group, context):
    if group.strong_fold < group.weak_fold:
        group.strong_fold = group.weak_fold
    changes.update_detection(group, context)


UPDATES = {"strong_fold": _strong_changed, "weak_fold": _weak_changed, None: changes.update_detection}

FCN_PG_detection = type(
    "FCN_PG_detection",
    (PropertyGroup,),
    {
        "__doc__": "How feature curves are detected, made from `DetectionParameters`.",
        "__annotations__": {
            **{
                name: BoolProperty(name=n, description=d, default=on, update=UPDATES[None])
                for name, (on, n, d) in KINDS.items()
            },
            **from_parameters.properties_of(DetectionParameters, WORDS, UPDATES),
            "use_copy": COPY,
            "faces": FACES,
        },
    },
)
