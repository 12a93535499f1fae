# SPDX-License-Identifier: GPL-3.0-or-later
"""The program without a window: files in, completed network out. Blender is used only for .blend files."""

from __future__ import annotations

import json
import signal
import time
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from ..core.errors import Cancelled, InputError
from . import about, arguments
from .outputs import Outputs
from .terminal import Terminal, duration

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
    parameters = arguments.parameters(options)
    wanted = _wanted(options)
    inputs = [*options.input, *([options.surface] if options.surface else [])]
    with Outputs(wanted.values(), inputs) as outputs:
        began = time.perf_counter()
        reading = _read(options)
        edge_length = _edge_length(options, reading)
        seconds = {"read": time.perf_counter() - began}
        terminal.say(
            f"{reading.count} curves, {len(reading.curves.points)} points, edge length {edge_length:.4g} "
            f"({_origin(options)})"
        )
        completion = _complete(reading.curves, edge_length, parameters, terminal)
        began = time.perf_counter()
        document = _report(completion, reading, parameters, seconds)
        if "curves" in wanted:
            _write_curves(document, outputs.part(wanted["curves"]))
        if "figure" in wanted:
            _figure()(document, reading.curves, outputs.part(wanted["figure"]))
        if "out" in wanted:
            from . import blend_file

            blend_file.write(completion, reading.curves, outputs.part(wanted["out"]), _name(options))
        document["seconds"]["write"] = time.perf_counter() - began
        if "report" in wanted:
            Path(outputs.part(wanted["report"])).write_text(json.dumps(document), encoding="utf-8")
    terminal.say(_summary(document, wanted))


def _wanted(options) -> dict:
    """Output name -> path, after what each needs was looked for."""
    wanted = {name: getattr(options, name) for name in ("out", "curves", "report", "figure") if getattr(options, name)}
    endings = {"out": ".blend", "curves": ".obj", "report": ".json"}
    for name, path in wanted.items():
        if name in endings and Path(path).suffix.lower() != endings[name]:
            raise InputError(f"{path}: --{name} writes a {endings[name]} file; end the name so")
    if ("out" in wanted or any(_is_blend(path) for path in options.input)) and find_spec("bpy") is None:
        raise InputError(
            "a .blend file needs Blender: use `blender -b -P run.py -- …`, or `pip install bpy` for this Python"
        )
    if "figure" in wanted:
        _figure()
    return wanted


def _is_blend(path):
    return Path(path).suffix.lower() == ".blend"


def _read(options):
    from ..core.files.network import concatenate
    from ..core.files.reading import read_curves

    if (options.object or options.collection) and not any(_is_blend(path) for path in options.input):
        raise InputError("--object and --collection choose from a .blend file; give one, or leave them out")
    readings = []
    for path in options.input:
        if _is_blend(path):
            from . import blend_file

            readings.append(blend_file.read(path, options.object, options.collection))
        else:
            readings.append(read_curves([path]))
    return concatenate(readings)


def _edge_length(options, reading):
    from ..core.files.reading import mean_edge_length, read_surface
    from ..core.network import estimate_edge_length

    if options.surface:
        return mean_edge_length(*read_surface(options.surface))
    return options.edge_length or estimate_edge_length(reading.curves, crossings=reading.crossings)


def _origin(options):
    if options.surface:
        return f"mean edge of {Path(options.surface).name}"
    return "as given" if options.edge_length else "estimated from the curves; --edge-length or --surface set it"


def _complete(curves, edge_length, parameters, terminal):
    try:
        from ..core.pipeline import complete
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "scipy":
            raise
        raise InputError("scipy is missing: install the extension's zip for this platform again") from None
    return complete(curves, edge_length=edge_length, parameters=parameters, progress=terminal.progress)


def _report(completion, reading, parameters, seconds):
    from ..core.report import report

    return report(
        completion, reading.curves, version=about.version(), parameters=parameters, count=reading.count,
        seconds=seconds,
    )  # fmt: skip


def _write_curves(document, path):
    from ..core.files.obj import write_obj

    curves = document["curves"]
    groups = [
        f"template_{c['template']}_occurrence_{c['occurrence']}" if c["kind"] == "template" else "strong"
        for c in curves
    ]
    write_obj(path, [c["points"] for c in curves], [c["closed"] for c in curves], groups)


def _figure():
    """The function that draws the pictures; it is not part of the extension."""
    root = __package__.rpartition(".")[0]
    if not (about.ROOT / "benchmarks" / "figure.py").exists():
        raise InputError("--figure is not in the extension; use run.py of the project's folder")
    if find_spec("matplotlib") is None:
        raise InputError("--figure needs matplotlib: `pip install matplotlib` for the Python that runs this")
    return import_module(f"{root}.benchmarks.figure").draw


def _name(options):
    return ", ".join([*options.object, *options.collection]) or Path(options.input[0]).stem


def _summary(document, wanted) -> str:
    templates, curves = document["templates"], document["curves"]
    occurrences = sum(len(t["occurrences"]) for t in templates)
    strong = sum(c["kind"] == "strong" for c in curves)
    text = (
        f"{len(document['transformations'])} transformations, {len(templates)} templates at {occurrences} places, "
        f"{len(curves)} curves of which {strong} strong single ones; {duration(sum(document['seconds'].values()))}"
    )
    if not wanted:
        return text + "; nothing was written, --out, --curves, --report or --figure say where to"
    return text + "; wrote " + ", ".join(str(path) for path in wanted.values())


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
