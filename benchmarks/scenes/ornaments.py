# SPDX-License-Identifier: GPL-3.0-or-later
"""The things that repeat: each function draws one from a random generator as a list of (n, 3) polylines.

Sizes are scene units; 0.02 is one edge. Things have depth, so that half a turn does not map them onto themselves.
"""

from __future__ import annotations

import numpy as np

from .shapes import arc, circle, join, line, mirrored, raised, rotation, rounded, volute, wave


def gothic_window(rng, scale=1.0) -> list:
    """A pointed window: two jambs with arch, two hoods, sill, mullion, lancets, an eye and a carved band."""
    half, spring = rng.uniform(0.44, 0.54) * scale, rng.uniform(0.95, 1.2) * scale
    reach = rng.uniform(1.7, 2.3) * half  # radius of the arch
    apex = np.degrees(np.arccos((reach - half) / reach))

    def side(offset, z, foot):
        arch = arc((half - reach, spring), reach + offset, 0, apex * 0.97, z=z)
        return join(line((half + offset, foot, z), arch[0]), arch)

    inner, hood = side(0.0, 0.0, 0.0), side(0.13 * scale, 0.12 * scale, 0.1 * scale)
    eye = (0.0, spring + half * 0.62)
    lancet = arc((half * 0.48, spring * 0.86), half * 0.46, 5, 178, z=-0.05 * scale)
    return [
        inner,
        mirrored(inner),
        hood,
        mirrored(hood),
        line((-half, 0.0, 0.03 * scale), (half, 0.0, 0.03 * scale)),
        line((0, 0.1 * scale, -0.05 * scale), (0, spring * 0.98, -0.05 * scale)),
        lancet,
        mirrored(lancet),
        circle(eye, half * rng.uniform(0.36, 0.44), z=-0.04 * scale),
        wave((-half, -0.14 * scale), (half, -0.14 * scale), 0.03 * scale, rng.integers(3, 6), z=0.1 * scale),
    ]


def round_window(rng, scale=1.0) -> list:
    """A round-headed window with a frame on one curve, a keystone, a sagging sill, a diamond pane and one shutter."""
    half, spring = rng.uniform(0.34, 0.46) * scale, rng.uniform(0.8, 1.1) * scale
    head = arc((0, spring), half, 0, 180)
    frame = join(line((half, 0, 0), (half, spring, 0)), head, line((-half, spring, 0), (-half, 0, 0)))
    top = spring + half
    key = np.array([(-0.07, -0.04), (-0.11, 0.2), (0.11, 0.2), (0.07, -0.04), (-0.07, -0.04)]) * scale + (0, top)
    pane = np.array([(0, 0.55), (0.6, 0), (0, -0.55), (-0.6, 0), (0, 0.55)]) * half + (0, spring * 0.55)
    sill = [(-1.3, -0.02), (-1.3, -0.12), (-1.0, -0.2), (1.0, -0.2), (1.3, -0.12), (1.3, -0.02)]
    shutter = [(half * 1.15, 0.05), (half * 1.9, 0.02), (half * 1.9, spring * 0.9), (half * 1.15, spring)]
    return [
        frame,
        line(*np.c_[key, np.full(5, 0.1 * scale)]),
        line(*np.c_[np.array(sill) * (half, scale), np.full(6, 0.14 * scale)]),
        line(*np.c_[pane, np.full(5, -0.08 * scale)]),
        rounded(line(*np.c_[shutter, [0.0, 0.12 * scale, 0.12 * scale, 0.0]]), 0.08 * scale),
        arc((0, spring), half * 1.35, 12, 168, z=0.08 * scale),
    ]


