# SPDX-License-Identifier: GPL-3.0-or-later
"""Make random scenes, run a program on them and say how many come out right.

    python -m benchmarks.random_scenes make --seeds 0:40 --level medium --folder DIR [--layout NAME]
    python -m benchmarks.random_scenes run --seeds 0:40 --level medium [--jobs 1] [--program CMD] [--out FILE.jsonl]
    python -m benchmarks.random_scenes table FILE.jsonl...

A program gets `SCENE.obj --edge-length 0.02 --report FILE` and writes a report.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .. import programs
from ..scenes import EDGE_LENGTH
from . import LAYOUTS, LEVELS, layout_of, make_random_scene, name_of, save_random_scene
from .judging import judge
from .tables import line_of, table


def seeds_of(text) -> list[int]:
    """`0:40`, `0:40:2`, `3` or `3,5,9`."""
    if ":" in text:
        return list(range(*(int(part) for part in text.split(":"))))
    return [int(part) for part in text.split(",")]


def rule_of(scene) -> str:
    """By what a scene without a result is judged."""
    counts = [int((scene.pose_kind == k).sum()) for k in set(scene.pose_kind.tolist())]
    return "none" if not counts else "twice" if max(counts) == 2 else "goals"


def run_one(seed, level, layout, *, program, limit, keep=None) -> dict:
    """Make a scene, run the program on it in a process of its own, and judge what it reports."""
    layout = layout or layout_of(seed)
    scene, name = make_random_scene(seed, level, layout=layout), name_of(seed, level, layout)
    with tempfile.TemporaryDirectory() as folder:
        stem, report = Path(folder) / name, Path(folder) / "report.json"
        save_random_scene(scene, stem)
        command = [*program, f"{stem}.obj", "--edge-length", str(EDGE_LENGTH), "--report", str(report)]
        run = programs.run(command, limit=limit)
        document = json.loads(report.read_text(encoding="utf-8")) if run.code == 0 and report.is_file() else None
    result = {"name": name, "seed": seed, "level": level, "layout": layout, "words": scene.words}
    result |= {"seconds": run.wall, "cpu": run.cpu, "peak": run.peak, "in_time": run.in_time, "code": run.code}
    if document is None:
        return {**result, "measured": False, "passed": False, "rule": rule_of(scene), "said": run.said}
    if keep:
        keep.mkdir(parents=True, exist_ok=True)
        (keep / f"{name}.json").write_text(json.dumps(document), encoding="utf-8")
    return {**result, "measured": True, **judge(scene, document, level), "stages": document.get("seconds", {})}


def run(options) -> int:
    """All scenes, a line each, then the table."""
    program = shlex.split(options.program) if options.program else programs.DEFAULT
    settings = {"program": program, "limit": options.limit, "keep": options.keep}
    cases = [(seed, options.level, layout) for layout in options.layout or [None] for seed in options.seeds]
    results = []
    if options.out:
        options.out.write_text("", encoding="utf-8")
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in pool.map(lambda case: run_one(*case, **settings), cases):
            results.append(result)
            print(line_of(result), flush=True)
            if options.out:
                with options.out.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(result) + "\n")
    print("\n" + table(results))
    return 0


def make(options) -> int:
    """Write the scenes."""
    options.folder.mkdir(parents=True, exist_ok=True)
    for layout in options.layout or [None]:
        for seed in options.seeds:
            scene = make_random_scene(seed, options.level, layout=layout)
            name = name_of(seed, options.level, scene.layout)
            save_random_scene(scene, options.folder / name)
            print(f"{name}: {len(scene.curves)} curves, {sum(map(len, scene.curves))} samples", flush=True)
    return 0


def tabulate(options) -> int:
    """The table of results that were kept."""
    lines = [line for file in options.files for line in file.read_text(encoding="utf-8").splitlines()]
    results = [json.loads(line) for line in lines]
    if options.lines:
        print("\n".join(map(line_of, results)) + "\n")
    print(table(results))
    return 0


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.random_scenes",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="write NAME.obj and NAME.npz")
    making.add_argument("--folder", type=Path, required=True)
    making.set_defaults(do=make)
    running = commands.add_parser("run", help="run a program on scenes and judge it")
    running.add_argument("--jobs", type=int, default=1, help="processes at a time")
    running.add_argument("--program", help="command line of the program (default: run.py under this Python)")
    running.add_argument("--limit", type=float, default=600.0, help="seconds for a scene (default: 600)")
    running.add_argument("--out", type=Path, help="file for the results, a JSON object a line")
    running.add_argument("--keep", type=Path, help="folder for the reports")
    running.set_defaults(do=run)
    for command in (making, running):
        command.add_argument("--seeds", type=seeds_of, required=True, metavar="A:B", help="B is not included")
        command.add_argument("--level", choices=LEVELS, default="medium")
        command.add_argument("--layout", nargs="+", choices=LAYOUTS, help="in place of each seed's own")
    reading = commands.add_parser("table", help="the table of results that were kept")
    reading.add_argument("files", type=Path, nargs="+")
    reading.add_argument("--lines", action="store_true", help="a line a scene too")
    reading.set_defaults(do=tabulate)
    options = parser.parse_args(arguments)
    return options.do(options)


if __name__ == "__main__":
    sys.exit(main())
