# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as few lines, arcs, circles and Bezier segments that meet where they meet."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .chain import Chain, distances, fit_chain
from .corners import GENTLE, allowed, strays
from .description import cost, describe, from_corner
from .primitives import Circle, Line
from .samples import Samples, make_samples
from .touching import nearest_inside


@dataclass(frozen=True)
class FittedCurve:
    """primitives : in a row, each begins where the last one ends; none for a curve without a length
    closed : the last ends where the first begins
    deviation : float, the largest distance of a sample, scene units
    noise : float, what it may be: never less than the deviation
    """

    primitives: tuple
    closed: bool
    deviation: float
    noise: float

    def beziers(self) -> np.ndarray:
        """(k, 4, 3) float64, control points of the whole curve as Bezier segments."""
        parts = [p.beziers() for p in self.primitives]
        return np.concatenate(parts) if parts else np.zeros((0, 4, 3))


def fit_curve(points, closed=False, *, sigma=None, blur=0.0, correlation=1.0) -> FittedCurve:
    """One polyline as primitives; see `fit_curves`."""
    return fit_curves([points], [closed], sigma=sigma, blur=blur, correlation=correlation)[0]


def fit_curves(polylines, closed, *, sigma=None, blur=0.0, correlation=1.0) -> list[FittedCurve]:
    """Polylines that belong together as primitives; ends and corners that meet within the noise become one point,
    and an end that meets the middle of another curve within the noise lies on it.

    Parameters
    ----------
    polylines : list of (n, 3) float64, dense samples
    closed : list of bool, the closing point is not repeated
    sigma : standard deviation of a sample along one axis, scene units; estimated from each curve if None
    blur : length over which the curves were smoothed; a corner may be that much rounded
    correlation : number of neighbouring samples that err alike

    Raises
    ------
    InputError where points are not finite or the noise is negative.
    """
    drawn = [_draw(make_samples(p, c, sigma=sigma, correlation=correlation), blur) for p, c in zip(polylines, closed)]
    return [d.value(blur) for d in _touching(_snapped(drawn, blur), blur)]


@dataclass(frozen=True)
class _Drawn:
    """One curve while it is drawn: its samples, and a chain or a circle, both None for the polyline itself."""

    samples: Samples | None
    chain: Chain | None = None
    circle: Circle | None = None
    ends: dict | None = None
    """Joints that several curves share, by their number: (3,) in the world."""

    def value(self, blur) -> FittedCurve:
        if self.samples is None:
            return FittedCurve((), False, 0.0, 0.0)
        s = self.samples
        motion, noise, off = s.to_world(), s.bound, 0.0
        if self.circle is not None:
            primitives = (self.circle.moved(motion),)
            off = s.off(circle_distances(s.points, self.circle)).max()
        elif self.chain is not None:
            primitives = _meeting([p.moved(motion) for p in self.chain.primitives()], self.ends or {}, s.closed)
            off = s.off(distances(s.points, self.chain)).max()
            noise = max(noise, allowed(s, self.chain, blur).max())
        else:
            line = s.points @ s.axes + s.origin
            line = np.concatenate([line, line[:1]]) if s.closed else line
            primitives = tuple(Line(a, b) for a, b in zip(line[:-1], line[1:]))
        return FittedCurve(tuple(primitives), s.closed, float(off), float(noise))


def _draw(samples, blur):
    if samples is None:
        return _Drawn(None)
    if samples.closed:
        samples = from_corner(samples, blur)
    circle = fit_circle(samples) if samples.closed and samples.plane else None
    if circle is not None and _is_plainly_round(samples, circle):
        return _Drawn(samples, circle=circle)
    samples, chain = describe(samples, blur=blur)
    if circle is not None:
        off = circle_distances(samples.points, circle)
        price = 3 * samples.price + (off**2).sum() / samples.variance
        if samples.off(off).max() <= samples.bound and (chain is None or price <= cost(samples, chain)):
            return _Drawn(samples, circle=circle)
    return _Drawn(samples, chain)


def _is_plainly_round(samples, circle):
    """Whether a circle leaves no more than noise: nothing is described with less, so nothing else is tried."""
    off, n = circle_distances(samples.points, circle), len(samples.points) / samples.correlation
    within = samples.off(off).max() <= samples.bound
    return within and (off**2).sum() / samples.variance <= n + 3 * np.sqrt(2 * n)


def fit_circle(samples: Samples) -> Circle | None:
    """The circle with the least squared distances in the plane of a closed curve, None where there is none."""
    p = samples.points[:, :2]
    if len(p) < 6:
        return None
    square = (p * p).sum(axis=1)
    solved, *_ = np.linalg.lstsq(np.c_[2 * p, np.ones(len(p))], square, rcond=None)
    values = np.r_[solved[:2], np.sqrt(max(solved[2] + solved[:2] @ solved[:2], 0))]
    for _ in range(6):
        out = p - values[:2]
        size = np.linalg.norm(out, axis=1)
        if not size.min() > 0:
            return None
        step, *_ = np.linalg.lstsq(np.c_[out / size[:, None], np.ones(len(p))], size - values[2], rcond=None)
        values = values + step
    centre, radius = np.r_[values[:2], 0.0], float(values[2])
    after = np.roll(p, -1, axis=0)
    turn = np.sign((p[:, 0] * after[:, 1] - p[:, 1] * after[:, 0]).sum())
    start = samples.points[0] - centre
    return Circle(centre, np.array([0.0, 0.0, turn or 1.0]), radius, centre + radius * start / np.linalg.norm(start))


