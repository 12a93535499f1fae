# SPDX-License-Identifier: GPL-3.0-or-later
"""The button: the scene before and after, undo, earlier results, and what is taken for curves."""

import dataclasses
import time

import numpy as np
import pytest


def count(bpy):
    return [len(c) for c in (bpy.data.objects, bpy.data.curves, bpy.data.meshes, bpy.data.collections)]


def points(item):
    return [tuple(v.co) for v in item.data.vertices]


def test_the_result_and_the_source(bpy, part, wall, work):
    before = points(wall), [tuple(r) for r in wall.matrix_world]
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    root = bpy.context.scene.fcn.result
    result = root.fcn_result
    assert root.name == "FCN Wall" and result.is_result and result.source == "Wall"
    assert (result.templates, result.occurrences, result.strong, result.noise) == (1, 6, 1, 1)
    assert wall.hide_get() and not wall.hide_viewport and not wall.select_get()
    assert (points(wall), [tuple(r) for r in wall.matrix_world]) == before
    (row,) = result.transformations
    assert (row.name, row.short) == ("Grid 1: 3 x 2, step 1.8 m, 2.4 m", "Grid 1: 3 x 2")
    assert (row.kind, row.ident, row.count, row.curves) == ("grid", 5, 6, 12)
    assert row.support == pytest.approx(0.4) and row.log_bayes_factor == pytest.approx(40)
    assert row.home == root.children["Templates"].children[0]
    assert result.edge_length == pytest.approx(0.02)


def test_poll_says_why_not(bpy, wall, work):
    wall.select_set(False)
    with pytest.raises(RuntimeError, match="Select curves or edge meshes"):
        bpy.ops.fcn.complete()
    settings = bpy.context.scene.fcn
    settings.source = "COLLECTION"
    with pytest.raises(RuntimeError, match="Choose the collection"):
        bpy.ops.fcn.complete()
    settings.collection = bpy.data.collections.new("Empty")
    with pytest.raises(RuntimeError, match="holds no edge mesh"):
        bpy.ops.fcn.complete()
    settings.source, settings.edge_length_from = "SELECTION", "SCAN"
    wall.select_set(True)
    with pytest.raises(RuntimeError, match="Choose the scan"):
        bpy.ops.fcn.complete()
    settings.edge_length_from = "ESTIMATE"
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="edit mode"):
        bpy.ops.fcn.complete()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.fcn.complete.poll()


def test_a_collection_with_those_inside_it(bpy, part, wall, work):
    outer, inner = bpy.data.collections.new("Outer"), bpy.data.collections.new("Inner")
    bpy.context.scene.collection.children.link(outer)
    outer.children.link(inner)
    inner.objects.link(wall)
    wall.select_set(False)
    settings = bpy.context.scene.fcn
    settings.source, settings.collection = "COLLECTION", outer
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert settings.result.name == "FCN Outer" and wall.hide_get()
    assert bpy.ops.fcn.complete() == {"FINISHED"}  # again, though the source is hidden now


def test_the_edge_length(bpy, part, wall):
    completing, settings = part("fcn_addon.job.completing"), bpy.context.scene.fcn
    assert completing.take(bpy.context).edge_length is None
    wall["edge_length"] = 0.25  # detected curves know it
    assert completing.take(bpy.context).edge_length == pytest.approx(0.25)
    del wall["edge_length"]
    settings.edge_length_from, settings.edge_length = "VALUE", 0.03
    assert completing.take(bpy.context).edge_length == 0.03
    mesh = bpy.data.meshes.new("Scan")
    mesh.from_pydata([(0, 0, 0), (3, 0, 0), (0, 4, 0)], [], [(0, 1, 2)])
    scan = bpy.data.objects.new("Scan", mesh)
    bpy.context.scene.collection.objects.link(scan)
    scan.scale = (2, 2, 2)
    settings.edge_length_from = "SCAN"
    with pytest.raises(part("core.errors").InputError, match="Choose the scan"):
        completing.take(bpy.context)
    scan.select_set(True)
    bpy.context.view_layer.update()
    assert completing.take(bpy.context).edge_length == pytest.approx(8)
    assert [s.name for s in completing.take(bpy.context).sources] == ["Wall"]
    scan.select_set(False)
    settings.scan = scan
    assert completing.take(bpy.context).edge_length == pytest.approx(8)


