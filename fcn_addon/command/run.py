# SPDX-License-Identifier: GPL-3.0-or-later
"""The program without a window: files in, completed network out. Blender is used only for .blend files."""

from __future__ import annotations

import signal
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from ...core.errors import Cancelled, InputError
from ...core.files.network import concatenate
from ...core.files.reading import mean_edge_length, read_surface
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
        return stop.code or DONE
    return DONE


def _run(options, terminal):
    parameters, detection = arguments.parameters(options), arguments.detection_parameters(options)
    kinds = arguments.kinds(options)
    wanted = _wanted(options)
    sources = [*options.input, *([options.surface] if options.surface else [])]
    with Outputs(wanted.values(), sources) as outputs:
        began = time.perf_counter()
        parts = inputs.read(options, terminal.say)
        seconds = {"read": time.perf_counter() - began}
        began = time.perf_counter()
        parts, detected = _detect(parts, detection, kinds, terminal)
        seconds["detect"] = time.perf_counter() - began
        if options.detect_only:
            said = writing.write_detected(detected, detection, kinds, seconds, wanted, outputs, _name(options))
        else:
            reading = concatenate(parts)
            edge_length = _edge_length(options, reading)
            terminal.say(
                f"{reading.count} curves, {len(reading.curves.points)} points, edge length {edge_length:.4g} "
                f"({_origin(options, reading)})"
            )
            completion = _complete(reading.curves, edge_length, parameters, terminal)
            document = _report(completion, reading, parameters, seconds)
            document["detection"] = writing.described(detected, detection, kinds)
            writing.write(completion, document, reading, wanted, outputs, _name(options))
            said = writing.summary_line(document)
    terminal.say(said + writing.written(wanted))


def _detect(parts, parameters, kinds, terminal):
    """The readings of all parts, and what was Detected in those that are scans."""
    readings, detected = [], []
    for part in parts:
        if isinstance(part, scans.Scan):
            found = scans.detect(part, parameters, kinds, terminal.progress)
            terminal.say(
                f"{part.name}: {len(found.found)} feature curves on {found.faces} faces, "
                f"edge length {found.edge_length:.4g}, smoothed by {found.found.detail:.2g} of it"
            )
            detected.append(found)
            part = found.reading
        readings.append(part)
    return readings, detected


def _wanted(options) -> dict:
    """Output name -> path, after what each needs was looked for."""
    wanted = {name: getattr(options, name) for name in ("out", "curves", "report", "figure") if getattr(options, name)}
    endings = {"out": ".blend", "curves": ".obj", "report": ".json"}
    for name, path in wanted.items():
        if name in endings and Path(path).suffix.lower() != endings[name]:
            raise InputError(f"{path}: --{name} writes a {endings[name]} file; end the name so")
    if ("out" in wanted or any(inputs.is_blend(path) for path in options.input)) and find_spec("bpy") is None:
        raise InputError(
            "a .blend file needs Blender: use `blender -b -P run.py -- …`, or `pip install bpy` for this Python"
        )
    if "figure" in wanted:
        figure()
    return wanted


def _edge_length(options, reading):
    from ...core.network.edge_length import estimate_edge_length

    if options.surface:
        return mean_edge_length(*read_surface(options.surface))
    known = options.edge_length or reading.edge_length
    return known or estimate_edge_length(reading.curves, crossings=reading.crossings)


def _origin(options, reading):
    if options.surface:
        return f"mean edge of {Path(options.surface).name}"
    if options.edge_length:
        return "as given"
    if reading.edge_length:
        return "mean edge of the scan"
    return "estimated from the curves; --edge-length or --surface set it"


def _complete(curves, edge_length, parameters, terminal):
    installation.require_scipy()
    from ...core.pipeline import complete

    return complete(curves, edge_length=edge_length, parameters=parameters, progress=terminal.progress)


def _report(completion, reading, parameters, seconds):
    from ...core.report import report

    return report(
        completion, reading.curves, version=installation.version(), parameters=parameters, count=reading.count,
        seconds=seconds,
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
