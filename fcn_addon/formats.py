# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that only Blender reads."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from ..core.errors import InputError

IMPORTED = (".abc", ".dae", ".fbx", ".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz")
BLENDER = (".blend", *IMPORTED)


def is_blenders(path) -> bool:
    """Whether a file is one that only Blender reads."""
    return Path(path).suffix.lower() in BLENDER


def require_blender(path):
    """Raise InputError where there is no Blender to read or write a file."""
    if find_spec("bpy") is None:
        raise InputError(
            f"{path}: a {Path(path).suffix.lower()} file needs Blender: use `blender -b -P run.py -- ...`,"
            " or `pip install bpy` for this Python"
        )