def circle_distances(points, circle: Circle) -> np.ndarray:
    """(n,) float64."""
    out = points - circle.centre
    height = out @ circle.normal
    return np.hypot(np.linalg.norm(out - height[:, None] * circle.normal, axis=1) - circle.radius, height)


def _snapped(drawn, blur):
    """Curves whose ends and corners within the noise of each other are one point, where the fit allows it."""
    rows = [(i, j) for i, d in enumerate(drawn) if d.chain is not None for j in _meeting_joints(d.chain)]
    if len(rows) < 2:
        return drawn
    places = np.array([_world(drawn[i].samples, drawn[i].chain.joints[j]) for i, j in rows])
    bound = np.array([drawn[i].samples.bound for i, _ in rows])
    pairs = cKDTree(places).query_pairs(bound.max(), output_type="ndarray")
    near = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1) <= bound[pairs].min(axis=1)
    i, j = pairs[near].T
    count, label = connected_components(coo_matrix((np.ones(len(i)), (i, j)), shape=(len(rows),) * 2), directed=False)
    ends = [{} for _ in drawn]
    for k in range(count):
        members = np.flatnonzero(label == k)
        place = places[members].mean(axis=0)
        if len(members) > 1 and (np.linalg.norm(places[members] - place, axis=1) <= bound[members]).all():
            for m in members:
                ends[rows[m][0]][rows[m][1]] = place
    return [_held(d, own, blur) if own else d for d, own in zip(drawn, ends)]


def _touching(drawn, blur):
    """Curves whose free ends within the noise of another curve lie on it, where the fit allows it.

    Long curves are settled first; what an end was drawn to stays as it is from then on.
    """
    out, settled = list(drawn), set()
    boxes = [None if d.samples is None else _box(d.samples) for d in drawn]
    size = [0.0 if box is None else float(np.linalg.norm(box[1] - box[0])) for box in boxes]
    for i in sorted(range(len(out)), key=lambda i: (-size[i], i)):
        d = out[i]
        if d.chain is None or d.chain.closed or i in settled:
            continue
        ends, used = {}, set()
        for joint in {0, len(d.chain.joints) - 1} - set(d.ends or {}):
            place, other = _touched(out, boxes, i, joint)
            if place is not None:
                ends[joint] = place
                used.add(other)
        if ends:
            held = _held(d, {**(d.ends or {}), **ends}, blur)
            if held is not d:
                out[i] = held
                settled |= used
    return out


def _touched(drawn, boxes, i, joint):
    """Where an end of curve i touches the middle of another curve, and which that is; None and -1 if none."""
    d, best = drawn[i], (None, -1)
    end, nearest = _world(d.samples, d.chain.joints[joint]), np.inf
    for j, other in enumerate(drawn):
        if j == i or boxes[j] is None:
            continue
        bound = min(d.samples.bound, other.samples.bound)
        if (end < boxes[j][0] - bound).any() or (end > boxes[j][1] + bound).any():
            continue
        place = nearest_inside(other.samples, other.chain, other.circle, end)
        gap = np.inf if place is None else np.linalg.norm(place - end)
        if gap <= min(bound, nearest):
            best, nearest = (place, j), gap
    return best


def _box(samples):
    points = _world(samples, samples.points)
    return points.min(axis=0) - samples.bound, points.max(axis=0) + samples.bound


def _meeting_joints(chain):
    """Numbers of the joints that are ends or corners."""
    angles = chain.angles()
    corner = (angles > GENTLE) & ~chain.tangent
    if not chain.closed:
        corner[[0, -1]] = True
    return np.flatnonzero(corner)


def _held(drawn: _Drawn, ends: dict, blur) -> _Drawn:
    """A curve fitted again with some joints held where several curves meet; as it was where that takes it too far."""
    samples, chain = drawn.samples, drawn.chain
    joints, held = chain.joints.copy(), np.zeros(len(chain.joints), bool)
    for joint, place in ends.items():
        joints[joint], held[joint] = (place - samples.origin) @ samples.axes.T, True
    fitted = fit_chain(samples.points, replace(chain, joints=joints), variance=samples.variance, held=held)
    off = samples.off(distances(samples.points, fitted)) > allowed(samples, fitted, blur)
    return drawn if off.any() or strays(samples, fitted, blur).any() else replace(drawn, chain=fitted, ends=ends)


def _world(samples, point):
    return point @ samples.axes + samples.origin


def _meeting(primitives, ends, closed):
    """Primitives of a chain in the world, each with the very point at which the last one ends as its start."""
    out = list(primitives)
    for i, p in enumerate(out):
        start = ends.get(i, p.start)
        out[i] = replace(p, start=start)
        if i or closed:
            out[i - 1] = replace(out[i - 1], end=start)
    if not closed and len(out) in ends:
        out[-1] = replace(out[-1], end=ends[len(out)])
    return tuple(out)
