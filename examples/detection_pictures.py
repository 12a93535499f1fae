# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the pictures of docs/detection.md: `python -m examples.detection_pictures [FOLDER]` in the folder above.

Each picture shows the same part of the example scan, made noisier, at several values of one parameter: ridges red,
valleys blue, the rims of holes grey. Needs matplotlib.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from core.detection import DetectionParameters, FeatureCurves, TriangleMesh, detect
from examples.make_scan import scan

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "detection"
COLOURS = ("#c0392b", "#1f5fa8", "black", "0.7")
PARTS = {"low": (0.0, 2.9, 0.0, 2.75), "rosette": (1.1, 4.5, 4.75, 8.0)}
PICTURES = [
    ("detail", "low", (0.0, 0.3, 1.5, 3.0)),
    ("strong_fold", "rosette", (7.0, 20.0, 45.0, 75.0)),
    ("noise", "low", (0.0, 3.0, 5.0, 8.0)),
    ("junction", "rosette", (0.0, 2.0, 4.0, 8.0)),
    ("bridge", "low", (0.0, 3.0, 6.0, 12.0)),
    ("gap", "low", (0.0, 5.0, 10.0, 15.0)),
    ("min_length", "rosette", (0.0, 10.0, 25.0, 60.0)),
]


def draw(axes, found: FeatureCurves, part, title: str) -> None:
    """The curves seen from the front, cut to a part (left, right, bottom, top) of the wall."""
    for i in np.argsort(-found.kind):
        p = found.curves.curve(i)[:, [0, 2]]
        p = np.concatenate([p, p[:1]]) if found.curves.closed[i] else p
        axes.plot(*p.T, color=COLOURS[found.kind[i]], lw=1)
    axes.set(xlim=part[:2], ylim=part[2:], aspect="equal", xticks=[], yticks=[], title=title)


def main(arguments) -> None:
    folder = Path(arguments[0]) if arguments else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    made = scan(noise=0.25)
    mesh = TriangleMesh.of(made.vertices, made.faces)
    for name, part, values in PICTURES:
        figure, row = plt.subplots(1, len(values), figsize=(3 * len(values), 3.1), layout="constrained")
        for axes, value in zip(row, values):
            parameters = replace(DetectionParameters(), **{name: value})
            if name == "strong_fold":
                parameters = replace(parameters, weak_fold=min(parameters.weak_fold, value), noise=0.0)
            if name == "noise":
                parameters = replace(parameters, detail=0.5)
            draw(axes, detect(mesh, boundary=True, parameters=parameters), PARTS[part], f"{name} = {value:g}")
        out = folder / f"{name}.png"
        figure.savefig(out, dpi=70, pil_kwargs={"optimize": True}, metadata={"Software": None})
        plt.close(figure)
        print(f"{out}: {out.stat().st_size} bytes")


if __name__ == "__main__":
    main(sys.argv[1:])
