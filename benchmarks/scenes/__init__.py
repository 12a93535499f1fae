# SPDX-License-Identifier: GPL-3.0-or-later
"""Synthetic feature curve networks with ground truth: `python -m benchmarks.scenes OUT_DIR --layout X --level Y`."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .damage import LEVELS, damaged, random_pose
from .layouts import LAYOUTS
from .shapes import resample

EDGE_LENGTH = 0.02


@dataclass(frozen=True)
class Scene:
    """A damaged network and its truth.

    curves, truth : lists of (n, 3) float64 polylines, scene units; a closed true curve repeats its first point
    labels, truth_labels : (m, 3) int64: class (0 repeated, 1 not repeating, 2 clutter), kind and instance, -1 for none
    """

    curves: list
    labels: np.ndarray
    truth: list
    truth_labels: np.ndarray


def make_scene(layout: str, level: str, seed: int, *, edge_length: float = EDGE_LENGTH, pose: bool = True) -> Scene:
    """The scene of a layout, a level of damage and a seed; the same three give the same scene.

    The layout's own choices (counts, steps, shapes) depend on layout and seed only, so the levels of one seed show
    the same object.
    """
    design = np.random.default_rng([zlib.crc32(layout.encode()), seed])
    network = LAYOUTS[layout](design)
    rng = np.random.default_rng([zlib.crc32(f"{layout} {level}".encode()), seed])
    truth = [resample(c, edge_length) for c in network.curves]
    if pose:
        turn, shift = random_pose(rng)
        centre = np.concatenate(truth).mean(axis=0)
        truth = [(c - centre) @ turn.T + shift for c in truth]
    curves, labels = damaged(truth, network.labels, LEVELS[level], step=edge_length, rng=rng)
    return Scene(curves, np.array(labels, np.int64), truth, np.array(network.labels, np.int64))


def save_scene(scene: Scene, stem: Path) -> None:
    """Write `stem`.npz (network, truth and labels) and `stem`.obj (the network alone, an `l` line per curve)."""
    np.savez_compressed(
        f"{stem}.npz",
        curves=np.concatenate(scene.curves),
        clen=np.array([len(c) for c in scene.curves], np.int64),
        label=scene.labels,
        truth=np.concatenate(scene.truth),
        tlen=np.array([len(c) for c in scene.truth], np.int64),
        tlabel=scene.truth_labels,
    )
    Path(f"{stem}.obj").write_text(obj_text(scene.curves), encoding="ascii")


def obj_text(curves) -> str:
    """The curves as OBJ, the vertices of a curve just before its `l` line."""
    lines, first = [], 1
    for curve in curves:
        lines += [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in curve]
        lines.append("l " + " ".join(map(str, range(first, first + len(curve)))))
        first += len(curve)
    return "\n".join(lines) + "\n"


def load_scene(path: Path) -> Scene:
    """The scene of an npz file."""
    with np.load(path) as z:
        curves = np.split(z["curves"], np.cumsum(z["clen"])[:-1])
        truth = np.split(z["truth"], np.cumsum(z["tlen"])[:-1])
        return Scene(curves, z["label"].astype(np.int64), truth, z["tlabel"].astype(np.int64))
