# SPDX-License-Identifier: GPL-3.0-or-later
"""The values that enter and leave the method. All are immutable; arrays are never written to."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Curves:
    """Polylines in world space, one after the other in one array.

    points : (n, 3) float64, scene units
    offsets : (m + 1,) int64, curve i is ``points[offsets[i]:offsets[i + 1]]``
    closed : (m,) bool, the closing point is not repeated
    strength : (n,) float64, maximal absolute curvature (1 / length), or None where the input has none
    source : (m,) int64, the input curve that curve i came from (an input curve is cut where others meet it)
    normals : (n, 3) float64, unit, outwards, of the surface that the curves were detected on, or None where unknown
    kind : (n,) int64, index into `core.detection.KINDS`, or None where unknown
    """

    points: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    strength: np.ndarray | None = None
    source: np.ndarray | None = None
    normals: np.ndarray | None = None
    kind: np.ndarray | None = None

    def __post_init__(self):
        if self.source is None:
            object.__setattr__(self, "source", np.arange(len(self.offsets) - 1))

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def curve(self, i: int) -> np.ndarray:
        """(k, 3) float64, the points of curve i."""
        return self.points[self.offsets[i] : self.offsets[i + 1]]

    @classmethod
    def from_list(cls, polylines, closed=None, strength=None) -> Curves:
        """Curves of a list of (k, 3) arrays; `strength` is a list of (k,) arrays or None."""
        lengths = [len(p) for p in polylines]
        offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
        points = np.concatenate([np.reshape(p, (-1, 3)) for p in polylines]) if lengths else np.zeros((0, 3))
        closed = np.zeros(len(lengths), bool) if closed is None else np.asarray(closed, bool)
        strength = None if strength is None else np.concatenate([*strength, []]).astype(float)
        return cls(np.ascontiguousarray(points, float), offsets, closed, strength)


@dataclass(frozen=True)
class Transformation:
    """A recurrence of the model (section 4.2): one motion, or the generators of an orbit.

    kind : "single", "translation", "grid", "rotation" or "screw"
    generators : (g, 4, 4) float64, world space; two for a grid, otherwise one
    extent : (g, 2) int64, lowest and highest power of each generator that is seen, both inclusive
    log_bayes_factor : log of the ratio K of the model with it to the model without it
    support : share of the length of all curves that recurs under it, 0 to 1
    e_value : how many things as good as the best of its own a scene without recurrence would give
    """

    id: int
    kind: str
    generators: np.ndarray
    extent: np.ndarray
    log_bayes_factor: float
    support: float
    e_value: float = 0.0


@dataclass(frozen=True)
class CompletedCurve:
    """One clean curve. points : (k, 3) float64; support : share of its length that the input shows, 0 to 1."""

    points: np.ndarray
    closed: bool
    component: int
    support: float


@dataclass(frozen=True)
class Template:
    """Curves that recur together (section 5.2).

    curves : CompletedCurve each, in template space
    occurrences : (a, 4, 4) float64, rigid, template space to world
    evidence : (a, len(curves)) float64, share of each curve's length that the input shows at each occurrence
    transformation : id of the transformation that relates the occurrences
    """

    id: int
    transformation: int
    curves: tuple[CompletedCurve, ...]
    occurrences: np.ndarray
    evidence: np.ndarray


@dataclass(frozen=True)
class InputClasses:
    """What became of each input curve, in the order of the input (section 5.1).

    kind : (m,) str, "template", "strong" or "noise"
    transformation, component : (m,) int64, -1 for none
    """

    kind: np.ndarray
    transformation: np.ndarray
    component: np.ndarray


@dataclass(frozen=True)
class Completion:
    """The completed network and all that explains it.

    strong : curves that do not recur and are kept; their component is -1
    seconds : stage name -> seconds; work : counts, see docs/report.md
    """

    edge_length: float
    transformations: tuple[Transformation, ...]
    templates: tuple[Template, ...]
    strong: tuple[CompletedCurve, ...]
    inputs: InputClasses
    seconds: dict = field(default_factory=dict)
    work: dict = field(default_factory=dict)
