# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean edge length of a scan in a scene."""

from __future__ import annotations

from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError
from ...core.files.formats import mean_edge_length as of_triangles
from .reader import read


def mean_edge_length(item, depsgraph) -> float:
    """Mean length of the edges of all that an object shows, in world space. Raises InputError where it has no faces."""
    found = read([item], depsgraph, quiet=True)
    if not found.surfaces:
        text = rpt_("object {name!r} has no faces; choose the scan that the curves come from")
        raise InputError(text.format(name=item.name))
    try:
        return of_triangles(*found.surfaces[0])
    except InputError:
        text = rpt_("object {name!r} has no edge with a length; choose another scan")
        raise InputError(text.format(name=item.name)) from None
