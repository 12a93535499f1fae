# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that Blender's own importers read, each into an empty scene that replaces what is open."""

from __future__ import annotations

import io
import json
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


def open_file(path) -> str:
    """Import a file into an empty scene; what is to be said of it. Raises InputError where Blender cannot."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    run = _operator(path, Path(path).suffix.lower())
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):  # they say a lot
            done = run(filepath=str(Path(path).resolve()))
    except Exception as error:  # the importers are scripts, and raise whatever a broken file makes them
        reason = _words(error)
        raise InputError(
            f"{path}: Blender cannot import it ({reason}); check that it is whole, and the files that it names"
        ) from None
    if "FINISHED" not in done:
        raise InputError(f"{path}: Blender cannot import it; open it in Blender to see why")
    bpy.context.view_layer.update()
    count = _gltf_scenes(path)
    if count > 1 and not any(layer.exclude for layer in bpy.context.view_layer.layer_collection.children):
        return f"{path} has {count} scenes, and this Blender shows them as one; --object takes a part of them"
    return ""


def _words(error) -> str:
    """What an importer says is wrong: of a traceback, which is how a script of Blender's fails, what was raised."""
    text = str(error).removeprefix("Error:").strip()
    if "Traceback (most" in text:
        lines = [line for line in text.splitlines() if line[:1].strip() and not line.startswith("Location:")]
        text = lines[-1] if len(lines) > 1 else type(error).__name__
    return " ".join(text.split()) or type(error).__name__


def _gltf_scenes(path) -> int:
    """How many scenes a glTF file has, 0 for other files. Newer versions of Blender hide all but one."""
    ending = Path(path).suffix.lower()
    if ending not in (".glb", ".gltf"):
        return 0
    data = Path(path).read_bytes()
    if ending == ".glb":  # a header of 12 bytes, then the length and the kind of the part that is JSON
        data = data[20 : 20 + int.from_bytes(data[12:16], "little")]
    return len(json.loads(data.decode("utf-8-sig")).get("scenes", ()))


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
