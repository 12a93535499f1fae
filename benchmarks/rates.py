# SPDX-License-Identifier: GPL-3.0-or-later
"""What each stage costs, for the estimate of time in the window: `python -m benchmarks.rates [--sizes 2x1 5x3 8x4]`.

Walls of several sizes and the example are completed in this process, and a scan is detected at several sizes. For
each stage a constant and a power of the size are fitted to the seconds. What is printed is the table of
`fcn_addon/rates.py`, and how wrong an estimate from it would have been. Run it again when a stage has become faster or
slower.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import nnls

from core.detection import TriangleMesh, detect, measure
from core.files.formats import read_curves
from core.fitting import fit_completion
from core.network.building import build_network
from core.pipeline import complete
from core.stages import STAGES
from core.values import Curves
from examples.make_scan import scan

from .scaling import size_of, wall
from .scenes import EDGE_LENGTH

SIZES = ("2x1", "2x2", "3x3", "5x3", "8x4")
SPACINGS = (0.04, 0.025, 0.016)
FACADE = Path(__file__).resolve().parent.parent / "examples" / "facade.obj"


class Stopwatch:
    """Seconds of each stage, from what a run reports; the smaller of the clock and of the processor.

    On a quiet machine threads make the clock the smaller one, beside other work it is the processor's.
    """

    def __init__(self):
        self.seconds, self._stage, self._since = {}, None, self._now()

    def _now(self):
        return np.array([time.perf_counter(), time.process_time()])

    def __call__(self, stage, fraction=0.0):
        if stage != self._stage:
            self.end()
            self._stage = stage

    def end(self):
        """The last stage is over."""
        now = self._now()
        if self._stage is not None:
            spent = float((now - self._since).min())
            self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + spent
        self._stage, self._since = None, now


def completed(curves, edge_length):
    """Samples of a network, and the seconds of each stage of its completion."""
    watch = Stopwatch()
    completion = complete(curves, edge_length=edge_length, progress=watch)
    watch("fitting")
    fit_completion(completion, curves)
    watch.end()
    return len(build_network(curves, edge_length=edge_length).points), watch.seconds


def detected(spacing):
    """Faces of a scan, and the seconds of each stage of its detection."""
    made, watch = scan(spacing=spacing), Stopwatch()
    mesh = TriangleMesh.of(made.vertices, made.faces, progress=watch)
    detect(mesh, field=measure(mesh, progress=watch), progress=watch)
    watch.end()
    return len(made.faces), watch.seconds


def fitted(sizes, seconds, at):
    """(seconds at any size, what comes to it at the size `at`, the power of the size with which that grows).

    Of powers from 0.8 to 2 the one with the least relative errors; the rest is least squares without negative numbers.
    """
    x, y = np.asarray(sizes, float) / at, np.maximum(seconds, 0.01)
    best = np.inf, (0.0, 0.0, 1.0)
    for slope in np.arange(0.8, 2.01, 0.1):
        (base, rate), left = nnls(np.stack([1 / y, x**slope / y], axis=1), np.ones(len(y)))
        best = min(best, (left, (float(base), float(rate), float(slope))))
    return best[1]


def table(rows, stages, at):
    """Stage -> what `fitted` gives for runs (size, stage -> seconds)."""
    return {s: fitted([n for n, _ in rows], [seconds.get(s, 0.0) for _, seconds in rows], at) for s in stages}


def told(rows, rates, at):
    """Lines that compare each run with what the table says of it."""
    for size, seconds in rows:
        guess = sum(base + rate * (size / at) ** slope for base, rate, slope in rates.values())
        took = sum(seconds.values())
        yield f"{size:9,d}  {took:7.1f} s, {guess:7.1f} s by the table: {guess / took:.2f}"


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.rates", description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", nargs="+", default=list(SIZES), metavar="NxM", help="walls, columns x rows")
    options = parser.parse_args(arguments)
    rows = [completed(read_curves([FACADE]).curves, 0.02)]
    for size in options.sizes:
        scene = wall(*size_of(size))
        rows.append(completed(Curves.from_list(scene.curves), EDGE_LENGTH))
        print(f"{size}: {rows[-1]}", file=sys.stderr, flush=True)
    scans = [detected(spacing) for spacing in SPACINGS]
    for name, found, stages, at in (
        ("COMPLETING", rows, (*STAGES, "fitting"), 10_000), ("DETECTING", scans, tuple(scans[0][1]), 100_000)
    ):  # fmt: skip
        rates = table(found, stages, at)
        print(f"{name} = {{")
        for stage, (base, rate, slope) in rates.items():
            print(f'    "{stage}": ({base:.2g}, {rate:.2g}, {slope:.1f}),')
        print("}")
        for line in told(found, rates, at):
            print("# " + line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
