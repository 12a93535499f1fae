# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command line's inputs hold: curves, or scans whose curves are to be detected."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...core.errors import InputError, NoCurves
from ...core.files import formats
from ...core.files.reading import METRES
from ..scans import Scan


@dataclass(frozen=True)
class Unit:
    """metres : how long one unit of the coordinates is, None where that is not known; words : a length -> its words"""

    metres: float | None
    words: Callable


@dataclass(frozen=True)
class Inputs:
    """parts : a Reading, not joined, or a Scan for each of what the inputs hold, in their order

    left_out : rows of the report
    shift : (3,), where the origin of the first scene lies, None where no input is a scene
    unit : Unit of the first scene, None where no input is a scene
    """

    parts: list
    left_out: list
    shift: object = None
    unit: Unit | None = None

    @property
    def dxf_units(self) -> int:
        """DXF's code of the unit of the first scene, 0 where it has none that DXF knows."""
        size = self.unit.metres if self.unit else None
        return next((code for code, known in METRES.items() if size and abs(size / known - 1) < 1e-5), 0)


def read(options, say) -> Inputs:
    """What the inputs hold.

    Parameters
    ----------
    options : of the command line
    say : called with a line where of two things one is taken, or something is left out
    """
    for name in ("object", "collection", "hidden"):
        if getattr(options, name) and not any(map(formats.is_blenders, options.input)):
            raise InputError(f"--{name} chooses from a .blend file or another scene; give one, or leave it out")
    rows, scenes = [], []

    def parts(path):
        if not formats.is_blenders(path):
            return [_read(path, options.take_edges, say)]
        found, skipped, *scene = _read_scene(path, options, say)
        scenes.append(scene)
        rows.extend({"file": str(path), **row} for row in skipped.rows())
        return found

    found = [part for every in each(options.input, parts, say) for part in every]
    _check(options, found)
    return Inputs(found, rows, *(scenes[0] if scenes else ()))


def _read_scene(path, options, say):
    from . import blend_file

    choice = blend_file.Choice(tuple(options.object), tuple(options.collection), options.hidden, options.take_edges)
    found, skipped, shift = blend_file.read(path, choice, say)
    return found, skipped, shift, Unit(*blend_file.unit())


def surface(path):
    """Points (n, 3) float64 and triangles (m, 3) int64 of a file with faces, of a scene those of its first scan."""
    if not formats.is_blenders(path):
        return formats.read_surface(path)
    from . import blend_file

    found, _, _ = blend_file.read(path)
    scan = next((part for part in found if isinstance(part, Scan)), None)
    if scan is None:
        raise InputError(f"{path}: it has curves, and no scan is taken; give a file with the scan alone")
    return scan.points, scan.triangles


def each(items, work, say) -> list:
    """What `work` makes of each item; one without curves is passed over and named.

    Raises InputError where none is left, NoCurves for one alone.
    """
    made, empty = [], []
    for item in items:
        try:
            made.append(work(item))
        except NoCurves as error:
            empty.append(error)
    if not made:
        raise empty[0] if len(empty) == 1 else NoCurves(f"no input has curves: {'; '.join(map(str, empty))}")
    for reason in empty:
        say(f"passed over: {reason}")
    return made


def _read(path, take_edges, say):
    if formats.format_of(path) is None:
        suffix, known = Path(path).suffix.lower(), ", ".join(formats.endings())
        raise InputError(f"{path}: a {suffix or 'nameless'} file cannot be read; give one of {known}")
    has = formats.content(path)
    if Path(path).suffix.lower() == ".ply" and not has.faces and not has.curves:
        raise NoCurves(f"{path}: it has points only; export the scan with its faces, or curves with their edges")
    if take_edges and has.faces and not has.curves:
        raise NoCurves(f"{path}: it has no edges or lines of its own; leave --take-edges out to detect its curves")
    if has.faces and has.curves:
        say(
            f"{path} has faces and edges: the edges are taken"
            if take_edges
            else f"{path} has faces and edges: it is taken as a scan, its edges are left out; --take-edges takes them"
        )
    if has.faces and not take_edges:
        return Scan(str(path), *formats.read_surface(path))
    reading = formats.read_lines(path)
    if reading.left_out:
        say(f"{path}: left out are {reading.left_out}")
    return reading


def _check(options, found):
    if options.detect_only and not all(isinstance(part, Scan) for part in found):
        raise InputError("--detect-only is for scans, but there are inputs that are curves already; leave one out")
