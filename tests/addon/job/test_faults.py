# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong in a run, or with its source meanwhile, leaves the scene as it was."""

import pytest


def count(bpy):
    return [len(c) for c in (bpy.data.objects, bpy.data.curves, bpy.data.meshes, bpy.data.collections)]


@pytest.fixture
def waves(bpy, arcs):
    """Three equal wavy curves and a stray one, selected: so few that the method itself takes a moment only."""
    rows = [line.split() for line in arcs().splitlines()]
    points = [tuple(map(float, row[1:])) for row in rows if row[0] == "v"]
    edges = [(int(a) - 1, int(b) - 1) for row in rows if row[0] == "l" for a, b in zip(row[1:-1], row[2:])]
    mesh = bpy.data.meshes.new("Waves")
    mesh.from_pydata(points, edges, [])
    item = bpy.data.objects.new("Waves", mesh)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    bpy.context.view_layer.update()
    return item


def test_an_error_of_the_input_is_reported(bpy, part, wall, monkeypatch):
    def refuse(task, report):
        raise part("core.errors").InputError("no curve is strong: give a smaller l0")

    monkeypatch.setattr(part("fcn_addon.job.completing"), "_work", refuse)
    before = count(bpy)
    with pytest.raises(RuntimeError, match="give a smaller l0"):
        bpy.ops.fcn.complete()
    assert count(bpy) == before and not wall.hide_get()


@pytest.mark.parametrize("where", ["stored.describe", "views.refresh", "writer.write"])
def test_a_fault_while_writing_leaves_what_was(bpy, part, made, monkeypatch, where):
    module, name = where.split(".")
    before = count(bpy)

    def breaks(*args, **more):
        raise MemoryError(where)

    monkeypatch.setattr(part(f"fcn_addon.result.{module}"), name, breaks)
    with pytest.raises(RuntimeError, match=where):
        bpy.ops.fcn.complete()
    assert count(bpy) == before
    assert bpy.context.scene.fcn.result == made


@pytest.mark.parametrize(
    ("stage", "kind"),
    [
        *((stage, "fault") for stage in ("blast", "seeding", "growth", "orbits", "selection", "completion")),
        ("growth", "memory"),
        ("orbits", "stop"),
    ],
)
def test_what_goes_wrong_in_a_stage_leaves_nothing(bpy, part, waves, monkeypatch, stage, kind):
    """In the thread, with the method itself, which is interrupted in the stage."""
    session, completing, errors = part("fcn_addon.job.session"), part("fcn_addon.job.completing"), part("core.errors")
    work, reached = completing._work, []

    def breaks(task, report):
        def tell(name, fraction):
            report(name, fraction)
            if name == stage:
                reached.append(fraction)
                raise {"fault": ZeroDivisionError(stage), "memory": MemoryError(), "stop": errors.Cancelled()}[kind]

        return work(task, tell)

    monkeypatch.setattr(completing, "_work", breaks)
    before = count(bpy)
    run = session.begin(bpy.context, completing.COMPLETE)
    assert run.job.join(60)
    session.tick()
    session.end()
    expected, message = {
        "fault": (errors.InputError, f"a fault of the program.*{stage}"),
        "memory": (errors.InputError, "not enough memory"),
        "stop": (errors.Cancelled, None),
    }[kind]
    with pytest.raises(expected, match=message):
        session.outcome(run)
    assert len(reached) == 1
    assert count(bpy) == before and not session.running() and not waves.hide_get()
    if stage != "blast":  # it takes the method itself, once is enough
        return
    monkeypatch.undo()
    assert bpy.ops.fcn.complete() == {"FINISHED"}  # and the next run is as if nothing had been
    assert bpy.context.scene.fcn.result.fcn_result.occurrences


def finished(bpy, part, completion, change):
    """Run, with a change of the scene meanwhile."""
    completing = part("fcn_addon.job.completing")
    task = completing.take(bpy.context)
    change()
    return completing.finish(bpy.context, task, completion)


def test_the_result_is_refused_where_the_source_has_gone(bpy, part, wall, completion):
    before = count(bpy)
    with pytest.raises(part("core.errors").InputError, match="object 'Wall' has gone"):
        finished(bpy, part, completion, lambda: bpy.data.objects.remove(wall))
    assert count(bpy) == [before[0] - 1, *before[1:]]


def test_another_object_of_that_name_is_not_the_source(bpy, part, wall, completion):
    def replace():
        mesh = wall.data
        bpy.data.objects.remove(wall)
        bpy.context.scene.collection.objects.link(bpy.data.objects.new("Wall", mesh))

    with pytest.raises(part("core.errors").InputError, match="has gone"):
        finished(bpy, part, completion, replace)


def test_a_source_that_is_only_unlinked_has_gone(bpy, part, wall, completion):
    with pytest.raises(part("core.errors").InputError, match="has gone"):
        finished(bpy, part, completion, lambda: bpy.context.scene.collection.objects.unlink(wall))


def test_a_scene_that_has_gone(bpy, part, wall, completion):
    other = bpy.data.scenes.new("Other")
    scene = bpy.context.scene

    def remove():
        bpy.context.window_manager.windows[0].scene = other
        bpy.data.scenes.remove(scene)

    with pytest.raises(part("core.errors").InputError, match="scene 'Scene' has gone"):
        finished(bpy, part, completion, remove)


def test_a_renamed_source_is_found(bpy, part, wall, completion):
    root = finished(bpy, part, completion, lambda: setattr(wall, "name", "Front"))
    assert root.fcn_result.source == "Wall" and wall.hide_get()
