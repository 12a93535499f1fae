# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel and messages in another language, of which Blender is given a few words.

The texts of the panel are those of the buttons that Blender has laid out.
"""

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parent))
from driver import EXTENSION, Driver  # noqa: E402
from whole_session import CATEGORY, prepare  # noqa: E402

GERMAN = {
    "Complete Curves": "Kurven vervollständigen",
    "{strong:,} strong curves": "{strong:,} starke Kurven",
    "{curves:,} curves of 1 object": "Aus 1 Objekt: {curves:,} Kurven",
    "Select curves or edge meshes": "Kurven oder Kantennetze auswählen",
    "object {name!r} has no edges; choose the scan that the curves come from": "{name!r} hat keine Kanten",
}
WORDS = {"de_DE": {(context, text): word for text, word in GERMAN.items() for context in ("*", "Operator")}}


def texts(layout):
    """All texts of a layout, as Blender has made them."""
    if isinstance(layout, dict):
        found = [layout["draw_string"]] if layout.get("draw_string") else []
        return found + [text for value in layout.values() for text in texts(value)]
    return [text for part in layout for text in texts(part)] if isinstance(layout, (list, tuple)) else []


def session(driver):
    assert bpy.ops.preferences.addon_enable(module=EXTENSION) == {"FINISHED"}
    latest = sys.modules[f"{EXTENSION}.fcn_addon.job.summary"]
    panel = bpy.types.FCN_PT_complete
    seen = []

    def look(self, _context):
        seen[:] = texts(self.layout.introspect())

    def shows(text):
        driver.region("UI").tag_redraw()
        return any(text in one for one in seen)

    prepare(driver)
    panel.append(look)
    yield from driver.sidebar(CATEGORY)
    yield lambda: not isinstance(latest.latest(), str | None)
    found = latest.latest()
    yield lambda: shows(f"{found.strong:,} strong curves") and shows("Complete Curves")

    bpy.app.translations.register("fcn_words", WORDS)
    view = bpy.context.preferences.view
    view.language = "de_DE"
    view.use_translate_interface = view.use_translate_reports = True
    yield lambda: shows(f"{found.strong:,} starke Kurven")
    driver.picture("language")
    assert shows(f"Aus 1 Objekt: {found.curves:,} Kurven") and shows("Kurven vervollständigen"), seen
    assert not shows("strong curves"), seen

    settings = bpy.context.scene.fcn
    settings.edge_length_from = "SCAN"
    settings.scan = bpy.data.objects.new("Points", bpy.data.meshes.new("Points"))
    try:
        bpy.ops.fcn.complete()
    except RuntimeError as error:
        assert "'Points' hat keine Kanten" in str(error), error
    else:
        raise AssertionError("a scan without edges was taken")
    settings.edge_length_from = "ESTIMATE"
    bpy.ops.object.select_all(action="DESELECT")
    yield lambda: shows("Kurven oder Kantennetze auswählen")

    view.language = "en_US"
    yield lambda: shows("Select curves or edge meshes")
    bpy.app.translations.unregister("fcn_words")
    panel.remove(look)


if __name__ == "__main__":
    driver = Driver(sys.argv[sys.argv.index("--") + 1])
    driver.run(session(driver))
