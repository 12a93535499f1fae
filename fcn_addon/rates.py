# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a run takes, stage by stage: seconds at one size, and the power of the size with which they grow.

`python -m benchmarks.rates` measures these tables again. What another machine or another scene takes is learned while a
run goes on (`progress`).
"""

from __future__ import annotations

SAMPLES, FACES = 10_000, 100_000
"""The sizes that the tables are about: samples of a network, an edge length apart, and faces of a scan."""

COMPLETING = {
    "blast": (3.2, 1.78),
    "seeding": (4.9, 0.80),
    "growth": (13, 1.02),
    "orbits": (0.24, 1.36),
    "selection": (0.23, 1.45),
    "completion": (2.5, 0.89),
    "fitting": (0.24, 0.80),
}

DETECTING = {"mesh": (0.12, 1.11), "curvature": (0.62, 1.11), "lines": (0.26, 0.90)}

PER_FACE = 0.06
"""Samples of feature curves that a scan has for each of its faces, about: before it is detected nothing is known."""


def completing(samples) -> dict:
    """Stage -> seconds to complete a network of so many samples."""
    return _seconds(COMPLETING, samples / SAMPLES)


def detecting(faces) -> dict:
    """Stage -> seconds to detect the curves of a scan of so many faces."""
    return _seconds(DETECTING, faces / FACES)


def _seconds(table, size):
    return {stage: seconds * size**power for stage, (seconds, power) in table.items()}
