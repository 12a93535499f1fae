# SPDX-License-Identifier: GPL-3.0-or-later
"""What is installed of this program: its version, and the library that it needs."""

from __future__ import annotations

import tomllib
from importlib.util import find_spec
from pathlib import Path

from ..core.errors import InputError

ROOT = Path(__file__).resolve().parent.parent


def version() -> str:
    """The version in the manifest."""
    with open(ROOT / "blender_manifest.toml", "rb") as file:
        return tomllib.load(file)["version"]


def require_scipy():
    """Raise InputError where scipy is missing, in words that help."""
    try:
        import scipy  # noqa: F401
    except ModuleNotFoundError:
        raise InputError("scipy is missing: install the extension's zip for this platform again") from None


def require_blender(path):
    """Raise InputError where there is no Blender to read or write a file."""
    if find_spec("bpy") is None:
        raise InputError(
            f"{path}: a {Path(path).suffix.lower()} file needs Blender: use `blender -b -P run.py -- ...`,"
            " or `pip install bpy` for this Python"
        )
