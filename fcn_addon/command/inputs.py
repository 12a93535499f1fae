# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line's inputs hold: curves, or scans whose curves are to be detected."""

from __future__ import annotations

from pathlib import Path

from ...core.errors import InputError
from ...core.files.reading import CURVE_READERS, SURFACE_READERS, content, read_curves, read_surface
from ..formats import BLENDER, is_blenders
from ..scans import Scan


def read(options, say):
    """A Reading or a Scan for each of what the inputs hold, in their order; and what was left out, rows of the report.

    Parameters
    ----------
    options : of the command line
    say : called with a line where something is left out
    """
    blenders = [path for path in options.input if is_blenders(path)]
    for name in ("object", "collection", "hidden"):
        if getattr(options, name) and not blenders:
            raise InputError(f"--{name} chooses from a .blend file or another scene; give one, or leave it out")
    found, rows = [], []
    for path in options.input:
        if path in blenders:
            parts, skipped = _read_scene(path, options, say)
            found += parts
            rows += [{"file": str(path), **row} for row in skipped.rows()]
        else:
            found.append(_read(path, options.take_edges, say))
    _check(options, found)
    return found, rows


def _read_scene(path, options, say):
    from . import blend_file

    choice = blend_file.Choice(tuple(options.object), tuple(options.collection), options.hidden, options.take_edges)
    return blend_file.read(path, choice, say)


def _read(path, take_edges, say):
    suffix = Path(path).suffix.lower()
    if suffix not in CURVE_READERS and suffix not in SURFACE_READERS:
        known = ", ".join(sorted({*CURVE_READERS, *SURFACE_READERS, *BLENDER}))
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
