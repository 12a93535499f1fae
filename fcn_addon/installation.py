# SPDX-License-Identifier: GPL-3.0-or-later
"""What is installed of this program: its version, and the library that it needs."""

from __future__ import annotations

import tomllib
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
