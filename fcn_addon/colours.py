# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of results, RGB from 0 to 1: those of the paper's figures, and steady ones to tell labels apart."""

from __future__ import annotations

from colorsys import hsv_to_rgb

TEMPLATE = (0.05, 0.13, 0.50)
STRONG = (0.35, 0.66, 0.95)
NOISE = (0.60, 0.60, 0.60)
DETECTED = (0.80, 0.35, 0.05)
ADDED, DROPPED = (0.10, 0.75, 0.20), (0.90, 0.10, 0.10)
"""What other thresholds would add and drop, on the screen."""
KINDS = ((0.78, 0.16, 0.10), (0.10, 0.35, 0.75), (0.10, 0.10, 0.10), (0.10, 0.60, 0.20))
"""Of ridges, valleys, sharp edges and boundaries."""

_GOLDEN = 0.618033988749895  # steps of the golden ratio keep any number of hues apart


def distinct(label) -> tuple[float, float, float]:
    """The colour of a label, grey for none (-1 or None); it does not depend on how many labels there are."""
    if label is None or label < 0:
        return NOISE
    hue = (0.02 + label * _GOLDEN) % 1.0
    return hsv_to_rgb(hue, (0.90, 0.65)[label % 2], (0.80, 0.62, 0.92)[label % 3])
