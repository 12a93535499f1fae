# SPDX-License-Identifier: GPL-3.0-or-later
"""How time and memory grow with the input: `python -m benchmarks.scaling [--sizes 5x3 20x7] [--limit 180]`.

Each size is a wall of so many columns and rows of one window, damaged as scans are, that a program completes in a
process of its own. Seconds and peak memory are those that the system counts for that process. The exponent e of two
neighbouring rows says that seconds grew as samples^e; below the table stands the one that fits all of them.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import tempfile
from pathlib import Path

import numpy as np

from . import programs
from .scenes import EDGE_LENGTH, Scene, obj_text, ornaments
from .scenes.damage import LEVELS, damaged, random_pose
from .scenes.layouts import cells, courses
from .scenes.network import Network, shifts
from .scenes.shapes import resample

SIZES = ("5x3", "8x4", "13x4", "12x6", "20x7")
"""Walls of about 11,000 to 102,000 samples at medium damage."""
LARGEST = "39x14"
"""About 400,000 samples."""


def size_of(text) -> tuple[int, int]:
    """Columns and rows of `20x7`."""
    columns, _, rows = text.partition("x")
    return int(columns), int(rows)


def wall(columns: int, rows: int, level: str = "medium", seed: int = 1) -> Scene:
    """A grid of pointed windows between two cornices; walls of one seed have the same window and steps."""
    design = np.random.default_rng(seed)
    step = design.uniform(1.6, 2.0), design.uniform(2.4, 2.8)
    network, at = Network(), cells(columns, rows, (step[0], 0), (0, step[1]))
    network.repeat(ornaments.gothic_window(design), shifts(at))
    courses(network, at, below=0.5, above=2.2)
    rng = np.random.default_rng([seed, columns, rows])
    turn, place = random_pose(rng)
    truth = [resample(c, EDGE_LENGTH) @ turn.T + place for c in network.curves]
    curves, labels = damaged(truth, network.labels, LEVELS[level], step=EDGE_LENGTH, rng=rng)
    return Scene(curves, np.array(labels, np.int64), truth, np.array(network.labels, np.int64))


def measure(scene, program, *, limit: float) -> dict:
    """One run: samples, seconds, bytes, and what was found."""
    with tempfile.TemporaryDirectory() as folder:
        obj, report = Path(folder) / "wall.obj", Path(folder) / "report.json"
        obj.write_text(obj_text(scene.curves), encoding="ascii")
        command = [*program, str(obj), "--edge-length", str(EDGE_LENGTH), "--report", str(report)]
        run = programs.run(command, limit=limit)
        done = run.code == 0 and report.is_file()
        document = json.loads(report.read_text(encoding="utf-8")) if done else {"templates": [], "seconds": {}}
    return {
        "samples": sum(map(len, scene.curves)),
        "done": done,
        "said": "" if done else run.said,
        "in_time": run.in_time,
        "seconds": run.wall,
        "cpu": run.cpu,
        "peak": run.peak,
        "occurrences": max((len(t["occurrences"]) for t in document["templates"]), default=0),
        "stages": document["seconds"],
    }


def exponent(results, key="seconds") -> float:
    """The slope of log seconds over log samples by least squares; NaN of fewer than two runs."""
    done = [r for r in results if r["done"]]
    if len({r["samples"] for r in done}) < 2:
        return float("nan")
    return float(np.polyfit(np.log([r["samples"] for r in done]), np.log([r[key] for r in done]), 1)[0])


def expected(results, samples) -> float:
    """Seconds that a larger wall should take by the runs so far; 0 where they do not tell."""
    done = [r for r in results if r["done"]][-2:]
    slope = exponent(done)
    return done[-1]["seconds"] * (samples / done[-1]["samples"]) ** slope if np.isfinite(slope) else 0.0


def line_of(result, before) -> str:
    """One row of the table."""
    if not result["done"]:
        last = result["said"].splitlines()[-1:]
        why = "not in time" if not result["in_time"] else f"no result: {last[0] if last else 'nothing was said'}"
        return f"{result['size']:>7s} {result['samples']:9,d}  {why}"
    slope = exponent([*before[-1:], result])
    return (
        f"{result['size']:>7s} {result['samples']:9,d} {result['seconds']:8.1f} {result['cpu']:8.1f}"
        f" {result['peak'] / 1e6:8.0f} {'' if np.isnan(slope) else f'{slope:.2f}':>8s}"
        f" {result['occurrences']:5d} of {result['windows']}"
    )


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scaling", description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", nargs="+", default=list(SIZES), metavar="NxM", help="columns x rows, rising")
    parser.add_argument("--largest", action="store_true", help=f"{LARGEST} too, about 400,000 samples")
    parser.add_argument("--level", choices=[name for name in LEVELS if LEVELS[name]], default="medium")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for a run; what should take longer is left")
    parser.add_argument("--program", help="command line of the program (default: run.py under this Python)")
    parser.add_argument("--out", type=Path, help="file for the results, a JSON object a line")
    options = parser.parse_args(arguments)
    program = shlex.split(options.program) if options.program else programs.DEFAULT
    results, lines = [], []
    print(f"{'wall':>7s} {'samples':>9s} {'seconds':>8s} {'cpu':>8s} {'MB':>8s} {'exponent':>8s} occurrences")
    for size in [*options.sizes, *([LARGEST] if options.largest else [])]:
        columns, rows = size_of(size)
        scene = wall(columns, rows, options.level, options.seed)
        samples, guess = sum(map(len, scene.curves)), expected(results, sum(map(len, scene.curves)))
        if guess > options.limit:
            print(f"{size:>7s} {samples:9,d}  left out: {guess:.0f} s are expected")
            continue
        result = {"size": size, "windows": columns * rows, **measure(scene, program, limit=options.limit)}
        print(line_of(result, results), flush=True)
        results += [result] if result["done"] else []
        lines.append(json.dumps(result))
        if options.out:
            options.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"exponent of all: {exponent(results):.2f} by the clock, {exponent(results, 'cpu'):.2f} by processor time")
    return 0 if len(results) == len(lines) else 1


if __name__ == "__main__":
    sys.exit(main())
