# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a result on a random scene is right, by what the scene is.

A scene where nothing recurs passes when nothing is found. A thing seen only twice passes by being found: what both
lack nothing can tell. Every other scene must reach the goals of its level.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..measures import CLUTTER, distances, measure, sampled
from ..scenes import EDGE_LENGTH

GOALS = {
    "clean": {"F": 0.97, "completed": 0.95, "instances": 0.95},
    "medium": {"F": 0.95, "completed": 0.85, "instances": 0.85},
    "hard": {"F": 0.90, "completed": 0.75, "instances": 0.75},
}
NEAR = 2.0
"""Edges within which a moved instance lies on another one."""
LANDED = 0.8
"""Share of an instance that must lie on another one for the motion between them to be right."""
REFERENCES = 4
"""Occurrences of a template whose motions to all others are tried."""


def judge(scene, document, level: str) -> dict:
    """Measures and verdict for a report (`fcn-report/1`) on a `RandomScene`."""
    curves = [np.reshape(c["points"], (-1, 3)) for c in document["curves"]]
    result = measure(scene, curves, document.get("inputs"))
    points, _ = sampled(curves, EDGE_LENGTH / 2)
    truth, _ = sampled(scene.truth, EDGE_LENGTH / 2)
    stray = distances(points, truth) > 2 * EDGE_LENGTH
    templates = [t for t in document["templates"] if len(t["occurrences"]) > 0]
    result |= {
        "templates": len(templates),
        "occurrences": sum(len(t["occurrences"]) for t in templates),
        "drawn": len(points) / 2,
        "stray": float(stray.sum()) / 2,
        "samples": int(sum(map(len, scene.curves))),
        "completable": completable(scene),
        **found_poses(scene, document),
    }
    return result | verdict(result, scene, level)


def verdict(result, scene, level) -> dict:
    """`passed`, by which `rule`, and each goal of the level as reached or not."""
    seen = np.bincount(scene.pose_kind) if len(scene.pose_kind) else np.zeros(0, int)
    share = result["instances_90"] / max(result["instances"], 1)
    value = {"F": result["out_F"], "completed": result["completed"], "instances": share}
    reached = {name: bool(value[name] >= goal) for name, goal in GOALS[level].items()}
    if len(seen) == 0:
        rule, passed = "none", result["templates"] == 0
    elif seen.max() == 2:
        rule, passed = "twice", result["pose_recall"] == 1.0
    else:
        rule, passed = "goals", all(reached.values())
    return {"rule": rule, "passed": bool(passed), "reached": reached, "instances_share": share}


def completable(scene) -> float:
    """Share of the repeated length that no input shows at one place but some input shows at another; 1 of nothing.

    No method can complete more without guessing.
    """
    truth, of = sampled(scene.truth, EDGE_LENGTH)
    instance = scene.truth_labels[of, 2]
    given, given_of = sampled(scene.curves, EDGE_LENGTH / 2)
    tree = cKDTree(given[scene.labels[given_of, 0] < CLUTTER])
    missing = known = 0
    for kind in np.unique(scene.pose_kind):
        poses = scene.poses[scene.pose_kind == kind]
        first = truth[instance == np.argmax(scene.pose_kind == kind)]
        places = moved(first, poses @ np.linalg.inv(poses[0]))
        seen = tree.query(places)[0] <= NEAR * EDGE_LENGTH
        missing += int((~seen).sum())
        known += int((~seen & seen.any(axis=0)).sum())
    return known / missing if missing else 1.0


def found_poses(scene, document) -> dict:
    """How many of the true poses were found, and how many of the found ones are true.

    A pose is found where a motion between two occurrences of a template carries one instance onto another one. The
    frame of a template is its own, so that only these motions can be compared; of a thing with a symmetry, every
    motion that lays it onto itself is right.

    Returns `pose_recall`, share of the true poses, and `pose_precision`, share of the occurrences; 1 of none.
    """
    labels, instances = scene.truth_labels, len(scene.pose_kind)
    repeated = np.flatnonzero(labels[:, 0] == 0)
    if len(repeated) == 0:
        count = sum(len(t["occurrences"]) for t in document["templates"])
        return {"pose_recall": 1.0, "pose_precision": 0.0 if count else 1.0}
    truth, of = sampled([scene.truth[i] for i in repeated], EDGE_LENGTH)
    instance = labels[repeated, 2][of]
    tree = cKDTree(truth)
    bodies = [thin(truth[instance == i]) for i in range(instances)]
    drawn = {}
    for curve in document["curves"]:
        if curve["kind"] == "template":
            drawn.setdefault((curve["template"], curve["occurrence"]), []).append(np.reshape(curve["points"], (-1, 3)))
    found, right, count = np.zeros(instances, bool), 0, 0
    for template in document["templates"]:
        motions = np.array(template["occurrences"], float).reshape(-1, 4, 4)
        count += len(motions)
        best = np.zeros(0, int)
        for a in range(min(len(motions), REFERENCES)):
            start = stands_at(drawn.get((template["id"], a), []), tree, instance)
            if start < 0:
                continue
            landed = landings(bodies[start], motions @ np.linalg.inv(motions[a]), tree, instance)
            same = landed[(landed >= 0) & (scene.pose_kind[landed] == scene.pose_kind[start])]
            best = max(best, same, key=len)
        if len(set(best.tolist())) > 1:
            found[best] = True
            right += len(best)
    return {"pose_recall": float(found.mean()), "pose_precision": right / count if count else 1.0}


def thin(points, most=200) -> np.ndarray:
    """At most so many of the points, spread over all."""
    return points[:: max(1, -(-len(points) // most))]


def stands_at(curves, tree, instance) -> int:
    """The instance that most of an occurrence's curves lie on, -1 where none has a third of them."""
    points, _ = sampled(curves, EDGE_LENGTH)
    if len(points) == 0:
        return -1
    distance, nearest = tree.query(points)
    near = distance <= NEAR * EDGE_LENGTH
    votes = np.bincount(instance[nearest[near]], minlength=1)
    return int(votes.argmax()) if votes.max() * 3 >= len(points) else -1


def moved(points, motions) -> np.ndarray:
    """(k, n, 3) float64, points (n, 3) under each motion (k, 4, 4)."""
    return np.einsum("kij,nj->kni", motions[:, :3, :3], points) + motions[:, None, :3, 3]


def landings(body, motions, tree, instance) -> np.ndarray:
    """(k,) int64, the instance that the body (n, 3) lies on after each motion (k, 4, 4); -1 where on none."""
    distance, nearest = tree.query(moved(body, motions))
    near = distance <= NEAR * EDGE_LENGTH
    out = np.full(len(motions), -1)
    for k in range(len(motions)):
        votes = np.bincount(instance[nearest[k][near[k]]], minlength=1)
        if votes.max() >= LANDED * len(body):
            out[k] = votes.argmax()
    return out
