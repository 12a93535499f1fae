# SPDX-License-Identifier: GPL-3.0-or-later
"""The parameters of the method, with the paper's names and defaults."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from math import isfinite

from .errors import InputError

EDGES, FACTOR, COUNT = "edge lengths", "factor", "count"


def _value(default, unit, help, low, high=float("inf")):
    return field(default=default, metadata={"unit": unit, "help": help, "low": low, "high": high})


@dataclass(frozen=True)
class Parameters:
    """Every number that steers the method; lengths in multiples of the edge length.

    Each field's metadata holds ``unit``, ``help`` (plain words) and the inclusive bounds ``low``
    and ``high``; the command line and the panel are made from it.
    """

    l0: float = _value(25.0, EDGES, "shortest stretch of two curves that counts as a match (section 4.1.1)", 4)
    short_l0: float = _value(
        15.0, EDGES, "shortest stretch of a second search for matches, which finds what short pieces show", 4
    )
    s: float = _value(1.0, EDGES, "largest average distance of a first match (section 4.1.1)", 0.01)
    t: float = _value(2.0, EDGES, "largest average distance while a match is extended; the paper takes 2 s", 0.01)
    delta_l: float = _value(5.0, EDGES, "step by which a match is extended (section 4.1.1)", 1)
    strong_curvature: float = _value(
        0.5, FACTOR, "a curve is strong above this share of the mean curvature C (section 4.1.1)", 0
    )
    bayes_ratio: float = _value(10.0, FACTOR, "Bayes ratio K that keeps a transformation (section 4.2.2)", 1)
    keep_odds: float = _value(
        3.0, FACTOR, "odds to be no clutter above which a curve that does not recur is kept (section 5.1)", 0.001
    )
    smoothing: float = _value(3.0, EDGES, "standard deviation of the smoothing along each curve", 0, 20)
    link_gap: float = _value(
        25.0, EDGES, "largest gap over which pieces of a curve that does not recur may be joined (section 5.1)", 0, 200
    )
    epsilon: float = _value(2.0, EDGES, "radius within which occurrences show the same curve (section 5.2)", 0.1)
    thing_margin: float = _value(45.0, EDGES, "how far around what is known of a thing the rest is looked for", 1, 500)
    thing_gap: float = _value(30.0, EDGES, "largest gap between the curves of one thing", 1, 500)
    significance: float = _value(
        0.05, FACTOR, "odds of chance to evidence below which a curve or an occurrence is taken for real", 1e-9, 0.5
    )
    block: int = _value(1 << 20, COUNT, "pairs handled at a time; bounds the memory, not the result", 1 << 10)
    threads: int = _value(0, COUNT, "worker threads; 0 takes one a processor", 0, 256)

    def validate(self) -> Parameters:
        """Return self, or raise InputError that names the parameter, its value and its bounds."""
        for f in fields(self):
            value, low, high = getattr(self, f.name), f.metadata["low"], f.metadata["high"]
            number = isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
            if not number or not low <= value <= high:
                span = f"from {low:g} to {high:g}" if isfinite(high) else f"of at least {low:g}"
                raise InputError(f"{f.name} is {value!r}: give a number {span} ({f.metadata['unit']})")
        if self.t < self.s:
            raise InputError(f"t is {self.t:g} and s is {self.s:g}: t must not be below s, the paper takes t = 2 s")
        return self
