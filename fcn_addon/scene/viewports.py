# SPDX-License-Identifier: GPL-3.0-or-later
"""The 3D viewports of the window: redrawing, framing, colours."""

from __future__ import annotations

import bpy


def areas(context):
    """(window, area) of every 3D viewport that is open."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                yield window, area


def redraw(context):
    """Draw the viewports again, scene and sidebar."""
    for _, area in areas(context):
        area.tag_redraw()


def redraw_panels(context):
    """Draw the sidebars again, without the scene."""
    for _, area in areas(context):
        for region in area.regions:
            if region.type == "UI":
                region.tag_redraw()


def is_over_viewport(context, event) -> bool:
    """Whether the mouse is over a 3D viewport of the window."""
    x, y = event.mouse_x, event.mouse_y
    return any(
        a.type == "VIEW_3D" and a.x <= x < a.x + a.width and a.y <= y < a.y + a.height
        for a in (context.window.screen.areas if context.window else ())
    )


def show_object_colours(context):
    """Let the viewports draw wires in the colours of their objects; surfaces keep theirs."""
    for _, area in areas(context):
        area.spaces.active.shading.wireframe_color_type = "OBJECT"


def frame_selected(context):
    """Move the view so that the selection fills it; the viewport of the context, else the first. False without one."""
    for window, area in sorted(areas(context), key=lambda pair: pair[1] != context.area):
        region = next((r for r in area.regions if r.type == "WINDOW"), None)
        if region is not None:
            with context.temp_override(window=window, area=area, region=region):
                bpy.ops.view3d.view_selected(use_all_regions=False)
            return True
    return False


def look_from_front(context):
    """Turn the viewport to the front view, and frame the selection."""
    found = of_context(context)
    if found is None:
        return
    window, area = found
    region = next(r for r in area.regions if r.type == "WINDOW")
    with context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected(use_all_regions=False)


def of_context(context):
    """(window, area) of the viewport of the context, else of the first; None without one."""
    found = sorted(areas(context), key=lambda pair: pair[1] != context.area)
    return found[0] if found else None


def isolate(window, area, alone):
    """Show the selection alone in a viewport (its local view), or everything again."""
    if bool(area.spaces.active.local_view) == alone:
        return
    region = next(r for r in area.regions if r.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.view3d.localview(frame_selected=True)  # on the way back this is: where the view was before