def test_the_parameters_are_the_papers_and_come_back_exactly(bpy, part):
    properties, parameters = part("fcn_addon.properties.settings"), part("core.parameters").Parameters
    group = bpy.context.scene.fcn.parameters
    assert properties.parameters(group) == parameters()
    other = parameters(l0=12.3, s=0.01, t=0.7, epsilon=2.25, threads=3)
    properties.set_parameters(group, other)
    assert properties.parameters(group) == other
    assert set(properties.WORDS) == set(part("core.parameters").Parameters.__dataclass_fields__)
    group.t = 0.01
    group.s = 5
    assert properties.parameters(group).t == properties.parameters(group).s == 5


def test_one_undo_step(bpy, wall, work):
    bpy.ops.ed.undo_push(message="before")
    before = count(bpy)
    bpy.ops.fcn.complete("EXEC_DEFAULT", True)
    assert count(bpy) != before
    bpy.ops.ed.undo()
    assert count(bpy) == before
    assert bpy.context.scene.fcn.result is None and not bpy.data.objects["Wall"].hide_get()
    bpy.ops.ed.redo()
    assert bpy.context.scene.fcn.result.fcn_result.occurrences == 6
    assert bpy.data.objects["Wall"].hide_get()


def test_the_earlier_result_is_replaced_or_kept(bpy, part, made):
    before = count(bpy)
    assert bpy.ops.fcn.complete() == {"FINISHED"}  # nothing is selected: the same curves again
    assert count(bpy) == before
    results, scene = part("fcn_addon.result.stored"), bpy.context.scene
    assert [r.name for r in results.of_scene(scene)] == ["FCN Wall"]
    first = scene.fcn.result
    scene.fcn.earlier = "KEEP"
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    assert [r.name for r in results.of_scene(scene)] == ["FCN Wall", "FCN Wall.001"]
    second = scene.fcn.result
    assert second != first and results.active(scene) == second
    second.fcn_result.view = "INPUT"
    assert first.fcn_result.view == "RESULT"
    scene.fcn.result = first
    bpy.ops.fcn.remove_result()
    assert results.of_scene(scene) == [second] and results.active(scene) == second
    assert not bpy.data.objects["Wall"].hide_get()


def test_what_the_user_put_into_a_result_outlives_it(bpy, part, made):
    mine = bpy.data.objects.new("Mine", None)
    made.objects.link(mine)
    bpy.context.scene.collection.objects.link(mine)
    bpy.ops.fcn.remove_result()
    assert "Mine" in bpy.data.objects and not list(bpy.data.curves) and "Wall" in bpy.data.objects


def test_the_summary(bpy, part, wall):
    summary = part("fcn_addon.job.summary")
    parameters = bpy.context.scene.fcn.parameters
    parameters.l0, parameters.smoothing = 4, 0
    found = summary.compute(bpy.context)
    assert isinstance(found, part("fcn_addon.job.estimate").Summary)
    assert (found.objects, found.curves) == (1, 4)
    lengths = part("core.report").lengths(part("fcn_addon.job.completing").take(bpy.context).reading.curves)
    assert found.samples == pytest.approx(lengths.sum() / found.edge_length, abs=5)
    assert bpy.ops.fcn.measure() == {"FINISHED"}
    bpy.context.scene.fcn.parameters.l0 = 1000
    assert summary.compute(bpy.context).strong == 0 < found.strong
    wall.select_set(False)
    assert summary.compute(bpy.context) == "Select curves or edge meshes"


def test_hidden_sources_are_evaluated_for_a_run(bpy, part, wall):
    array = wall.modifiers.new("Array", "ARRAY")
    array.count = 3
    collection = bpy.data.collections.new("Walls")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(wall)
    settings = bpy.context.scene.fcn
    settings.source, settings.collection, settings.use_hidden = "COLLECTION", collection, True
    wall.hide_set(True)
    bpy.context.view_layer.update()
    assert part("fcn_addon.job.completing").take(bpy.context).reading.count == 12
    assert wall.hide_get()


