# SPDX-License-Identifier: GPL-3.0-or-later
"""The program without a window: files in, completed network out. Blender is used only for .blend files."""

from __future__ import annotations

import signal
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from ...core.errors import Cancelled, InputError
from ...core.files.formats import is_blenders, mean_edge_length
from ...core.files.readers.dxf import require_ezdxf
from ...core.files.reading import METRES, UNITS, concatenate
from .. import installation, scans
from . import arguments, inputs, writing
from .figure import figure
from .outputs import Outputs
from .terminal import Terminal

DONE, WRONG, STOPPED = 0, 2, 130


def main(argv, prog="run.py") -> int:
    """Run the program; its exit code. Nothing but a fault of the program itself is raised."""
    terminal = Terminal()
    try:
        with _interruptible():
            options = arguments.parser(prog).parse_args(argv)
            terminal.quiet = options.quiet
            _run(options, terminal)
    except InputError as error:
        terminal.error(error)
        return WRONG
    except (KeyboardInterrupt, Cancelled):
        terminal.error("stopped, nothing was written")
        return STOPPED
    except SystemExit as stop:  # --help
        return int(stop.code or DONE)
    return DONE


def _run(options, terminal):
    parameters, detection = arguments.parameters(options), arguments.detection_parameters(options)
    kinds = arguments.kinds(options)
    wanted = _wanted(options)
    sources = [*options.input, *([options.surface] if options.surface else [])]
    with Outputs(wanted.values(), sources) as outputs:
        began = time.perf_counter()
        given = inputs.read(options, terminal.say)
        seconds = {"read": time.perf_counter() - began}
        began = time.perf_counter()
        parts, detected = _detect(given, detection, kinds, terminal)
        seconds["detect"] = time.perf_counter() - began
        if options.detect_only:
            said = writing.write_detected(detected, detection, kinds, seconds, wanted, outputs, _name(options), given)
        else:
            reading = concatenate(parts)
            reading = replace(reading, units=reading.units or given.dxf_units)
            edge_length, origin = _edge_length(options, reading, given)
            if len(detected) < len(parts):  # detected curves meet where they meet
                reading = _joined(reading, options.weld * edge_length)
            terminal.say(
                f"{reading.count} curves, {len(reading.curves.points)} points, "
                f"edge length {_worded(edge_length, reading.units, given)} ({origin})"
            )
            completion = _complete(reading.curves, edge_length, parameters, terminal)
            fitted = _fitted(completion, reading, parameters)
            document = _report(completion, reading, parameters, seconds, fitted)
            document["left_out"] = given.left_out
            document["detection"] = writing.described(detected, detection, kinds)
            writing.write(
                completion, document, reading, wanted, outputs, _name(options), given.shift,
                fitted=fitted, parameters=parameters,
            )  # fmt: skip
            said = writing.summary_line(document)
    terminal.say(said + writing.written(wanted))


def _detect(given, parameters, kinds, terminal):
    """The readings of all parts of Inputs, and what was Detected in those that are scans."""
    detected = []

    def read(part):
        if not isinstance(part, scans.Scan):
            return part
        found = scans.detect(part, parameters, kinds, terminal.progress)
        terminal.say(
            f"{part.name}: {len(found.found)} feature curves on {found.faces} faces, "
            f"edge length {_worded(found.edge_length, 0, given)}, smoothed by {found.found.detail:.2g} of it"
        )
        for remark in found.remarks:
            terminal.say(f"{part.name}: {remark}")
        detected.append(found)
        return found.reading

    return inputs.each(given.parts, read, terminal.say), detected


def _wanted(options) -> dict:
    """Output name -> path, after what each needs was looked for."""
    wanted = {name: getattr(options, name) for name in ("out", "curves", "report", "figure") if getattr(options, name)}
    endings = {"out": (".blend",), "curves": writing.CURVE_FILES, "report": (".json",)}
    for name, path in wanted.items():
        if name in endings and Path(path).suffix.lower() not in endings[name]:
            raise InputError(f"{path}: --{name} writes a {' or '.join(endings[name])} file; end the name so")
    if any(Path(path).suffix.lower() == ".dxf" for path in (*options.input, *wanted.values())):
        require_ezdxf()
    for path in (*options.input, options.surface, wanted.get("out")):
        if path and is_blenders(path):
            installation.require_blender(path)
    if "figure" in wanted:
        figure()
    return wanted


def _worded(edge_length, units, given) -> str:
    """An edge length as a number in the coordinates, and with the unit that a drawing or a scene has.

    units : DXF's code of the unit, 0 where it is not known
    """
    if given.unit is not None and given.unit.metres:
        return f"{edge_length:.4g}, {given.unit.words(edge_length)} in the scene"
    return f"{edge_length:.4g} {UNITS[units]}" if units in UNITS else f"{edge_length:.4g}"


def _edge_length(options, reading, given):
    """The edge length in scene units, and in words where it is from."""
    if options.surface:
        return mean_edge_length(*inputs.surface(options.surface)), f"mean edge of {Path(options.surface).name}"
    if options.edge_length:
        metres = METRES.get(reading.units) if given.unit is None else given.unit.metres
        return options.edge_length.among(metres), "as given"
    if reading.edge_length:
        return reading.edge_length, "mean edge of the scan"
    installation.require_scipy()
    from ...core.network.edge_length import estimate

    found = estimate(reading.curves, crossings=reading.crossings)
    if found.outline is not None:
        said = f"coarse: taken for a drawing, a fiftieth of a typical outline, which measures {found.outline:.3g}"
    elif found.spread is not None:
        said = "coarse: the middle of segments that are {:.3g} to {:.3g} long".format(*found.spread)
    else:
        said = "estimated from the curves"
    return found.length, f"{said}; --edge-length or --surface set it"


def _joined(reading, tolerance):
    installation.require_scipy()
    from ...core.files.joining import join

    return join(reading, tolerance)


def _complete(curves, edge_length, parameters, terminal):
    installation.require_scipy()
    from ...core.pipeline import complete

    return complete(curves, edge_length=edge_length, parameters=parameters, progress=terminal.progress)


def _fitted(completion, reading, parameters):
    from ...core.fitting import fit_completion

    return fit_completion(completion, reading.curves, smoothing=parameters.smoothing)


def _report(completion, reading, parameters, seconds, fitted):
    from ...core.report import report

    return report(
        completion, reading.curves, version=installation.version(), parameters=parameters, fitted=fitted,
        count=reading.count, shares=reading.shares, seconds=seconds,
    )  # fmt: skip


def _name(options):
    return ", ".join([*options.object, *options.collection]) or Path(options.input[0]).stem


@contextmanager
def _interruptible():
    """Let Ctrl-C raise KeyboardInterrupt: Blender in background swallows the first one."""
    try:
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
    except ValueError:  # not the main thread: whoever runs us there stops us
        yield
        return
    try:
        yield
    finally:
        if before is not None:
            signal.signal(signal.SIGINT, before)
