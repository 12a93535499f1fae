# SPDX-License-Identifier: GPL-3.0-or-later
"""Write scenes: `python -m benchmarks.scenes OUT_DIR --layout rosette --level hard --seed 3`, or `--all`."""

from __future__ import annotations

import argparse
from pathlib import Path

from . import LAYOUTS, LEVELS, make_scene, save_scene


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scenes", description="Write scenes with ground truth.")
    parser.add_argument("out", type=Path, help="folder for NAME-LEVEL-SEED.npz and .obj")
    parser.add_argument("--layout", nargs="+", choices=LAYOUTS, default=[], help="one or more layouts")
    parser.add_argument("--level", nargs="+", choices=LEVELS, default=["medium"], help="one or more levels of damage")
    parser.add_argument("--seed", nargs="+", type=int, default=[1], help="one or more seeds")
    parser.add_argument("--all", action="store_true", help="every layout and every level")
    options = parser.parse_args(arguments)
    layouts, levels = (LAYOUTS, LEVELS) if options.all else (options.layout, options.level)
    if not layouts:
        parser.error("name a --layout, or take --all")
    options.out.mkdir(parents=True, exist_ok=True)
    for layout in layouts:
        for level in levels:
            for seed in options.seed:
                scene = make_scene(layout, level, seed)
                save_scene(scene, options.out / f"{layout}-{level}-{seed}")
                samples = sum(map(len, scene.curves))
                print(f"{layout}-{level}-{seed}: {len(scene.curves)} curves, {samples} samples")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
