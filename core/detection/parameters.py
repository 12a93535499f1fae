# SPDX-License-Identifier: GPL-3.0-or-later
"""The parameters of detection. Lengths are in multiples of the mesh's mean edge length."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from math import isfinite, radians

from ..errors import InputError

EDGES, DEGREES, FACTOR = "edge lengths", "degrees", "factor"


def _value(default, unit, help, low, high=float("inf")):
    return field(default=default, metadata={"unit": unit, "help": help, "low": low, "high": high})


@dataclass(frozen=True)
class DetectionParameters:
    """Every number that steers detection.

    Each field's metadata holds ``unit``, ``help`` (plain words) and the inclusive bounds ``low`` and ``high``.
    """

    detail: float = _value(0.0, EDGES, "smoothing scale: finer is taken for noise; 0: the scan decides", 0.0, 20)
    strong_fold: float = _value(20.0, DEGREES, "a curve must somewhere be as sharp as a fold by this angle", 0, 180)
    weak_fold: float = _value(7.0, DEGREES, "a curve goes on while it is as sharp as a fold by this angle", 0, 180)
    noise: float = _value(5.0, FACTOR, "a curve must be this many times as sharp as the noise makes a plane", 0, 100)
    strong_length: float = _value(3.0, EDGES, "length over which a curve must be strong", 0, 1000)
    min_length: float = _value(10.0, EDGES, "shortest curve that is kept", 0, 10000)
    bridge: float = _value(6.0, EDGES, "longest faint stretch between two clear ones that stays", 0, 100)
    gap: float = _value(10.0, EDGES, "longest gap over which pieces that continue each other are joined", 0, 100)
    turn: float = _value(60.0, DEGREES, "largest turn from a piece into the gap and out of it", 0, 90)
    junction: float = _value(0.0, EDGES, "ends that come this near to a line ahead of them are led on to it", 0, 100)
    merge: float = _value(1.0, EDGES, "lines of one kind that run beside each other within this are one", 0, 10)
    margin: float = _value(0.0, EDGES, "crest lines nearer than this to an open boundary are left out", 0, 100)
    sharp_angle: float = _value(35.0, DEGREES, "a sharp edge bends the surface by at least this angle", 1, 179)

    def folds(self, noise: float) -> tuple[float, float]:
        """Strong and weak fold angles in radians for a noise that alone makes the fold angle `noise` (radians).

        Where the noise asks for a larger strong fold the weak one grows with it.
        """
        strong, weak = radians(self.strong_fold), radians(self.weak_fold)
        needed = max(strong, self.noise * noise)
        return needed, weak * needed / strong if strong > 0 else weak

    def validate(self) -> DetectionParameters:
        """Return self, or raise InputError that names the parameter, its value and its bounds."""
        for f in fields(self):
            value, low, high = getattr(self, f.name), f.metadata["low"], f.metadata["high"]
            number = isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
            if not number or not low <= value <= high:
                span = f"from {low:g} to {high:g}" if isfinite(high) else f"of at least {low:g}"
                raise InputError(f"{f.name} is {value!r}: give a number {span} ({f.metadata['unit']})")
        if self.weak_fold > self.strong_fold:
            raise InputError(f"weak_fold is {self.weak_fold:g}: give at most strong_fold, {self.strong_fold:g}")
        return self
