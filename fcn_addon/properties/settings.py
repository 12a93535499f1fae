# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a run: properties of the scene, saved in the .blend."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, PointerProperty
from bpy.types import PropertyGroup

from ...core.parameters import EDGES, Parameters
from ..detected.kept import FCN_PG_curves
from ..registration import register_classes, unregister_classes
from ..result import stored, writer
from . import changes, from_parameters
from .detection import FCN_PG_detection
from .preferences import FCN_AP_preferences

WORDS = {
    "l0": ("Shortest Match", "Shortest stretch over which two curves must run alike to be taken for the same"),
    "short_l0": ("Short Match", "The same for a second search, which finds what short pieces show"),
    "s": ("Match Distance", "How far apart two curves that run alike may be on average"),
    "t": ("Extended Distance", "The same while a match is followed on. It is never less than Match Distance"),
    "delta_l": ("Extension Step", "How far a match is followed on at a time"),
    "strong_curvature": (
        "Strong Curvature",
        "Curves sharper than this share of the average are matched; 0 matches all",
    ),
    "bayes_ratio": (
        "Clearness",
        "How much better a repeat must explain the curves than none, to be kept. More is stricter",
    ),
    "keep_odds": ("Keep Odds", "How much likelier to be real than clutter a curve must be that does not repeat"),
    "smoothing": ("Smoothing", "How much jagged curves are smoothed along their way. Corners get this much rounder"),
    "link_gap": ("Largest Gap", "Largest gap that is closed in curves that do not repeat"),
    "epsilon": ("Feature Radius", "How far apart the occurrences may show the same curve"),
    "thing_margin": ("Reach", "How far around what was found of a template the rest of it is looked for"),
    "thing_gap": ("Gap Inside", "Largest gap between the curves of one template"),
    "significance": ("Doubt", "How likely to be chance a curve or an occurrence may be. Less is stricter"),
    "block": ("Block Size", "Pairs handled at a time. It bounds the memory, not the result"),
    "threads": ("Threads", "Processors that work on it; 0 takes all but one"),
}
"""What parameters are called here, and what they do, for people who have not read the paper."""

BASIC = ("smoothing", "l0", "s", "link_gap", "epsilon")  # what a user changes first; the rest is in a sub-panel


def _changed(group, context):
    """Called by Blender: a match is never followed on more strictly than it began."""
    if group.t < group.s:
        group.t = group.s
    changes.update(group, context)


FCN_PG_parameters = type(
    "FCN_PG_parameters",
    (PropertyGroup,),
    {
        "__doc__": "The parameters of the method, made from `Parameters`.",
        "__annotations__": from_parameters.properties_of(Parameters, WORDS, _changed),
    },
)


def in_edges() -> set[str]:
    """Names of the parameters that are multiples of the edge length."""
    return from_parameters.with_unit(Parameters, EDGES)


def parameters(group) -> Parameters:
    """The validated parameters of the method from their properties."""
    return from_parameters.read(group, Parameters)


def set_parameters(group, values):
    """Write a `Parameters` to its properties."""
    from_parameters.write(group, values)


def _has_faces(_, item):
    return item.type == "MESH" and (len(item.data.polygons) > 0 or len(item.modifiers) > 0)


def _is_result_here(settings, item):
    return item.fcn_result.is_result and item in stored.of_scene(settings.id_data)


class FCN_PG_settings(PropertyGroup):
    """What to complete and how."""

    source: EnumProperty(
        name="Curves",
        description="Where the curves to complete come from",
        items=(
            ("SELECTION", "Selection", "The selected edge meshes and curve objects"),
            ("COLLECTION", "Collection", "All edge meshes and curve objects of a collection and of those inside it"),
        ),
        update=changes.update,
    )
    collection: PointerProperty(
        type=bpy.types.Collection,
        name="Collection",
        description="The collection that holds the curves",
        poll=lambda _, item: not item.fcn_result.is_result,
        update=changes.update,
    )
    use_hidden: BoolProperty(
        name="Hidden Objects",
        description="Take objects of the collection that are hidden too",
        update=changes.update,
    )
    take_edges: BoolProperty(
        name="Loose Edges",
        description="Take the loose edges of meshes that have faces too as curves. Without it such a mesh is a scan",
        update=changes.update,
    )
    edge_length_from: EnumProperty(
        name="Edge Length",
        description="The mean edge length of the scan that the curves come from. All sizes are multiples of it",
        items=(
            ("ESTIMATE", "Estimate", "Take what detected curves know, or estimate it from the segments of the curves"),
            ("SCAN", "From Scan", "Measure it on the scan that the curves come from"),
            ("VALUE", "Value", "Type it in"),
        ),
        update=changes.update,
    )
    scan: PointerProperty(
        type=bpy.types.Object,
        name="Scan",
        description="The mesh that the curves come from; only its mean edge length is taken",
        poll=_has_faces,
        update=changes.update,
    )
    edge_length: FloatProperty(
        name="Edge Length",
        description="Mean edge length of the scan that the curves come from",
        subtype="DISTANCE",
        default=0.02,
        min=1e-6,
        soft_max=1.0,
        precision=4,
        step=0.1,
        update=changes.update,
    )
    earlier: EnumProperty(
        name="Earlier Result",
        description="What happens to the result that an earlier run made of the same curves",
        items=(
            ("REPLACE", "Replace", "Remove it when the new one is there"),
            ("KEEP", "Keep", "Leave it and put the new one beside it"),
        ),
    )
    form: EnumProperty(name="Objects", description="What the completed curves become", items=writer.FORMS)
    edit_alone: BoolProperty(
        name="Alone",
        description="While a template is edited, hide all else; otherwise the scan and the rest stay in sight, faint",
    )
    show_source: BoolProperty(
        name="Show Settings",
        description="What to complete and how; closed up once there is a result",
        default=True,
    )
    result: PointerProperty(
        type=bpy.types.Collection,
        name="Result",
        description="The result that the panel is about",
        poll=_is_result_here,
    )
    parameters: PointerProperty(type=FCN_PG_parameters)
    detection: PointerProperty(type=FCN_PG_detection)


CLASSES = (
    FCN_AP_preferences,
    FCN_PG_detection,
    FCN_PG_curves,
    FCN_PG_parameters,
    FCN_PG_settings,
)


def register():
    stored.register()
    try:
        register_classes(CLASSES)
    except BaseException:
        stored.unregister()
        raise
    bpy.types.Object.fcn_curves = PointerProperty(type=FCN_PG_curves)
    bpy.types.Scene.fcn = PointerProperty(type=FCN_PG_settings)


def unregister():
    del bpy.types.Scene.fcn
    del bpy.types.Object.fcn_curves
    unregister_classes(CLASSES)
    stored.unregister()
