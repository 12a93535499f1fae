# SPDX-License-Identifier: GPL-3.0-or-later
"""Results as collections: what is linked where, where it stands, and that a fault leaves nothing behind."""

import dataclasses

import numpy as np
import pytest


@pytest.fixture
def written(bpy, part, completion, curves):
    root = part("fcn_addon.result.writer").write(completion, curves, source="wall", scene=bpy.context.scene)
    bpy.context.view_layer.update()
    return root


def world(item):
    """(k, 3), the points of a poly spline object in world space."""
    points = np.array([p.co[:3] for s in item.data.splines for p in s.points])
    matrix = np.array(item.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def parts(collection):
    return [o for o in collection.objects if o.type == "CURVE"]


def test_the_collections_are_named_for_people(written, bpy):
    assert written.name == "FCN wall"
    assert [c.name for c in written.children] == ["Input", "Templates", "Components", "Strong", "Noise"]
    assert [c.name for c in written.children["Templates"].children] == ["Grid 1: 3 x 2, step 1.8 m, 2.4 m"]
    assert [c.name for c in written.children["Components"].children] == ["Component 0", "Component 1"]
    assert [c.name for c in written.children if c.hide_viewport] == ["Input", "Noise"]
    assert bpy.context.scene.collection.children[0] == written


def test_occurrences_share_the_data_of_their_template(written):
    home = written.children["Templates"].children[0]
    made = parts(home)
    assert len(made) == 12
    assert len({o.data for o in made}) == 2
    assert {o.parent.type for o in made} == {"EMPTY"}
    assert len({o.parent for o in made}) == 6
    assert all(s.type == "POLY" for o in made for s in o.data.splines)
    assert all(o.data.bevel_depth == 0 and o.data.dimensions == "3D" for o in made)
    made[0].data.splines[0].points[0].co[0] += 5
    assert all(o.data.splines[0].points[0].co[0] == made[0].data.splines[0].points[0].co[0] for o in made[::2])


def test_every_curve_stands_where_the_report_says(written, part, completion, curves):
    document = part("core.report").report(
        completion, curves, version="0", parameters=part("core.parameters").Parameters()
    )
    home = written.children["Templates"].children[0]
    shown = {(o["occurrence"], o["component"]): o for o in parts(home)}
    for row in document["curves"]:
        if row["kind"] == "template":
            item = shown[row["occurrence"], row["component"]]
            assert item["template"] == row["template"] == 3
            assert item["support"] == pytest.approx(row["support"])
            assert item.data.splines[0].use_cyclic_u == row["closed"]
            assert np.allclose(world(item), row["points"], atol=1e-5)
    (strong,) = parts(written.children["Strong"])
    assert np.allclose(world(strong), document["curves"][-1]["points"], atol=1e-5)
    assert strong["support"] == 1.0


def test_the_same_objects_are_in_their_component_beside_its_input(written, curves):
    home = written.children["Templates"].children[0]
    for label, child in enumerate(written.children["Components"].children):
        linked = [o for o in child.objects if "support" in o]
        assert set(linked) == {o for o in parts(home) if o["component"] == label}
        (pieces,) = [o for o in child.objects if "support" not in o]
        assert pieces.hide_viewport
        assert np.allclose(world(pieces), curves.curve(label), atol=1e-5)


def test_input_and_noise_are_there(written, curves, bpy):
    (mesh,) = written.children["Input"].objects
    assert len(mesh.data.vertices) == len(curves.points)
    assert len(mesh.data.edges) == 3 + 5 + 5 + 2
    source = [v.value for v in mesh.data.attributes["source"].data]
    assert source == [0] * 4 + [1] * 5 + [2] * 6 + [3] * 3
    assert {v.value for v in mesh.data.attributes["curvature"].data} == {2.0}
    (noise,) = written.children["Noise"].objects
    assert np.allclose(world(noise), curves.curve(3), atol=1e-5)


def test_colours_are_those_of_the_paper(written, part):
    colours = part("fcn_addon.colours")
    home = written.children["Templates"].children[0]
    assert np.allclose([tuple(o.color)[:3] for o in parts(home)], colours.TEMPLATE)
    assert np.allclose(written.children["Strong"].objects[0].color[:3], colours.STRONG)
    assert len({colours.distinct(i) for i in range(50)}) == 50
    assert colours.distinct(-1) == colours.distinct(None) == colours.NOISE


def test_far_from_the_origin_the_shape_is_kept(bpy, part, completion, curves):
    far = np.eye(4)
    far[:3, 3] = 1e7
    moved = dataclasses.replace(
        completion,
        templates=tuple(dataclasses.replace(t, occurrences=far @ t.occurrences) for t in completion.templates),
    )
    root = part("fcn_addon.result.writer").write(moved, curves, source="far", scene=bpy.context.scene)
    data = parts(root.children["Templates"].children[0])[0].data
    points = np.array([p.co[:3] for p in data.splines[0].points])
    assert np.linalg.norm(np.diff(points, axis=0), axis=1) == pytest.approx(2 * np.sin(np.pi / 16), abs=1e-6)


def count(bpy):
    return [len(c) for c in (bpy.data.objects, bpy.data.curves, bpy.data.meshes, bpy.data.collections)]


@pytest.mark.parametrize("step", ["_input", "_templates", "_components", "_strong", "_pieces"])
def test_a_fault_leaves_nothing_behind(bpy, part, completion, curves, monkeypatch, step):
    writer = part("fcn_addon.result.writer")
    before = count(bpy)
    real = getattr(writer._Writer, step)

    def breaks(self, *rest):
        real(self, *rest)
        raise MemoryError(step)

    monkeypatch.setattr(writer._Writer, step, breaks)
    with pytest.raises(MemoryError):
        writer.write(completion, curves, source="wall", scene=bpy.context.scene)
    assert count(bpy) == before


def test_two_results_stand_side_by_side(bpy, part, completion, curves, written):
    other = part("fcn_addon.result.writer").write(completion, curves, source="wall", scene=bpy.context.scene)
    assert other.name == "FCN wall.001"
    assert not set(other.all_objects) & set(written.all_objects)


def test_nothing_found_is_written_too(bpy, part, completion, curves):
    classes = dataclasses.replace(completion.inputs, kind=np.full(4, "noise"), component=np.full(4, -1))
    empty = dataclasses.replace(completion, transformations=(), templates=(), strong=(), inputs=classes)
    root = part("fcn_addon.result.writer").write(empty, curves, source="x", scene=bpy.context.scene)
    assert len(root.all_objects) == 2  # input and noise