def baroque_window(rng, scale=1.0) -> list:
    """A rectangular window under a swan-neck gable, with ears, a scroll on one side and a hanging garland."""
    half, height = rng.uniform(0.38, 0.5) * scale, rng.uniform(1.0, 1.3) * scale
    frame = [(-half, 0), (half, 0), (half, height), (-half, height), (-half, 0)]
    ear = [
        (half, 0.0),
        (half, height * 0.8),
        (half * 1.25, height * 0.8),
        (half * 1.25, height * 1.08),
        (0.1 * half, height * 1.08),
    ]
    ear3 = line(*np.c_[ear, np.full(5, 0.07 * scale)])
    t = np.linspace(0, 1, 80)
    neck = np.c_[half * (1.3 - 1.15 * t), height * 1.15 + 0.42 * half * (1 - np.cos(np.pi * t)), 0.1 * scale * (1 + t)]
    bracket = volute((half * 1.55, height * 0.35), 0.2 * scale, 1.6, start=95, hand=-1, z=0.09 * scale)
    sag = half * rng.uniform(0.25, 0.4)
    garland = np.c_[
        half * 0.9 * (2 * t - 1),
        -0.14 * scale - sag * 4 * t * (1 - t) * (1 + 0.5 * t),
        0.06 * scale * np.sin(np.pi * t),
    ]
    return [line(*frame), ear3, mirrored(ear3), neck, mirrored(neck), bracket, garland]


def petal(rng, sector) -> list:
    """One petal of a rosette along the x axis: two sides, a tear, a leaning stem and a foil; `sector` in degrees."""
    tip, root = rng.uniform(1.35, 1.6), rng.uniform(0.35, 0.5)
    wide = 0.86 * np.tan(np.radians(sector / 2)) * (tip + root) / 2
    t = np.linspace(0, 1, 120)
    fat = rng.uniform(0.75, 1.15)
    side = np.c_[root + (tip - root) * t, wide * np.sin(np.pi * t**fat) ** 0.8, 0.06 * t]
    other = side * [1, -1, 1]
    a = np.linspace(0, 2 * np.pi, 90)
    tear = np.c_[tip * 0.72 + 0.17 * np.cos(a), 0.6 * wide * np.sin(a) * (1 - 0.5 * np.cos(a)), np.full(90, -0.04)]
    tear[-1] = tear[0]
    stem = wave((root + 0.03, 0.04), (tip * 0.6, -0.03), 0.02, 1, z=0.03)
    foil_angle = np.radians(sector / 2)
    foil_centre = (tip * 1.08 * np.cos(foil_angle), tip * 1.08 * np.sin(foil_angle))
    middle = sector / 2
    foil = arc(foil_centre, tip * 0.7 * np.sin(foil_angle) + 0.05, middle + 50, middle + 310, z=0.05)
    return [side, other, tear, stem, foil]


def seat(rng) -> list:
    """A theatre seat that faces the -y axis: back, cushion, two arms, front edge and a curved foot."""
    half, deep, tall = rng.uniform(0.24, 0.3), rng.uniform(0.4, 0.48), rng.uniform(0.5, 0.65)
    a = np.linspace(0, np.pi, 60)
    back = np.c_[half * np.cos(a), 0.1 * np.sin(a) ** 2 + deep, 0.25 + tall * np.sin(a) ** 0.6]
    t = np.linspace(-1, 1, 60)
    cushion = np.c_[half * 0.95 * t, deep - deep * (1 - t**4), 0.22 + 0.03 * np.cos(np.pi * t)]
    arm = rounded(
        line((half * 1.1, deep, 0.5), (half * 1.1, 0.15, 0.46), (half * 1.1, 0.0, 0.12), (half * 1.1, 0.1, 0)), 0.1
    )
    front = np.c_[half * 0.9 * t, -0.03 * (1 - t**2), np.full(60, 0.15)]
    foot = arc((0.05, 0.2), (half * 0.7, 0.13), 160, 380)
    return [back, cushion, arm, mirrored(arm), front, foot]


