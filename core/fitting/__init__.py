# SPDX-License-Identifier: GPL-3.0-or-later
"""Polylines as the fewest lines, circular arcs, circles and Bezier segments within their noise."""

from .completed import DrawnCurve, FittedCompletion, drawn, fit_completion
from .fit import FittedCurve, fit_curve, fit_curves
from .primitives import Arc, Bezier, Circle, Line, dense
from .recognised import recognised

__all__ = [
    "Arc",
    "Bezier",
    "Circle",
    "DrawnCurve",
    "FittedCompletion",
    "FittedCurve",
    "Line",
    "dense",
    "drawn",
    "fit_completion",
    "fit_curve",
    "fit_curves",
    "recognised",
]
