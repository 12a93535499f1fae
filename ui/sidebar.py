# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the panels stand."""

CATEGORY = "Feature Curves"


class Sidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = CATEGORY
