# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of the command line; what draws them is not part of the extension."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from ...core.errors import InputError
from .. import installation


def figure():
    """The module that draws. Raises InputError where it, or matplotlib, is missing."""
    root = __package__.rsplit(".", 2)[0]
    if not (installation.ROOT / "benchmarks" / "figure.py").exists():
        raise InputError("--figure is not in the extension; use run.py of the project's folder")
    if find_spec("matplotlib") is None:
        raise InputError("--figure needs matplotlib: `pip install matplotlib` for the Python that runs this")
    return import_module(f"{root}.benchmarks.figure")
