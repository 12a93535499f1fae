# SPDX-License-Identifier: GPL-3.0-or-later
"""A true network under construction, and the motions that place its parts."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .shapes import rotation


@dataclass
class Network:
    """True curves with their labels (class, kind, instance).

    curves : list of (n, 3) float64 polylines of any spacing
    """

    curves: list = field(default_factory=list)
    labels: list = field(default_factory=list)
    kinds: int = 0
    instances: int = 0

    def repeat(self, parts, motions) -> None:
        """Add `parts` (polylines) at each motion (rotation (3, 3), shift (3,)); each part is a kind of its own."""
        for turn, shift in motions:
            for k, part in enumerate(parts):
                self.curves.append(part @ turn.T + shift)
                self.labels.append((0, self.kinds + k, self.instances))
            self.instances += 1
        self.kinds += len(parts)

    def keep(self, *curves) -> None:
        """Add curves that do not repeat."""
        self.curves += curves
        self.labels += [(1, -1, -1)] * len(curves)


def shifts(positions) -> list:
    """Motions without rotation, to the given (n, 2 or 3) positions."""
    return [(np.eye(3), np.array([*p, 0.0][:3], float)) for p in positions]


def turns(angles, *, axis=(0, 0, 1), rise=0.0) -> list:
    """Motions about an axis through the origin by the given degrees, `rise` along the axis per motion."""
    along = np.asarray(axis, float) / np.linalg.norm(axis)
    return [(rotation(axis, a), along * rise * k) for k, a in enumerate(angles)]
