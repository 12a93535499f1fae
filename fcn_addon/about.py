# SPDX-License-Identifier: GPL-3.0-or-later
"""What the manifest says of this program."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def version() -> str:
    """The version in the manifest."""
    with open(ROOT / "blender_manifest.toml", "rb") as file:
        return tomllib.load(file)["version"]
