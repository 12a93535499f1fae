# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that recur, drawn at random: 3 to 12 curves of 15 to 250 edges across. Lengths are in edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..scenes.shapes import line, resample
from . import elements

SMALLEST, LARGEST = 15.0, 250.0
PARTS = (3, 12)
NEAR = 3.0  # edges; two curves nearer than this cannot be told apart
ALONG = 0.12  # share of a new curve that may run that near to the others of the same thing
MEETING = 8  # samples of it that always may: a crossing or a joint
SHORTEST = 8.0  # edges, length of a curve
LEAST_LENGTH = 80.0  # edges of all curves of a motif; less of it is lost in two holes


@dataclass(frozen=True)
class Motif:
    """A thing in its own frame, its bounding box centred on the origin.

    parts : list of (n, 3) float64 polylines, points one edge apart
    words : names of what was drawn, for the record of what all was
    """

    parts: list
    words: tuple

    @property
    def box(self) -> np.ndarray:
        """(3,) float64, width, height and depth."""
        points = np.concatenate(self.parts)
        return points.max(axis=0) - points.min(axis=0)

    @property
    def length(self) -> float:
        """Of all curves."""
        return float(sum(len(p) - 1 for p in self.parts))


def runs_beside(curve, parts) -> bool:
    """Whether a curve runs along others instead of meeting them."""
    if not parts:
        return False
    near = cKDTree(np.concatenate(parts)).query(curve, distance_upper_bound=NEAR)[0] <= NEAR
    return bool(near.sum() > max(ALONG * len(curve), MEETING))


class Drawing:
    """A motif under construction in a box; an element that would run along what is there is left out."""

    def __init__(self, rng, wide, high, deep, *, symmetric):
        self.rng, self.wide, self.high, self.deep, self.symmetric = rng, wide, high, deep, symmetric
        self.parts, self.words = [], []

    def add(self, curves, word) -> bool:
        """Take the curves of one element, all or none."""
        curves = [resample(c, 1.0) for c in curves]
        taken = list(self.parts)
        for curve in curves:
            if len(curve) < SHORTEST or runs_beside(curve, taken):
                return False
            taken.append(curve)
        if len(taken) > PARTS[1]:
            return False
        self.parts = taken
        self.words.append(word)
        return True

    def depth(self):
        """A depth of an element, all the same in a flat motif."""
        return self.rng.uniform(-0.5, 0.5) * self.deep

    def placed(self, curve) -> list:
        """A curve anywhere inside the box; in a symmetric motif with its mirror image."""
        size = np.ptp(curve[:, :2], axis=0)
        room = np.maximum(np.array([self.wide, self.high]) - size - 6, 0) / 2
        x, y = self.rng.uniform(-1, 1, size=2) * room
        curve = curve - (curve.max(axis=0) + curve.min(axis=0)) / 2
        if not self.symmetric:
            return [curve + [x, y, self.depth()]]
        x = max(abs(x), size[0] / 2 + 2.5)
        curve = curve + [x, y, self.depth()]
        return [curve, curve * [-1, 1, 1]]

    def part_box(self, *, low=0.2, high=0.7):
        """Width and height of an element inside the box."""
        wide, tall = self.rng.uniform(low, high, size=2) * (self.wide, self.high)
        return max(wide * (0.5 if self.symmetric else 1), 5.0), max(tall, 5.0)


def frames(d: Drawing) -> bool:
    """One outline, or several one in the other."""
    shape = str(d.rng.choice(elements.OUTLINES[: 4 if d.symmetric else 5]))
    below = bool(shape != "blob" and d.rng.random() < 0.35)
    free = elements.blob(d.rng, d.wide, d.high)
    curves, inset = [], 0.0
    for _ in range(int(d.rng.choice([1, 1, 2, 3]))):
        wide, high = d.wide - 2 * inset, d.high - 2 * inset
        if min(wide, high) < 6:
            break
        if shape == "blob":
            curve = free * [wide / d.wide, high / d.high, 1]
        else:
            curve = elements.outline(d.rng, shape, wide, high, open_below=below)
        curves.append(curve + [0, 0, d.depth()])
        inset += max(4.5, d.rng.uniform(0.04, 0.15) * min(d.wide, d.high))
    frames_drawn = len(curves)
    if below:
        curves.append(line((-d.wide * 0.6, -d.high / 2 - 4, 0), (d.wide * 0.6, -d.high / 2 - 4, 0)))
    return d.add(curves, f"{'nested frames' if frames_drawn > 1 else 'frame'}: {shape}")


def bars(d: Drawing) -> bool:
    """Straight lines across the box, a short one where it leans."""
    z, upright = d.depth(), d.rng.random() < 0.5
    at, reach = d.rng.uniform(-0.4, 0.4), d.rng.uniform(0.3, 0.48)
    if upright:
        x = at * d.wide
        curve = line((x, -reach * d.high, z), (x + d.rng.choice([0, 0, 0.1]) * d.wide, reach * d.high, z))
        return d.add([curve, curve * [-1, 1, 1]] if d.symmetric else [curve], "bar")
    return d.add([line((-reach * d.wide, at * d.high, z), (reach * d.wide, at * d.high, z))], "bar")


def circles(d: Drawing) -> bool:
    """A circle in the middle or somewhere."""
    radius = max(d.rng.uniform(0.12, 0.4) * min(d.wide, d.high), 2.5)
    loop = elements.arc((0, 0), radius, 0, 360)
    loop[-1] = loop[0]
    if d.rng.random() < 0.4:
        room = max(d.high / 2 - radius - 4, 0)
        return d.add([loop + [0, d.rng.uniform(-1, 1) * room, d.depth()]], "circle")
    return d.add(d.placed(loop), "circle")


