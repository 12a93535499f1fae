# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of a result, and those that the preferences give to new ones."""

RED, GREEN = (0.8, 0.1, 0.1), (0.1, 0.8, 0.1)


def colours(root):
    """Colours of the curves of templates and of the others."""
    parts = [o for o in root.all_objects if "support" in o]
    return [{tuple(round(c, 3) for c in o.color[:3]) for o in parts if (o["occurrence"] >= 0) == recurs}
            for recurs in (True, False)]  # fmt: skip


def test_a_colour_of_the_panel_is_that_of_the_curves(made):
    made.fcn_result.template_colour, made.fcn_result.strong_colour = RED, GREEN
    assert colours(made) == [{RED}, {GREEN}]
    made.fcn_result.view = "TEMPLATES"
    assert colours(made)[0] != {RED}
    made.fcn_result.view = "RESULT"
    assert colours(made) == [{RED}, {GREEN}]


def test_new_results_have_the_colours_of_the_preferences(bpy, part, wall, work):
    chosen = part("fcn_addon.properties.preferences").of_user()
    before = tuple(chosen.template_colour), tuple(chosen.strong_colour)
    chosen.template_colour, chosen.strong_colour = RED, GREEN
    try:
        assert bpy.ops.fcn.complete() == {"FINISHED"}
        assert colours(bpy.context.scene.fcn.result) == [{RED}, {GREEN}]
    finally:
        chosen.template_colour, chosen.strong_colour = before


def test_new_files_keep_earlier_results_if_the_preferences_say_so(bpy, part):
    chosen = part("fcn_addon.properties.preferences").of_user()
    chosen.earlier = "KEEP"
    try:
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        assert bpy.context.scene.fcn.earlier == "KEEP"
    finally:
        chosen.earlier = "REPLACE"
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert bpy.context.scene.fcn.earlier == "REPLACE"