def test_the_method_itself_gives_a_result(bpy, part):
    """The whole way with the real method: the example's windows, three of one row."""
    path = part("fcn_addon.installation").ROOT / "examples" / "facade.obj"
    read = part("core.files.formats").read_curves([str(path)]).curves
    middle = [read.curve(i).mean(axis=0) for i in range(len(read))]
    kept = [i for i, (x, _, z) in enumerate(middle) if z < 2.5 and x < 5.0]
    mesh = bpy.data.meshes.new("Row")
    vertices = np.concatenate([read.curve(i) for i in kept])
    at = np.cumsum([0] + [len(read.curve(i)) for i in kept])
    mesh.from_pydata(vertices.tolist(), [(k, k + 1) for a, b in zip(at[:-1], at[1:]) for k in range(a, b - 1)], [])
    item = bpy.data.objects.new("Row", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    bpy.context.view_layer.update()
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    result = bpy.context.scene.fcn.result.fcn_result
    assert result.templates and result.occurrences >= 2 and result.seconds > 0


def test_selected_parts_of_a_result_are_not_taken_for_curves(bpy, part, made):
    bpy.ops.fcn.select_transformation(index=0)
    chosen, completing = part("fcn_addon.job.chosen"), part("fcn_addon.job.completing")
    assert len(bpy.context.selected_objects) == 12 and chosen.is_again(bpy.context)
    assert [item.name for item in completing.take(bpy.context).sources] == ["Wall"]


def test_ten_thousand_objects_in_time(bpy, part, wall, completion, monkeypatch):
    """From what the method gave to what is seen: 10,000 curves of 1,000 occurrences, and their empties."""
    (template,) = completion.templates
    places = np.tile(np.eye(4), (1000, 1, 1))
    places[:, 0, 3] = np.arange(1000)
    evidence = np.tile(np.linspace(0, 1, 1000)[:, None], 10)
    many = dataclasses.replace(template, curves=template.curves * 5, occurrences=places, evidence=evidence)
    many = dataclasses.replace(completion, templates=(many,))
    monkeypatch.setattr(part("fcn_addon.job.completing"), "_work", lambda task, report: many)
    began = time.process_time()
    assert bpy.ops.fcn.complete() == {"FINISHED"}
    bpy.context.view_layer.update()
    taken = time.process_time() - began
    result = bpy.context.scene.fcn.result
    home = result.children["Templates"].children[0]
    assert len(home.objects) == 11000
    began = time.process_time()
    result.fcn_result.support = 0.5
    bpy.context.view_layer.update()
    hiding = time.process_time() - began
    assert sum(o.visible_get() for o in home.objects if "support" in o) == 5000
    selection, objects = part("fcn_addon.result.selection"), list(home.objects)
    began = time.process_time()
    assert len(selection.parts(objects)) == 10000 and selection.results_of(bpy.context.scene, objects) == [result]
    looking = time.process_time() - began
    print(f"10,000 objects: {taken:.2f} s, half of them hidden by support: {hiding:.2f} s, looked up: {looking:.2f} s")
    # Docs have what they take; these bounds are for busy machines, and find what grows with the square.
    assert taken < 15 and hiding < 8 and looking < 2


def test_edges_that_share_no_vertex_are_one_curve(bpy, part):
    """As drawing programs leave them: each edge has vertices of its own."""
    along = np.linspace(0, 3, 40)
    line = np.c_[along, np.sin(2 * along), np.cos(3 * along)]
    pairs = np.stack([line[:-1], line[1:]], axis=1).reshape(-1, 3)
    mesh = bpy.data.meshes.new("Lines")
    mesh.from_pydata(pairs.tolist(), [(2 * i, 2 * i + 1) for i in range(39)], [])
    item = bpy.data.objects.new("Lines", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    task = part("fcn_addon.job.completing").take(bpy.context)
    assert len(task.reading.curves) == 1
    assert np.allclose(task.reading.curves.points, line, atol=1e-6)
    assert task.reading.count == len(task.owner) == 39  # input curves stay what they were
