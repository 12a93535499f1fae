# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that do not recur: which are kept, and which pieces are one (section 5.1)."""

from .curves import single_curves
from .drawing import SingleCurve

__all__ = ["SingleCurve", "single_curves"]
