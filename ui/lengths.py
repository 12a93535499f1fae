# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters in multiples of the edge length, with the length in the unit of the scene beside them."""

from __future__ import annotations

from bpy.app.translations import pgettext_iface as iface_

from ..fcn_addon.scene.units import unit_length


def draw(layout, context, group, names, edges, edge_length):
    """Draw properties of a group below each other.

    edges : names of those that are multiples of the edge length
    edge_length : in scene units, None where it is not known
    """
    layout.use_property_split = True
    layout.use_property_decorate = False
    words = unit_length(context.scene)
    for name in names:
        row = layout.row(align=True)
        row.prop(group, name)
        if name in edges:
            known = edge_length is not None
            text = words(getattr(group, name) * edge_length) if known else iface_("edges")
            side = row.row()
            side.ui_units_x = 4
            side.active = False
            side.label(text=text, translate=False)
