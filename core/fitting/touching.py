# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a curve is nearest to a point: what the end of another curve that touches it is drawn to."""

from __future__ import annotations

import numpy as np

from . import shapes
from .chain import Chain
from .primitives import Circle
from .samples import Samples

GRID = np.linspace(0, 1, 33)
"""Where Newton's method begins on a Bezier segment: at the best of these."""


def nearest_inside(samples: Samples, chain: Chain | None, circle: Circle | None, point):
    """(3,) float64 in the world, the nearest point of a curve; None where that is an end of it, or it has no pieces.

    samples : whose frame the chain or the circle is in
    point : (3,) float64 in the world
    """
    local = (point - samples.origin) @ samples.axes.T
    if circle is not None:
        found = _on_circle(circle, local)
    elif chain is not None:
        found = _on_chain(chain, local)
    else:
        return None
    return None if found is None else found @ samples.axes + samples.origin


def _on_circle(circle, point):
    out = point - circle.centre
    out = out - (out @ circle.normal) * circle.normal
    size = np.linalg.norm(out)
    return circle.centre + circle.radius * out / size if size > 0 else None


def _on_chain(chain, point):
    best, found = np.inf, None
    last = len(chain.kinds) - 1
    for i, kind in enumerate(chain.kinds):
        q, before = chain.row(i), None
        if kind == 2:
            before = GRID[[((shapes.at(2, q, GRID) - point) ** 2).sum(axis=1).argmin()]]
        u = np.clip(shapes.nearest(kind, q, point[None], before, rounds=8), 0, 1)
        (place,) = shapes.at(kind, q, u)
        gap = np.linalg.norm(place - point)
        if gap < best:
            outside = not chain.closed and (i == 0 and u[0] <= 0 or i == last and u[0] >= 1)
            best, found = gap, None if outside else place
    return found
