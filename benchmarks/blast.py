# SPDX-License-Identifier: GPL-3.0-or-later
"""Speed beside the yardstick, and memory: `python -m benchmarks.blast SCENES... [--memory 50000]`.

The yardstick is Algorithm 1 taken at its word (`literal_blast.cpp`), compiled here and run on the same curves right
before the method. Both count point pairs alike: for two curves of na and nb samples, 2 (na - l0 + 1) (nb - l0 + 1).
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from .quality import completed
from .scenes import EDGE_LENGTH, LAYOUTS, Scene, load_scene, make_scene, obj_text

SOURCE = Path(__file__).with_name("literal_blast.cpp")
L0 = 25
GOAL = 60.0
"""How many times faster than the yardstick a pair of points must be."""
MEMORY_GOAL = 2e9
"""Bytes that a run on 50,000 strong samples may take."""


def compile_yardstick(folder: Path) -> Path:
    """Compile the yardstick with the C++ compiler that is found; returns the program."""
    compiler = next((c for c in map(shutil.which, ("g++", "clang++", "c++")) if c), None)
    if compiler is None:
        raise SystemExit("no C++ compiler is found: install g++ or clang++ to build the yardstick")
    program = folder / "literal_blast"
    flags = ["-std=c++17", "-O3", "-march=native", "-ffast-math"]
    subprocess.run([compiler, *flags, str(SOURCE), "-o", str(program)], check=True)
    return program


def yardstick(program: Path, obj: Path, *, edge_length=EDGE_LENGTH, l0=L0, seconds=10.0) -> dict:
    """What the yardstick measures on an OBJ file in about the given time."""
    command = [str(program), str(obj), repr(edge_length), str(l0), repr(seconds)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def compare(program: Path, scene, *, seconds=10.0) -> dict:
    """Yardstick and method on one scene: counts, ns per point pair, ratio, and the times of the whole."""
    with tempfile.TemporaryDirectory() as folder:
        obj = Path(folder) / "scene.obj"
        obj.write_text(obj_text(scene.curves), encoding="ascii")
        plain = yardstick(program, obj, seconds=seconds)
    document, whole = completed(scene)
    work, blast = document["work"], document["seconds"]["blast"]
    ns = blast / max(work["point_pairs"], 1) * 1e9
    return {
        "strong_samples": work["strong_samples"],
        "point_pairs": work["point_pairs"],
        "plain_strong_samples": plain["strong_samples"],
        "plain_point_pairs": plain["point_pairs"],
        "plain_ns_per_pair": plain["ns_per_pair"],
        "ns_per_pair": ns,
        "times_faster": plain["ns_per_pair"] / ns if ns > 0 else float("inf"),
        "plain_projected_seconds": plain["projected_seconds"],
        "blast_seconds": blast,
        "whole_seconds": whole,
        "whole_below_plain": whole < plain["projected_seconds"],
    }


def strong_length(curves) -> float:
    """Samples that the curves longer than l0 edges will have, in all."""
    lengths = np.array([np.linalg.norm(np.diff(c, axis=0), axis=1).sum() for c in curves]) / EDGE_LENGTH
    return float(lengths[lengths > L0].sum())


def wide_scene(samples: int) -> Scene:
    """Facades side by side with at least the given number of strong samples, and not many more."""
    curves, labels, seed = [], [], 0
    while strong_length(curves) < samples:
        seed += 1
        facade = make_scene("large", "light", seed, pose=False)
        aside = np.array([0.0, 60.0 * seed, 0.0])
        curves += [c + aside for c in facade.curves]
        labels += facade.labels.tolist()
    low, high = 0, len(curves)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if strong_length(curves[:middle]) >= samples else (middle, high)
    labels = np.array(labels[:high], np.int64)
    return Scene(curves[:high], labels, curves[:1], labels[:1])


def memory(samples: int) -> dict:
    """Peak memory of this process after the whole method on that many strong samples."""
    scene = wide_scene(samples)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    document, whole = completed(scene)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    work = document["work"]
    return {
        "strong_samples": work["strong_samples"],
        "point_pairs": work["point_pairs"],
        "bytes_before": before,
        "peak_bytes": peak,
        "whole_seconds": whole,
        "seconds": document["seconds"],
    }


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.blast", description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path, help="npz scenes, or folders of them")
    parser.add_argument("--layout", nargs="+", choices=LAYOUTS, default=[], help="scenes to make and measure")
    parser.add_argument("--level", default="hard")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=10.0, help="time that the yardstick may take on each scene")
    parser.add_argument("--memory", type=int, metavar="SAMPLES", help="peak memory at that many strong samples")
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    options = parser.parse_args(arguments)
    if not (options.paths or options.layout or options.memory):
        parser.error("name scenes or a --layout, or take --memory 50000")
    failed = False
    if options.memory:
        result = memory(options.memory)
        failed |= result["peak_bytes"] > MEMORY_GOAL
        show("memory", result, options.json)
    files = [f for p in options.paths for f in (sorted(p.glob("*.npz")) if p.is_dir() else [p.with_suffix(".npz")])]
    scenes = [(f.stem, load_scene(f)) for f in files]
    scenes += [(f"{name}-{options.level}-{options.seed}", make_scene(name, options.level, options.seed))
               for name in options.layout]  # fmt: skip
    if scenes:
        with tempfile.TemporaryDirectory() as folder:
            program = compile_yardstick(Path(folder))
            for name, scene in scenes:
                result = compare(program, scene, seconds=options.seconds)
                failed |= result["times_faster"] < GOAL or not result["whole_below_plain"]
                show(name, result, options.json)
    return int(failed)


def show(name, result, as_json) -> None:
    """Print one result as a JSON line or for the eye."""
    if as_json:
        print(json.dumps({"scene": name, **result}), flush=True)
        return
    number = {float: "{:,.2f}", int: "{:,}"}
    print(name, flush=True)
    for key, value in result.items():
        text = number[type(value)].format(value) if type(value) in number else str(value)
        print(f"    {key:24s} {text}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
