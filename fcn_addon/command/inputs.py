# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line's inputs hold: curves, or scans whose curves are to be detected."""

from __future__ import annotations

from pathlib import Path

from ...core.errors import InputError
from ...core.files.reading import CURVE_READERS, SURFACE_READERS, content, read_curves, read_surface
from ..scans import Scan


def is_blend(path) -> bool:
    return Path(path).suffix.lower() == ".blend"


def read(options, say) -> list:
    """A Reading or a Scan for each of what the inputs hold, in their order.

    Parameters
    ----------
    options : of the command line
    say : called with a line where of two things one is taken
    """
    if (options.object or options.collection) and not any(is_blend(path) for path in options.input):
        raise InputError("--object and --collection choose from a .blend file; give one, or leave them out")
    found = []
    for path in options.input:
        if is_blend(path):
            from . import blend_file

            found += blend_file.read(path, options.object, options.collection, say)
        else:
            found.append(_read(path, options.take_edges, say))
    _check(options, found)
    return found


def _read(path, take_edges, say):
    suffix = Path(path).suffix.lower()
    if suffix not in CURVE_READERS and suffix not in SURFACE_READERS:
        known = ", ".join(sorted({*CURVE_READERS, *SURFACE_READERS, ".blend"}))
        raise InputError(f"{path}: a {suffix or 'nameless'} file cannot be read; give one of {known}")
    has = content(path)
    if suffix == ".ply" and not has.faces and not has.curves:
        raise InputError(f"{path}: it has points only; export the scan with its faces, or curves with their edges")
    if take_edges and has.faces and not has.curves:
        raise InputError(f"{path}: it has no edges or lines of its own; leave --take-edges out to detect its curves")
    if has.faces and has.curves:
        say(
            f"{path} has faces and edges: the edges are taken"
            if take_edges
            else f"{path} has faces and edges: it is taken as a scan, its edges are left out; --take-edges takes them"
        )
    if has.faces and not take_edges:
        return Scan(str(path), *read_surface(path))
    return read_curves([path])


def _check(options, found):
    if options.detect_only and not all(isinstance(part, Scan) for part in found):
        raise InputError("--detect-only is for scans, but there are inputs that are curves already; leave one out")
