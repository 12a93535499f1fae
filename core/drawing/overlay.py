# SPDX-License-Identifier: GPL-3.0-or-later
"""What surrounds the poses of a thing, laid over each other in the thing's own frame (section 5.2)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from ..geometry.motions import apply, inverse
from ..network.network import CurveNetwork

COARSE = 4.0
"""Tolerance: edge lengths to which the border of a margin is looked at."""


@dataclass(frozen=True)
class Overlay:
    """Samples around all poses, in the frame of the thing; in order of pose, curve and place on it.

    points, tangents : (n, 3) float64; weights : (n,) float64
    cell : (n,) int64, the pose each comes from; sample : (n,) int64, index into the network's samples
    run : (n,) int64, changes where a stretch of consecutive samples ends
    cells : number of poses
    """

    points: np.ndarray
    tangents: np.ndarray
    weights: np.ndarray
    cell: np.ndarray
    sample: np.ndarray
    run: np.ndarray
    cells: int

    def of_cells(self, cells) -> Overlay:
        """The samples of some poses (k,) int64 alone; these are then numbered from 0."""
        number = np.full(self.cells, -1)
        number[cells] = np.arange(len(cells))
        out = self.part(number[self.cell] >= 0)
        return replace(out, cell=number[out.cell], cells=len(cells))

    def part(self, use) -> Overlay:
        """Some of the samples, flags (n,) bool; a run is broken where some are left out."""
        use = np.flatnonzero(use)
        cut = np.r_[0, (np.diff(use) > 2) | (np.diff(self.run[use]) != 0)]
        return replace(
            self, points=self.points[use], tangents=self.tangents[use], weights=self.weights[use],
            cell=self.cell[use], sample=self.sample[use], run=np.cumsum(cut),
        )  # fmt: skip


def gather(network: CurveNetwork, poses, region, free, margin) -> Overlay:
    """Every pose's samples within a margin of a region; a sample may be seen from several poses.

    Parameters
    ----------
    poses : (k, 4, 4) float64, frame to network, det +1 or -1
    region : (m, 3) float64, points in the frame; free : (n,) bool, samples that take part
    margin : edge lengths
    """
    region = _thinned(region, COARSE)
    low, high = region.min(axis=0) - margin, region.max(axis=0) + margin
    tree = cKDTree(region)
    usable = np.flatnonzero(free)
    back = inverse(poses)
    parts = []
    for a in range(len(poses)):
        local = apply(back[a], network.points[usable])
        inside = np.flatnonzero(((local >= low) & (local <= high)).all(axis=1))
        near = np.isfinite(tree.query(local[inside], distance_upper_bound=margin)[0])
        parts.append((inside[near], local[inside[near]]))
    cell = np.repeat(np.arange(len(poses)), [len(i) for i, _ in parts])
    sample = usable[np.concatenate([i for i, _ in parts])]
    points = np.concatenate([p for _, p in parts])
    tangents = np.einsum("nij,nj->ni", back[cell, :3, :3], network.tangents[sample])
    new = np.ones(len(sample), bool)
    new[1:] = (np.diff(cell) != 0) | (np.diff(sample) > 2) | (np.diff(network.curve_of[sample]) != 0)
    return Overlay(points, tangents, network.weights[sample], cell, sample, np.cumsum(new), len(poses))


def _thinned(points, size):
    """One point of each voxel of the given size."""
    return points[np.unique(np.floor(points / size).astype(np.int64), axis=0, return_index=True)[1]]


def agreement(overlay: Overlay, *, radius, cosine=0.8, stretch=8, moved=None):
    """How many other poses show what a sample shows, and where on average.

    Parameters
    ----------
    radius : edge lengths; cosine : least cosine of the tangents; stretch : shortest stretch of
        agreeing samples, or a whole run where that is shorter
    moved : (n, 3) float64, places of the samples in place of their own, to learn what chance gives

    Returns
    -------
    count : (n,) int64, other poses that agree along a stretch
    mean : (n, 3) float64, the sample's place averaged with theirs, across the curve
    """
    points, lines, cell = overlay.points if moved is None else moved, overlay.tangents, overlay.cell
    n, cells = len(points), overlay.cells
    pair = cKDTree(points).query_pairs(radius, output_type="ndarray").reshape(-1, 2)
    pair = pair[cell[pair[:, 0]] != cell[pair[:, 1]]]
    pair = pair[np.abs((lines[pair[:, 0]] * lines[pair[:, 1]]).sum(1)) > cosine]
    i, j = np.concatenate([pair, pair[:, ::-1]]).T
    # Of each pose the nearest sample is left: it is written last.
    order = np.argsort(-((points[i] - points[j]) ** 2).sum(1), kind="stable")
    nearest = np.full(n * cells, -1)
    nearest[i[order] * cells + cell[j[order]]] = j[order]
    nearest = nearest.reshape(n, cells)
    hit = _long_stretches(nearest >= 0, overlay.run, stretch)
    i, b = np.nonzero(hit)
    j = nearest[i, b]
    offset = points[j] - points[i]
    foot = offset - lines[j] * (offset * lines[j]).sum(1)[:, None]
    # The nearer, the more it counts: a curve beside this one must not draw it over.
    w = np.exp(-0.5 * (foot**2).sum(1) / (radius / 2) ** 2)
    total = 1 + np.bincount(i, w, minlength=n)
    move = np.stack([np.bincount(i, w * foot[:, c], minlength=n) for c in range(3)], 1) / total[:, None]
    return hit.sum(axis=1), points + move


def _long_stretches(hit, run, least):
    """Of flags (n, k), in each column those in unbroken stretches of at least `least` samples of one run, or of all
    samples of a shorter one."""
    n = len(hit)
    if not n:
        return hit
    new = np.r_[True, np.diff(run) != 0]
    fresh = hit & (new[:, None] | ~np.concatenate([np.zeros((1, hit.shape[1]), bool), hit[:-1]]))
    name = np.cumsum(fresh.T.ravel()).reshape(hit.shape[1], n).T
    size = np.bincount(name[hit], minlength=name.max(initial=0) + 1)
    run = np.cumsum(new) - 1
    return hit & (size[name] >= np.minimum(least, np.bincount(run))[run][:, None])


def decoys(points, count, seed=0):
    """Motions (count, 4, 4) about a set of points (n, 3): 7 to 13 edge lengths along the directions in which the
    points extend, and turns of 4 to 8 degrees. What is seen under them is seen by chance."""
    rng = np.random.default_rng(seed)
    centre = points.mean(axis=0)
    values, axes = np.linalg.eigh((points - centre).T @ (points - centre) / len(points))
    way = (rng.normal(size=(count, 3)) * np.sqrt(np.maximum(values, 0))) @ axes.T
    way *= rng.uniform(7, 13, size=(count, 1)) / np.maximum(np.linalg.norm(way, axis=1), 1e-12)[:, None]
    turn = rng.normal(size=(count, 3))
    turn *= np.radians(rng.uniform(4, 8, size=(count, 1))) / np.linalg.norm(turn, axis=1)[:, None]
    out = np.tile(np.eye(4), (count, 1, 1))
    out[:, :3, :3] = Rotation.from_rotvec(turn).as_matrix()
    out[:, :3, 3] = centre - out[:, :3, :3] @ centre + way
    return out
