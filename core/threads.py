# SPDX-License-Identifier: GPL-3.0-or-later
"""The threads of numpy's OpenBLAS, which stand in the way of our own.

The method works on blocks in threads of its own. When each small matrix product inside them wakes threads again, they
wait for each other: two threads then take longer than one.
"""

from __future__ import annotations

import ctypes
from contextlib import contextmanager
from pathlib import Path

import numpy as np

NAMES = ("scipy_openblas_{}_num_threads64_", "openblas_{}_num_threads64_", "openblas_{}_num_threads")


@contextmanager
def single_threaded():
    """Within, matrix products of numpy's wheels run in the thread that asks; other builds do as they did."""
    before = [(set_threads, get_threads()) for set_threads, get_threads in _libraries()]
    for set_threads, _ in before:
        set_threads(1)
    try:
        yield
    finally:
        for set_threads, count in before:
            set_threads(count)


def _libraries():
    """Functions (set, get) of the OpenBLAS libraries that came with numpy; they are loaded already."""
    package = Path(np.__file__).parent
    found = []
    for folder in (package.parent / "numpy.libs", package / ".dylibs"):
        for path in sorted(folder.glob("*openblas*")):
            try:
                library = ctypes.CDLL(str(path))
            except OSError:
                continue
            for name in NAMES:
                try:
                    set_threads, get_threads = (getattr(library, name.format(verb)) for verb in ("set", "get"))
                except AttributeError:
                    continue
                set_threads.argtypes, set_threads.restype = [ctypes.c_int], None
                get_threads.argtypes, get_threads.restype = [], ctypes.c_int
                found.append((set_threads, get_threads))
                break
    return found
