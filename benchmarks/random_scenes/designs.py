# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in a scene: the kinds of things, their poses and the strong curves about them, drawn at random.

Lengths are in edges.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from . import placements
from .copies import has_copies
from .motifs import INSIDE, LARGEST, SMALLEST, Motif, draw_motif, runs_beside, warped, zigzags
from .placements import APART, LEAST, PLACEMENTS, shift
from .surroundings import strong_curves

LAYOUTS = (*PLACEMENTS, "two", "three", "inside", "single", "none")
COUNTS = (2, 60)
LENGTHS = (1100.0, 9000.0)
"""True length of what a scene shows, in edges."""
CLEARANCE = 3.0
"""Edges that an occurrence keeps from every other curve."""

UNLIKE = tuple(element for element in INSIDE if element is not zigzags)
"""Elements that have no part twice once they are bent."""


@dataclass
class Design:
    """Kinds with their poses, and groups of curves that are there once.

    kinds : list of (Motif, list of (4, 4) poses)
    groups : list of lists of (n, 3) polylines; the curves of a group may touch
    """

    kinds: list = field(default_factory=list)
    groups: list = field(default_factory=list)

    def place(self, motif: Motif, poses) -> None:
        """Add a kind."""
        self.kinds.append((motif, list(poses)))

    def bodies(self) -> list:
        """(n, 3) points of every occurrence and of every group."""
        out = [moved(np.concatenate(m.parts), pose) for m, poses in self.kinds for pose in poses]
        return out + [np.concatenate(g) for g in self.groups]

    def shifted(self, by) -> None:
        """Move everything by (3,)."""
        move = shift(*by)
        self.kinds = [(m, [move @ pose for pose in poses]) for m, poses in self.kinds]
        self.groups = [[c + by for c in g] for g in self.groups]

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner."""
        points = np.concatenate(self.bodies())
        return points.min(axis=0), points.max(axis=0)

    def join(self, other: Design, rng) -> None:
        """Take another design up, at the right of this one or above it."""
        low, top = self.bounds()
        a, b = other.bounds()
        side, free = int(rng.random() < 0.3), rng.uniform(APART + 3, 60)
        by = np.zeros(3)
        by[side] = top[side] + free - a[side]
        by[1 - side] = (low - a)[1 - side] + rng.uniform(-20, 20)
        other.shifted(by)
        self.kinds += other.kinds
        self.groups += other.groups


def moved(points, pose) -> np.ndarray:
    """(n, 3) float64, points under a (4, 4) pose."""
    return points @ pose[:3, :3].T + pose[:3, 3]


def is_clear(bodies, distance=CLEARANCE) -> bool:
    """Whether no point (one edge apart) of a body is that near to another body."""
    of = np.repeat(np.arange(len(bodies)), [len(b) for b in bodies])
    pairs = cKDTree(np.concatenate(bodies)).query_pairs(distance + 0.2, output_type="ndarray")
    return bool((of[pairs[:, 0]] == of[pairs[:, 1]]).all())


def draw_count(rng, length, least, *, share=1.0) -> int:
    """How many occurrences of a thing of this length; 0 if it is too long. `share` of a scene is its own."""
    low, high = COUNTS[0] + 0.6, COUNTS[1] + 0.999
    count = max(int(np.exp(rng.uniform(np.log(low), np.log(high)))), least)
    most = min(int(share * LENGTHS[1] / length), COUNTS[1])
    enough = int(np.ceil(share * LENGTHS[0] / length))
    if count == COUNTS[0] and enough > 8:
        count = 3
    count = count if count == COUNTS[0] else max(count, enough)
    return min(count, most) if most >= least else 0


def one_kind(rng, layout, *, share=1.0, least=None) -> Design | None:
    """One thing in one placement; None if what was drawn is too long."""
    motif = draw_motif(rng, symmetric=False if layout == "mirrored" else None)
    least = LEAST.get(layout, 2) if least is None else max(least, LEAST.get(layout, 2))
    count = draw_count(rng, motif.length, least, share=share)
    if not count:
        return None
    design = Design()
    design.place(motif, PLACEMENTS[layout](rng, motif.box, count))
    return design if len(design.kinds[0][1]) * motif.length <= 1.2 * share * LENGTHS[1] else None


def side_by_side(rng, kinds) -> Design | None:
    """Kinds beside each other, each in rows, grids or in no order."""
    design = None
    for _ in range(kinds):
        name = str(rng.choice(["row", "grid", "grid", "staggered", "gaps", "free-wall"]))
        part = one_kind(rng, name, share=1 / kinds, least=3)
        if part is None:
            return None
        if design is None:
            design = part
        else:
            design.join(part, rng)
    return design


def one_in_another(rng) -> Design | None:
    """A small kind at one to four fixed places inside a large kind."""
    large = draw_motif(rng, size=rng.uniform(90, LARGEST), parts=3, framed=True)
    small = draw_motif(rng, size=rng.uniform(SMALLEST, 40))
    body, room = np.concatenate(large.parts), np.maximum(large.box - small.box - 12, 0) / 2
    inner, taken = [], [body]
    for _ in range(60):
        pose = shift(*(rng.uniform(-1, 1, size=2) * room[:2])) @ placements.turn((0, 0, 1), rng.choice([0, 0, 90, 180]))
        if len(inner) < 4 and is_clear([np.concatenate(taken), moved(np.concatenate(small.parts), pose)], APART):
            inner.append(pose)
            taken.append(moved(np.concatenate(small.parts), pose))
    inner = inner[: int(rng.integers(1, 5))]
    name = str(rng.choice(["row", "grid", "free-wall", "arc"]))
    count = draw_count(rng, large.length + len(inner) * small.length, max(3, LEAST.get(name, 2)))
    if not inner or not count:
        return None
    outer = PLACEMENTS[name](rng, large.box, count)
    if len(outer) * len(inner) > COUNTS[1]:
        return None
    design = Design()
    design.place(large, outer)
    design.place(small, [a @ b for a in outer for b in inner])
    return design


def one_beside(rng) -> Design | None:
    """A kind that recurs, and another thing once."""
    design = one_kind(rng, str(rng.choice(["row", "grid", "ring", "free-wall"])), share=0.8, least=3)
    if design is None:
        return None
    lone = Design(groups=[draw_motif(rng, size=rng.uniform(40, LARGEST)).parts])
    design.join(lone, rng)
    return design


def unlike(rng, size, others) -> list | None:
    """Curves of a thing of which no stretch recurs, in itself or in the others; None if that does not come about."""
    for _ in range(20):
        motif = draw_motif(rng, size=size, symmetric=False, parts=int(rng.integers(3, 9)), inside=UNLIKE)
        parts = warped(motif, rng).parts
        beside = any(runs_beside(p, [q for q in parts if q is not p]) for p in parts)
        if not beside and not has_copies(parts, others):
            return parts
    return None


def nothing(rng) -> Design | None:
    """1 to 9 things, each of a form of its own."""
    count, design = int(rng.integers(1, 10)), None
    for _ in range(count):
        size = np.exp(rng.uniform(np.log(40), np.log(LARGEST))) if count > 2 else rng.uniform(150, LARGEST)
        others = [curve for group in design.groups for curve in group] if design else []
        parts = unlike(rng, size, others)
        if parts is None:
            return None
        lone = Design(groups=[parts])
        if design is None:
            design = lone
        else:
            design.join(lone, rng)
    length = sum(len(c) for g in design.groups for c in g)
    return design if LENGTHS[0] <= length <= LENGTHS[1] else None


def draw_design(rng, layout) -> Design:
    """A design of a layout whose things keep their distance, with its strong curves."""
    whole = {
        "two": lambda: side_by_side(rng, 2),
        "three": lambda: side_by_side(rng, 3),
        "inside": lambda: one_in_another(rng),
        "single": lambda: one_beside(rng),
        "none": lambda: nothing(rng),
    }
    for _ in range(400):
        design = whole[layout]() if layout in whole else one_kind(rng, layout)
        if design is None:
            continue
        bodies = design.bodies()
        if not is_clear(bodies):
            continue
        design.groups += [[c] for c in strong_curves(rng, np.concatenate(bodies), layout)]
        if is_clear(design.bodies()):
            return design
    raise RuntimeError(f"no scene of layout {layout} was drawn: its things lie on each other")
