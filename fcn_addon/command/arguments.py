# SPDX-License-Identifier: GPL-3.0-or-later
"""The arguments of the command line; those of the method and of detection are made from their parameters."""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass, fields
from math import isfinite
from typing import NoReturn

from ...core.detection.parameters import DetectionParameters
from ...core.errors import InputError
from ...core.files.formats import endings
from ...core.files.reading import WELD
from ...core.parameters import Parameters

DESCRIPTION = """\
Makes a clean, complete network of feature curves from a scan, or from noisy curves: detects the feature curves of
a mesh, finds what recurs in them, merges the occurrences into clean templates, puts these back wherever they were
seen, keeps strong single curves and drops noise."""

INPUTS = f"""\
one or more files. Scans, meshes with faces: {", ".join(endings("surface"))}. Curves: {", ".join(endings("curves"))};
README says what of each is read. Several are taken as one network. A file with faces and edges is a scan"""

KINDS = {
    "ridges": (True, "where the surface is bent outwards"),
    "valleys": (True, "where it is bent inwards"),
    "sharp": (False, "edges of the mesh that bend it by sharp_angle, for CAD-like and low-poly meshes"),
    "boundary": (False, "open borders of the mesh"),
}

EXIT_CODES = "exit codes: 0 done, 2 wrong usage or input, 130 stopped by Ctrl-C (nothing is written then)"


class _Parser(argparse.ArgumentParser):
    def error(self, message) -> NoReturn:
        raise InputError(f"{message}; `{self.prog} --help` lists what there is")


def parser(prog) -> argparse.ArgumentParser:
    """The parser; what is wrong raises InputError, only --help and --version exit."""
    made = _Parser(prog=prog, description=DESCRIPTION, epilog=EXIT_CODES, allow_abbrev=False)
    made.add_argument("input", nargs="+", metavar="INPUT", help=INPUTS)
    scene = made.add_argument_group(
        "what to take of a .blend or another scene (default: all curves that it shows, else its scans)"
    )
    scene.add_argument("--object", action="append", default=[], metavar="NAME", help="an object; may be repeated")
    scene.add_argument(
        "--collection", action="append", default=[], metavar="NAME",
        help="a collection with those inside it; may be repeated",
    )  # fmt: skip
    scene.add_argument("--hidden", action="store_true", help="take what is hidden or excluded too")
    out = made.add_argument_group("what to write")
    out.add_argument("--out", metavar="FILE.blend", help="the result as Blender collections")
    out.add_argument(
        "--curves", metavar="FILE", help=(
            "the completed network: .obj polylines; .dxf a block for each template; .svg the main plane of it"
        ),
    )  # fmt: skip
    out.add_argument("--report", metavar="FILE.json", help="all that was found, see docs/report.md")
    out.add_argument("--figure", metavar="FILE.png", help="four pictures: input, completed, components, templates")
    out.add_argument(
        "--detect-only", action="store_true", help="write the feature curves of the scan as they are, not completed"
    )
    length = made.add_argument_group(
        "edge length (default: that of the scan, else estimated from the curves)"
    ).add_mutually_exclusive_group()
    length.add_argument(
        "--edge-length", "--edge_length", type=_edge_length, metavar="H",
        help="mean edge length of the scan that the curves come from [units of its coordinates; of a scene or a drawing"
        " that has a unit also as 5cm, 0.2in]",
    )  # fmt: skip
    length.add_argument("--surface", metavar="SCAN", help="that scan; only its mean edge length is taken")
    made.add_argument(
        "--weld", type=_weld, default=WELD, metavar="W",
        help=f"ends this near to another curve are on it [edge lengths, default {WELD:g}; 0: only equal points]",
    )  # fmt: skip
    _add_detection(made.add_argument_group("feature curves of a scan, see docs/detection.md"))
    _add_parameters(made.add_argument_group("parameters of the method, with the names of the paper"), Parameters)
    made.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return made


def _add_detection(group):
    for name, (default, words) in KINDS.items():
        group.add_argument(
            f"--{name}", action=argparse.BooleanOptionalAction, default=default,
            help=f"{words} [{'on' if default else 'off'} by default]",
        )  # fmt: skip
    group.add_argument(
        "--take-edges",
        action="store_true",
        help="of a file with faces and edges take the edges as curves, of a mesh with faces its loose edges",
    )
    _add_parameters(group, DetectionParameters)


def _add_parameters(group, of):
    for f in fields(of):
        names = dict.fromkeys((f"--{f.name.replace('_', '-')}", f"--{f.name}"))
        group.add_argument(
            *names, dest=f.name, type=_whole if isinstance(f.default, int) else _number, default=f.default,
            metavar="N", help=f"{f.metadata['help']} [{f.metadata['unit']}, default {f.default:g}]".replace("%", "%%"),
        )  # fmt: skip


def parameters(options) -> Parameters:
    """The validated parameters of the method."""
    return _validated(options, Parameters)


def detection_parameters(options) -> DetectionParameters:
    """The validated parameters of detection."""
    return _validated(options, DetectionParameters)


def kinds(options) -> dict:
    """Which kinds of feature curves are asked for. Raises InputError for none."""
    chosen = {name: getattr(options, name) for name in KINDS}
    if not any(chosen.values()):
        raise InputError("no kind of feature curve is asked for: add --ridges, --valleys, --sharp or --boundary")
    return chosen


def _validated(options, of):
    return of(**{f.name: getattr(options, f.name) for f in fields(of)}).validate()


def _number(word) -> float:
    try:
        return float(word)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word!r} is not a number") from None


def _whole(word) -> int:
    try:
        return int(word)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{word!r} is not a whole number") from None


def _weld(word) -> float:
    value = _number(word)
    if not (isfinite(value) and value >= 0):
        raise argparse.ArgumentTypeError(f"{word} is no tolerance; give a number of at least 0 in edge lengths")
    return value


SIZES = {"mm": 0.001, "cm": 0.01, "dm": 0.1, "m": 1.0, "km": 1000.0, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}
"""Metres of the units that an edge length may have."""


@dataclass(frozen=True)
class Length:
    """A length as it was given: a number, and the metres of its unit, None where it is that of the coordinates."""

    number: float
    unit: float | None

    def among(self, metres) -> float:
        """The length in units of coordinates that are `metres` long. Raises InputError where that is None."""
        if self.unit is None:
            return self.number
        if metres is None:
            raise InputError(
                "--edge-length has a unit, but the inputs have none; give the number alone, in their coordinates"
            )
        return self.number * self.unit / metres


def _edge_length(word) -> Length:
    found = re.fullmatch(r"(.*?)\s*([a-z]*)", word.strip(), re.DOTALL)
    number, unit = found.groups() if found else (word, "")
    if unit not in SIZES:
        number, unit = word, ""
    value = _number(number)
    if not (isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{word} is no length; give a number above 0 in units of the coordinates")
    return Length(value, SIZES.get(unit))
