# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a run takes, stage by stage: seconds at any size, what comes to them
at one size, and the power of the size with which that grows.

`python -m benchmarks.rates` measures these tables again. What another machine or another scene takes is learned while a
run goes on (`progress`).
"""

from __future__ import annotations

SAMPLES, FACES = 10_000, 100_000
"""The sizes that the tables are about: samples of a network, an edge length apart, and faces of a scan."""

COMPLETING = {
    "blast": (0.13, 2.8, 2.0),
    "seeding": (2, 2.5, 1.3),
    "growth": (4.8, 6.9, 1.7),
    "orbits": (0, 0.15, 1.6),
    "selection": (0, 0.14, 1.5),
    "completion": (0, 1, 2.0),
    "fitting": (0.086, 0.076, 0.8),
}
DETECTING = {
    "mesh": (0.009, 0.12, 1.4),
    "curvature": (0.029, 0.62, 1.3),
    "lines": (0.024, 0.23, 1.0),
}

PER_FACE = 0.06
"""Samples of feature curves that a scan has for each of its faces, about: before it is detected nothing is known."""


def completing(samples) -> dict:
    """Stage -> seconds to complete a network of so many samples."""
    return _seconds(COMPLETING, samples / SAMPLES)


def detecting(faces) -> dict:
    """Stage -> seconds to detect the curves of a scan of so many faces."""
    return _seconds(DETECTING, faces / FACES)


def _seconds(table, size):
    return {stage: base + rate * size**power for stage, (base, rate, power) in table.items()}
