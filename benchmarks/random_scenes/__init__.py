# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes where everything is drawn from a seed: `python -m benchmarks.random_scenes make --seeds 0:40 --folder DIR`.

The layout of a seed is the seed modulo the number of layouts, so that any run of seeds holds them all.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..scenes import EDGE_LENGTH, Scene, obj_text
from ..scenes.damage import LEVELS, damaged, random_pose
from ..scenes.network import Network
from ..scenes.shapes import resample
from .designs import LAYOUTS, draw_design
from .placements import shift

LEVELS = {name: LEVELS[name] for name in ("clean", "medium", "hard")}


@dataclass(frozen=True)
class RandomScene(Scene):
    """A damaged network, its truth, and where each occurrence stands.

    poses : (k, 4, 4) float64, from a kind's own frame to the scene; pose i is that of instance i of the labels.
        One of determinant -1 is a mirror image.
    pose_kind : (k,) int64, which thing stands there; the kinds of `labels` are those of single curves
    layout : its name
    words : what the things are made of, for people
    """

    poses: np.ndarray
    pose_kind: np.ndarray
    layout: str
    words: tuple


def layout_of(seed: int) -> str:
    """The layout that a seed draws."""
    return LAYOUTS[seed % len(LAYOUTS)]


def make_random_scene(seed: int, level: str = "medium", *, layout: str | None = None) -> RandomScene:
    """The scene of a seed; the levels of one seed show the same things. `layout` takes another than the seed's own."""
    layout = layout_of(seed) if layout is None else layout
    design = draw_design(np.random.default_rng([zlib.crc32(f"random {layout}".encode()), seed]), layout)
    network, poses, pose_kind, words = Network(), [], [], []
    for number, (motif, own) in enumerate(design.kinds):
        network.repeat(motif.parts, [(pose[:3, :3], pose[:3, 3]) for pose in own])
        poses += own
        pose_kind += [number] * len(own)
        words.append(motif.words)
    for group in design.groups:
        network.keep(*group)
    rng = np.random.default_rng([zlib.crc32(f"random {layout} {level}".encode()), seed])
    turn, place = random_pose(rng)
    centre = np.concatenate(network.curves).mean(axis=0)
    world = np.eye(4)
    world[:3, :3], world[:3, 3] = turn, place / EDGE_LENGTH
    world = world @ shift(*-centre)
    truth = [EDGE_LENGTH * (resample(c, 1.0) @ world[:3, :3].T + world[:3, 3]) for c in network.curves]
    curves, labels = damaged(truth, network.labels, LEVELS[level], step=EDGE_LENGTH, rng=rng)
    placed = np.array([world @ p for p in poses]).reshape(-1, 4, 4)
    placed[:, :3, 3] *= EDGE_LENGTH
    return RandomScene(
        curves=curves,
        labels=np.array(labels, np.int64),
        truth=truth,
        truth_labels=np.array(network.labels, np.int64),
        poses=placed,
        pose_kind=np.array(pose_kind, np.int64),
        layout=layout,
        words=tuple(words),
    )


def save_random_scene(scene: RandomScene, stem: Path) -> None:
    """Write `stem`.npz (network, truth, labels, poses) and `stem`.obj (the network alone)."""
    np.savez_compressed(
        f"{stem}.npz",
        curves=np.concatenate(scene.curves),
        clen=np.array([len(c) for c in scene.curves], np.int64),
        label=scene.labels,
        truth=np.concatenate(scene.truth),
        tlen=np.array([len(c) for c in scene.truth], np.int64),
        tlabel=scene.truth_labels,
        poses=scene.poses,
        pose_kind=scene.pose_kind,
        layout=scene.layout,
    )
    Path(f"{stem}.obj").write_text(obj_text(scene.curves), encoding="ascii")


def name_of(seed: int, level: str, layout: str) -> str:
    """The file name of a scene, without its ending."""
    return f"{seed:04d}-{layout}-{level}"
