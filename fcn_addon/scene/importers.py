# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that Blender's own importers read, each into an empty scene that replaces what is open."""

from __future__ import annotations

import io
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import bpy

from ...core.errors import InputError

# Ending -> the operators that may read it, the first that this Blender has is taken, and the add-on that brings it.
OPERATORS = {
    ".glb": (("import_scene.gltf", "io_scene_gltf2"),),
    ".gltf": (("import_scene.gltf", "io_scene_gltf2"),),
    ".fbx": (("wm.fbx_import", None), ("import_scene.fbx", "io_scene_fbx")),
    ".usd": (("wm.usd_import", None),),
    ".usda": (("wm.usd_import", None),),
    ".usdc": (("wm.usd_import", None),),
    ".usdz": (("wm.usd_import", None),),
    ".abc": (("wm.alembic_import", None),),
    ".dae": (("wm.collada_import", None),),
}


def open_file(path):
    """Import a file into an empty scene. Raises InputError where Blender cannot."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    run = _operator(path, Path(path).suffix.lower())
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # they say a lot
            done = run(filepath=str(Path(path).resolve()))
    except Exception as error:  # the importers are scripts, and raise whatever a broken file makes them
        reason = " ".join(str(error).removeprefix("Error:").split()) or type(error).__name__
        raise InputError(f"{path}: Blender cannot import it ({reason}); was it cut off?") from None
    if "FINISHED" not in done:
        raise InputError(f"{path}: Blender cannot import it; open it in Blender to see why")
    bpy.context.view_layer.update()


def _operator(path, ending):
    import addon_utils

    for name, addon in OPERATORS[ending]:
        if addon is not None:
            addon_utils.enable(addon)
        module, _, function = name.partition(".")
        run = getattr(getattr(bpy.ops, module), function)
        try:
            run.get_rna_type()
        except KeyError:
            continue
        return run
    raise InputError(
        f"{path}: Blender {bpy.app.version_string} has no importer for {ending} files;"
        " save it as .blend or .glb with a program that reads it"
    )