def column(rng) -> list:
    """A column: outlines with entasis, two front flutes, base and neck mouldings, two volutes and the abacus."""
    height, radius = rng.uniform(2.0, 2.5), rng.uniform(0.17, 0.22)
    t = np.linspace(0, 1, 150)
    girth = radius * (1 - 0.18 * t**1.8 + 0.03 * np.sin(np.pi * t))

    def flute(degrees, start, stop):
        k = (t >= start) & (t <= stop)
        a = np.radians(degrees)
        return np.c_[girth * np.sin(a), height * t, girth * np.cos(a)][k]

    def ring(y, r):
        half_circle = arc((0, 0), r, -75, 255)
        return np.c_[half_circle[:, 0], np.full(len(half_circle), y), half_circle[:, 1]]

    scroll = volute((radius * 1.1, height + 0.02), radius * 0.62, 1.7, start=90, hand=-1, z=radius * 0.9)
    wide = radius * 1.75
    abacus = line(
        (-wide, height + 0.2, -0.1), (-wide, height + 0.2, wide), (wide, height + 0.2, wide), (wide, height + 0.2, -0.1)
    )
    return [
        flute(-90, 0, 1),
        flute(90, 0, 1),
        flute(-25, 0.06, 0.93),
        flute(20, 0.08, 0.6),
        ring(-0.05, radius * 1.35),
        ring(-0.16, radius * 1.6),
        ring(height * 0.95, radius * 0.95),
        scroll,
        mirrored(scroll),
        abacus,
    ]


def baluster(rng) -> list:
    """A thin baluster: two outlines that sway by two or three edges, a ring and a foot plate."""
    height, thin, sway = rng.uniform(1.2, 1.5), rng.uniform(0.07, 0.1), rng.uniform(0.045, 0.06)
    t = np.linspace(0, 1, 140)
    side = np.c_[thin + sway * np.sin(2 * np.pi * t**1.3 + 0.4) * (1 - 0.5 * t), height * t, np.zeros(140)]
    ring = circle((0, 0), thin * 1.5)[:, [0, 2, 1]] + [0, height * 0.93, 0]
    foot = line((-0.14, 0, -0.12), (-0.14, 0, 0.14), (0.14, 0, 0.14), (0.14, 0, -0.12), (-0.1, 0, -0.12))
    return [side, mirrored(side), ring, foot]


def stair_step(rng, angle) -> list:
    """One step of a spiral stair about the y axis, first edge along x: nosing, arc, riser, rod, bracket; degrees."""
    inner, outer, drop = rng.uniform(0.25, 0.35), rng.uniform(1.3, 1.6), 0.14
    nosing = rounded(line((inner, -drop, 0), (inner, 0, 0), (outer, 0, 0.0), (outer, -drop, 0.0)), 0.06)
    edge = arc((0, 0), outer, 0, angle * 0.97)[:, [0, 2, 1]]
    t = np.linspace(0, 1, 80)
    bow = np.c_[inner + (outer - inner) * t, np.full(80, -drop), 0.1 + 0.06 * np.sin(np.pi * t)]
    rod = np.c_[outer - 0.07 + 0.03 * np.sin(3 * np.pi * t), 0.9 * t, np.full(80, 0.12)]
    bracket = raised(volute((0, 0), 0.12, 1.2, start=20, z=0.0), 0)[:, [2, 1, 0]] + [outer, -0.16, 0.2]
    return [nosing, edge, bow, rod, bracket @ rotation((0, 1, 0), -angle / 3).T]


def groove(rng) -> tuple[list, list]:
    """One groove of a tool's handle and one side of its flat blade, both about the x axis and facing z."""
    length, radius = rng.uniform(1.4, 1.8), rng.uniform(0.42, 0.5)
    a = np.linspace(0, 2 * np.pi, 160)
    wide = 0.3 * (1 + 0.25 * np.cos(a))
    across, x = wide * np.sin(a), length * 0.42 * np.cos(a)
    loop = np.c_[x, radius * np.sin(across), radius * np.cos(across) - 0.04 * np.cos(a / 2) ** 2]
    loop[-1] = loop[0]
    t = np.linspace(-1, 1, 90)
    crest = np.pi / 6 + 0.04 * t
    bulge = radius * (1.08 - 0.1 * t**2)
    ridge = np.c_[length * 0.5 * t, bulge * np.sin(crest), bulge * np.cos(crest)]
    blade = rounded(
        line(
            (2.2, -0.1, 0.1),
            (2.7, -0.13, 0.07),
            (3.0, -0.19, 0.02),
            (3.0, 0.16, 0.02),
            (2.6, 0.12, 0.08),
            (2.2, 0.1, 0.1),
        ),
        0.06,
    )
    mark = join(arc((1.9, 0.0), (0.16, 0.06), 20, 330, z=0.14), line((2.1, -0.035, 0.14), (2.17, -0.06, 0.13)))
    return [loop, ridge], [blade, mark]
