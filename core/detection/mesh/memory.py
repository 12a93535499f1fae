# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said when a mesh is too large for the memory."""

from __future__ import annotations

from contextlib import contextmanager

from ...errors import InputError


@contextmanager
def room_for(faces: int):
    """Turns a MemoryError within into an InputError that says how many faces were too many, and what to do."""
    try:
        yield
    except MemoryError:
        raise InputError(f"not enough memory for {faces} faces: decimate the mesh first") from None