def splines(d: Drawing) -> bool:
    """A smooth curve, in depth where the motif is deep."""
    return d.add(d.placed(elements.spline(d.rng, *d.part_box(low=0.35, high=0.9), d.deep)), "spline")


def zigzags(d: Drawing) -> bool:
    """A row of teeth."""
    wide, high = d.part_box(low=0.4, high=0.9)
    return d.add(d.placed(elements.zigzag(d.rng, wide, min(high, 0.3 * wide + 5))), "zigzag")


def spirals(d: Drawing) -> bool:
    """A volute."""
    return d.add(d.placed(elements.spiral(d.rng, max(min(d.part_box()), 8.0))), "spiral")


def traceries(d: Drawing) -> bool:
    """Lancets and an eye within the box."""
    if min(d.wide, d.high) < 30:
        return False
    z = d.depth()
    return d.add([c + [0, 0, z] for c in elements.tracery(d.rng, d.wide * 0.8, d.high * 0.85)], "tracery")


def returns(d: Drawing) -> bool:
    """A short edge straight into the depth, beside the outline."""
    if d.deep < 10:
        return False
    x, y = d.rng.uniform(0.3, 0.5) * d.wide, d.rng.uniform(-0.5, 0.5) * d.high
    curve = line((x, y, -d.deep / 2), (x, y, d.deep / 2))
    return d.add([curve, curve * [-1, 1, 1]] if d.symmetric else [curve], "return")


INSIDE = (bars, circles, splines, splines, zigzags, spirals, traceries, returns)


def post(d: Drawing) -> bool:
    """The two sides of a baluster."""
    side = elements.baluster(d.rng, d.wide, d.high)
    return d.add([side, side * [-1, 1, 1]], "baluster")


def rings(d: Drawing) -> bool:
    """A ring or foot about a post, lying."""
    y, radius = d.rng.uniform(-0.48, 0.48) * d.high, d.wide * d.rng.uniform(0.55, 0.8)
    if d.rng.random() < 0.5:
        loop = elements.arc((0, 0), radius, 0, 360)[:, [0, 2, 1]]
        loop[-1] = loop[0]
        return d.add([loop + [0, y, 0]], "ring")
    x, z = radius, radius * d.rng.uniform(0.5, 1)
    return d.add([line((-x, y, -z), (-x, y, z), (x, y, z), (x, y, -z))], "foot")


def draw_motif(rng, *, size=None, parts=None, symmetric=None, framed=False, inside=INSIDE) -> Motif:
    """A motif of this size and number of curves, or of random ones.

    size : largest of width and height; parts : curves wanted; framed : whether it must begin with an outline;
    inside : elements to choose from
    """
    for _ in range(200):
        across = np.exp(rng.uniform(np.log(SMALLEST), np.log(LARGEST))) if size is None else size
        aspect = 5.0 ** rng.uniform(-1, 1)
        wide, high = max(across * min(aspect, 1), 5.0), max(across * min(1 / aspect, 1), 5.0)
        deep = 0.0 if rng.random() < 0.4 else rng.uniform(0.1, 0.6) * min(wide, high)
        even = bool(rng.random() < 0.5) if symmetric is None else symmetric
        wanted = int(rng.integers(*PARTS, endpoint=True)) if parts is None else parts
        wanted = int(np.clip(wanted, PARTS[0], max(PARTS[0], across / 5)))
        style = "framed" if framed else str(rng.choice(["framed", "post", "free"], p=[0.65, 0.15, 0.2]))
        if style == "post" and (across < 30 or symmetric is False):
            continue
        if style == "post":
            wide, high = max(across * rng.uniform(0.08, 0.25), 6.0), across
        d = Drawing(rng, wide, high, deep, symmetric=even)
        begin = {"framed": frames, "post": post, "free": splines}[style]
        if not begin(d):
            continue
        choice = (rings, rings, splines, circles) if style == "post" else inside
        for _ in range(60):
            if len(d.parts) >= wanted:
                break
            choice[int(rng.integers(len(choice)))](d)
        if len(d.parts) >= PARTS[0] and sum(map(len, d.parts)) >= LEAST_LENGTH:
            return centred(d.parts, ("symmetric" if even else "uneven", "deep" if deep else "flat", *d.words))
    raise RuntimeError("no motif was drawn: the size leaves no room for three curves")


def centred(parts, words) -> Motif:
    """The motif of these curves, moved so that its box is about the origin."""
    points = np.concatenate(parts)
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    return Motif([p - middle for p in parts], tuple(words))


def warped(motif: Motif, rng) -> Motif:
    """The motif with every curve bent by a smooth random field of its own: no circle, right angle or symmetry stays.

    One field for all would bend what is parallel alike, and it would recur.
    """
    size = motif.box.max()
    parts = []
    for part in motif.parts:
        directions = rng.normal(size=(4, 3)) * rng.uniform(1.5, 4.5, size=(4, 1)) / size
        phases, pulls = rng.uniform(0, 2 * np.pi, size=4), rng.normal(size=(4, 3)) * 0.05 * size
        bent = part + np.sin(part @ directions.T + phases) @ pulls
        if np.allclose(part[0], part[-1]):
            bent[-1] = bent[0]
        parts.append(resample(bent, 1.0))
    return centred(parts, ("warped", *motif.words))
