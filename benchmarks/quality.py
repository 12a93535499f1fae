# SPDX-License-Identifier: GPL-3.0-or-later
"""Quality on scenes with known truth: `python -m benchmarks.quality FILES` or `--layout X --level Y --seed N`.

Each scene is completed in this process, one after the other, and measured; a line says what passes. With
`--report` an existing report is measured in place of a run.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from pathlib import Path

import numpy as np

from core.values import Curves

from .measures import measure
from .scenes import EDGE_LENGTH, LAYOUTS, LEVELS, load_scene, make_scene

GOALS = {
    "clean": {"out_F": (">=", 0.99)},
    "medium": {
        "out_F": (">=", 0.95),
        "completed": (">=", 0.90),
        "clutter_left": ("<=", 0.05),
        "rms_ratio": ("<=", 0.6),
        "instances_share": (">=", 0.9),
        "comp_F": (">=", 0.9),
    },
    "hard": {
        "out_F": (">=", 0.90),
        "completed": (">=", 0.80),
        "clutter_left": ("<=", 0.10),
        "rms_ratio": ("<=", 0.6),
        "instances_share": (">=", 0.8),
        "comp_F": (">=", 0.85),
    },
}
"""What a result must reach, for each level of damage; `light` must reach what `medium` must."""
SHOWN = ("out_F", "completed", "clutter_left", "rms_ratio", "instances_share", "comp_F", "rep_recall", "rep_prec")


def curves_of(scene) -> Curves:
    """The network of a scene as the method takes it; a curve that ends where it begins is closed."""
    loops = [len(c) > 3 and bool((c[0] == c[-1]).all()) for c in scene.curves]
    return Curves.from_list([c[:-1] if loop else c for c, loop in zip(scene.curves, loops, strict=True)], loops)


def completed(scene, *, edge_length=EDGE_LENGTH) -> tuple[dict, float]:
    """The report of the whole method on a scene and the wall clock seconds it took."""
    from core.parameters import Parameters
    from core.pipeline import complete
    from core.report import report

    curves, parameters = curves_of(scene), Parameters()
    begin = time.perf_counter()
    completion = complete(curves, edge_length=edge_length, parameters=parameters)
    seconds = time.perf_counter() - begin
    return report(completion, curves, version="benchmark", parameters=parameters, count=len(curves)), seconds


def measure_report(scene, document, *, edge_length=EDGE_LENGTH) -> dict:
    """The measures of a report, with the ratios that the goals are about."""
    result = measure(
        scene,
        [np.reshape(c["points"], (-1, 3)) for c in document["curves"]],
        document.get("inputs"),
        edge_length=edge_length,
    )
    result["rms_ratio"] = result["rms_out/h"] / result["rms_in/h"] if result["rms_in/h"] > 0 else 0.0
    result["instances_share"] = result["instances_90"] / max(result["instances"], 1)
    return result


def missed(result, level) -> list[str]:
    """The goals of a level that a result does not reach; a measure that is missing is not reached."""
    goals = GOALS["medium" if level == "light" else level]
    reached = {">=": lambda value, bound: value >= bound, "<=": lambda value, bound: value <= bound}
    value = {name: result.get(name, float("nan")) for name in goals}
    return [name for name, (sense, bound) in goals.items() if not reached[sense](value[name], bound)]


def level_of(name) -> str:
    """The level of damage in a scene's name, LAYOUT-LEVEL-SEED; `medium` where it names none."""
    return next((level for level in LEVELS if f"-{level}-" in f"{name}-"), "medium")


def scenes_of(options):
    """(name, level, Scene) of the files and folders and of the layouts, levels and seeds that were asked for."""
    for path in options.paths:
        for file in sorted(path.glob("*.npz")) if path.is_dir() else [path.with_suffix(".npz")]:
            if not options.level or level_of(file.stem) in options.level:
                yield file.stem, level_of(file.stem), load_scene(file)
    for layout in list(LAYOUTS) if options.all else options.layout:
        for level in options.level or ["medium", "hard"]:
            for seed in options.seed:
                yield f"{layout}-{level}-{seed}", level, make_scene(layout, level, seed)


def line_of(name, result, failures, seconds) -> str:
    """One line for the eye; measures that miss their goal carry a star."""
    parts = [f"{k} {result[k]:.3f}{'*' if k in failures else ''}" for k in SHOWN if k in result]
    absent = [f"{k} -*" for k in failures if k not in result]
    return f"{name:26s} {'FAIL' if failures else 'pass'}  " + "  ".join(parts + absent) + f"  {seconds:.1f} s"


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.quality", description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", type=Path, help="npz scenes, or folders of them")
    parser.add_argument("--layout", nargs="+", choices=LAYOUTS, default=[], help="scenes to make and measure")
    parser.add_argument("--all", action="store_true", help="every layout")
    parser.add_argument("--level", nargs="+", choices=LEVELS, help="levels of damage (default: medium hard)")
    parser.add_argument("--seed", nargs="+", type=int, default=[1])
    parser.add_argument("--estimate", action="store_true", help="leave the edge length to the method")
    parser.add_argument("--report", type=Path, help="measure this report against the one scene that is given")
    parser.add_argument("--save", type=Path, help="folder for the report of each run")
    parser.add_argument("--json", action="store_true", help="one JSON object a line in place of the table")
    options = parser.parse_args(arguments)
    if not (options.paths or options.layout or options.all):
        parser.error("name scenes, or make some with --layout or --all")
    failed = count = 0
    for name, level, scene in scenes_of(options):
        if options.report:
            document, seconds = json.loads(options.report.read_text(encoding="utf-8")), 0.0
        else:
            document, seconds = completed(scene, edge_length=None if options.estimate else EDGE_LENGTH)
        if options.save:
            options.save.mkdir(parents=True, exist_ok=True)
            (options.save / f"{name}.json").write_text(json.dumps(document), encoding="utf-8")
        result = measure_report(scene, document)
        failures = missed(result, level)
        count, failed = count + 1, failed + bool(failures)
        if options.json:
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
            extra = {"scene": name, "missed": failures, "wall_seconds": seconds, "peak_bytes": memory}
            print(json.dumps({**extra, **result, "seconds": document["seconds"], "work": document["work"]}), flush=True)
        else:
            print(line_of(name, result, failures, seconds), flush=True)
    print(f"{count - failed} of {count} scenes reach every goal", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
