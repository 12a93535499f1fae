# SPDX-License-Identifier: GPL-3.0-or-later
"""How near a completed network is to the truth of a scene. Lengths count as samples half an edge apart."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

REPEATED, SINGLE, CLUTTER = 0, 1, 2


def sampled(polylines, step) -> tuple[np.ndarray, np.ndarray]:
    """Points at arc lengths 0, step, 2 step, ... of every polyline.

    polylines : sequence of (k, 3) arrays, k >= 0

    Returns points (n, 3) float64 and the polyline of each point (n,) int64. A polyline without length gives one point.
    """
    polylines = [np.asarray(p, float).reshape(-1, 3) for p in polylines]
    counts = np.array([len(p) for p in polylines], np.int64)
    if counts.sum() == 0:
        return np.zeros((0, 3)), np.zeros(0, np.int64)
    vertices = np.concatenate(polylines)
    curve = np.repeat(np.arange(len(counts)), counts)
    last = np.cumsum(counts) - 1
    first = last - counts + 1
    edges = np.linalg.norm(np.diff(vertices, axis=0), axis=1)
    edges[curve[1:] != curve[:-1]] = 0.0
    position = np.r_[0.0, np.cumsum(edges)]
    used = counts > 0
    begin = position[first[used]]
    number = np.floor((position[last[used]] - begin + 1e-12) / step).astype(np.int64) + 1
    of = np.repeat(np.flatnonzero(used), number)
    rank = np.arange(len(of)) - np.repeat(np.cumsum(number) - number, number)
    at = np.repeat(begin, number) + rank * step
    left = np.clip(np.searchsorted(position, at, side="right") - 1, first[of], np.maximum(last[of] - 1, first[of]))
    right = np.minimum(left + 1, last[of])
    length = position[right] - position[left]
    share = np.where(length > 0, np.clip((at - position[left]) / np.where(length > 0, length, 1), 0, 1), 0.0)
    return vertices[left] + share[:, None] * (vertices[right] - vertices[left]), of


def distances(points, network) -> np.ndarray:
    """(n,) float64, from each point to the nearest point of the network; infinite where the network is empty."""
    if len(points) == 0 or len(network) == 0:
        return np.full(len(points), np.inf)
    return cKDTree(network).query(points)[0]


def share_within(distance, tau) -> float:
    """Share of the distances that are at most tau; of nothing, all."""
    return float(np.mean(distance <= tau)) if len(distance) else 1.0


def harmonic(precision, recall) -> float:
    """F measure."""
    return 2 * precision * recall / (precision + recall) if precision + recall > 0 else 0.0


def pair_counting(found, truth, weight) -> tuple[float, float]:
    """Precision and recall of the pairs of items that share a label; a pair counts the product of its weights.

    found, truth : (n,) labels of any kind; weight : (n,) float64
    """
    weight = np.asarray(weight, float)
    a = np.unique(np.asarray(found), return_inverse=True)[1]
    b = np.unique(np.asarray(truth), return_inverse=True)[1]

    def pairs(label):
        return float((np.bincount(label, weight) ** 2).sum() - (weight**2).sum())

    both = pairs(np.unique(a * (b.max() + 1) + b, return_inverse=True)[1])
    together, belong = pairs(a), pairs(b)
    return (both / together if together > 0 else 1.0), (both / belong if belong > 0 else 1.0)


def rms_near(distance, edge_length) -> float:
    """Root mean square, in edge lengths, of the distances within two edges; NaN where there is none."""
    near = distance[distance <= 2 * edge_length]
    return float(np.sqrt(np.mean(near**2)) / edge_length) if len(near) else float("nan")


def measure(scene, curves, inputs=None, *, edge_length=0.02) -> dict:
    """All measures of a completed network.

    Parameters
    ----------
    scene : truth and input, a `Scene`
    curves : polylines (k, 3) of the completed network, world space
    inputs : one dict per input curve with "kind" and "component", as in the report; None leaves those measures out
    """
    h, step = edge_length, edge_length / 2
    output, _ = sampled(curves, step)
    given, given_of = sampled(scene.curves, step)
    truth, truth_of = sampled(scene.truth, step)
    shown = given[scene.labels[given_of, 0] < CLUTTER]
    clutter = given[scene.labels[given_of, 0] == CLUTTER]
    repeated = scene.truth_labels[truth_of, 0] == REPEATED
    to_output = distances(truth, output)
    result = {}
    for name, network, from_truth in (("in", given, distances(truth, given)), ("out", output, to_output)):
        to_truth = distances(network, truth)
        for suffix, tau in (("", 2 * h), ("@h", h)):
            precision = share_within(to_truth, tau)
            recall = share_within(from_truth, tau)
            result |= {f"{name}_P{suffix}": precision, f"{name}_R{suffix}": recall}
            result[f"{name}_F{suffix}"] = harmonic(precision, recall)
    unseen = distances(truth[repeated], shown) > 2 * h
    result["missing_share"] = float(unseen.mean()) if len(unseen) else 0.0
    result["completed"] = share_within(to_output[repeated][unseen], 2 * h)
    if len(clutter):
        away = clutter[distances(clutter, truth) > 2 * h]
        result["clutter_left"] = share_within(distances(away, output), h / 2) if len(away) else 0.0
    result["rms_in/h"], result["rms_out/h"] = (rms_near(distances(p, truth), h) for p in (shown, output))
    instance = scene.truth_labels[truth_of[repeated], 2]
    names, index = np.unique(instance, return_inverse=True)
    covered = np.bincount(index, to_output[repeated] <= 2 * h) / np.bincount(index)
    result["instances"], result["instances_90"] = len(names), int((covered >= 0.9).sum())
    if inputs is not None:
        result |= measure_classes(scene, inputs)
    return result


def measure_classes(scene, inputs) -> dict:
    """How well the input curves are told apart; every curve counts by its number of vertices."""
    if len(inputs) != len(scene.curves):
        return {"inputs_mismatch": f"{len(inputs)} classes for {len(scene.curves)} curves"}
    weight = np.array([len(c) for c in scene.curves], float)
    kind = np.array([entry.get("kind") for entry in inputs], object)
    component = np.array([entry.get("component") for entry in inputs], object)
    repeated, clutter = scene.labels[:, 0] == REPEATED, scene.labels[:, 0] == CLUTTER
    template, noise = kind == "template", kind == "noise"
    result = {
        "rep_recall": float(weight[repeated & template].sum() / max(weight[repeated].sum(), 1)),
        "rep_prec": float(weight[repeated & template].sum() / max(weight[template].sum(), 1)),
        "noise_removed": float(weight[clutter & noise].sum() / max(weight[clutter].sum(), 1)),
    }
    named = repeated & np.array([c is not None for c in component], bool)
    if named.any():
        labels = [str(c) for c in component[named]]
        p, r = pair_counting(labels, scene.labels[named, 1], weight[named])
        result |= {"comp_P": p, "comp_R": r, "comp_F": harmonic(p, r)}
    result["comp_share"] = float(weight[named].sum() / max(weight[repeated].sum(), 1))
    return result
