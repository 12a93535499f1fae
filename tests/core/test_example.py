# SPDX-License-Identifier: GPL-3.0-or-later
"""The project's own example: what a run of it finds, as structure, against how the facade was built."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from core.files.readers.obj import read_obj
from core.pipeline import complete
from examples.make_example import EDGE_LENGTH, PETALS, example_network, example_scene
from tests import naive

FACADE = Path(__file__).parents[2] / "examples" / "facade.obj"
WINDOWS = 8


@pytest.fixture(scope="module")
def completion():
    return complete(read_obj(FACADE).curves)


def shown(templates):
    """Points of templates at all their occurrences, world space."""
    places = [c.points @ m[:3, :3].T + m[:3, 3] for t in templates for c in t.curves for m in t.occurrences]
    return np.concatenate(places)


def windows():
    """Points of the true curves of the windows: what repeats below the upper moulding."""
    scene = example_scene()
    repeated = [c for c, label in zip(scene.truth, scene.truth_labels) if label[0] == 0]
    return np.concatenate([c for c in repeated if c[:, 2].max() < 3.65])


def test_the_example_is_what_its_script_makes():
    read, made = read_obj(FACADE).curves, example_scene().curves
    assert len(read) == len(made) and np.allclose(read.points[:50], np.concatenate(made)[:50], atol=1e-6)
    instances = {int(label[2]) for label in example_network().labels if label[0] == 0}
    assert len(instances) == WINDOWS + PETALS


def test_the_edge_length_and_the_counts(completion):
    assert completion.edge_length == pytest.approx(EDGE_LENGTH, rel=0.01)
    assert len(completion.inputs.kind) == len(example_scene().curves)
    labels = example_scene().labels[:, 0]
    assert set(completion.inputs.kind) <= {"template", "strong", "noise"}
    long = np.array([len(c) > 12 for c in example_scene().curves])
    assert (completion.inputs.kind[long & (labels == 2)] == "noise").mean() > 0.8, "clutter is noise"
    assert (completion.inputs.kind[long & (labels == 0)] == "template").mean() > 0.6


def test_the_windows_are_a_grid(completion):
    grids = [t for t in completion.transformations if t.kind == "grid"]
    assert len(grids) == 1
    steps = grids[0].generators[:, :3, 3]
    assert np.allclose(sorted(np.linalg.norm(steps, axis=1)), [1.4, 1.9], atol=EDGE_LENGTH)
    assert grids[0].id == max(completion.transformations, key=lambda t: t.support).id
    found = [t for t in completion.templates if t.transformation == grids[0].id and len(t.occurrences) == WINDOWS]
    # The mouldings between the rows may be a template of their own with as many places.
    found = [max(found, key=lambda t: len(t.curves))]
    assert 6 <= len(found[0].curves) <= 14
    places, built = shown(found), windows()
    assert (cKDTree(places).query(built)[0] < 3 * EDGE_LENGTH).mean() > 0.75
    assert (cKDTree(built).query(places)[0] < 3 * EDGE_LENGTH).mean() > 0.9


def test_the_rosette_is_a_rotation(completion):
    turns = [t for t in completion.transformations if t.kind == "rotation"]
    angles = [naive.angle_of(t.generators[0][:3, :3]) for t in turns]
    assert any(abs(a - 360 / PETALS) < 0.5 for a in angles)
    assert any(len(t.occurrences) == PETALS for t in completion.templates if t.transformation in [x.id for x in turns])
