# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of a scene is what Blender shows: instances, modifiers, nodes, strokes. What is left out is named."""

import numpy as np
import pytest

LINE = [(0, 0, 0), (1, 0, 0), (1, 0, 1)]


def firsts(reading):
    """Where the curves begin, x and rounded."""
    return sorted(round(float(reading.curves.curve(i)[:, 0].min()), 4) for i in range(len(reading.curves)))


def length(reading):
    """The length of all curves."""
    curves, total = reading.curves, 0.0
    for i, closed in enumerate(curves.closed):
        points = curves.curve(i)
        total += np.linalg.norm(np.diff(np.r_[points, points[:1]] if closed else points, axis=0), axis=1).sum()
    return total


def left(found):
    return dict(found.left_out.objects)


def count(bpy):
    kinds = ("objects", "meshes", "curves", "hair_curves", "scenes", "collections", "node_groups")
    return [len(getattr(bpy.data, kind)) for kind in kinds]


def test_collection_instances_and_what_they_instance(bpy, read, link, mesh, instance):
    home = bpy.data.collections.new("Window")
    bpy.context.scene.collection.children.link(home)
    link("Window", mesh(), home)
    for i in (1, 2):
        instance(home, (5 * i, 0, 0))
    found = read()
    assert firsts(found.reading) == [0, 5, 10]
    assert [found.names[i] for i in found.owner] == ["Window", "Instance", "Instance.001"]


def test_instances_alone_nested_mirrored_and_sheared(bpy, read, link, mesh, instance):
    home, outer = bpy.data.collections.new("Window"), bpy.data.collections.new("Bay")
    link("Window", mesh(), home)  # shown nowhere itself
    inner = bpy.data.objects.new("Inner", None)
    outer.objects.link(inner)
    inner.instance_type, inner.instance_collection, inner.location = "COLLECTION", home, (1, 0, 0)
    first, mirrored = instance(outer, (10, 0, 0)), instance(outer, (20, 0, 0))
    mirrored.scale = (-1, 1, 1)
    parent = link("Parent", None)
    parent.scale = (1, 1, 2)
    sheared = instance(home, (0, 0, 0))
    sheared.parent, sheared.rotation_euler = parent, (0, np.pi / 4, 0)
    assert np.allclose(read(first).reading.curves.points, np.add(LINE, (11, 0, 0)))
    assert np.allclose(read(mirrored).reading.curves.points, np.multiply(LINE, (-1, 1, 1)) + (19, 0, 0))
    half = np.sqrt(0.5)  # turned by 45 degrees, then stretched along z: the right angle is none any more
    expected = [(0, 0, 0), (half, 0, -2 * half), (2 * half, 0, 0)]
    assert np.allclose(read(sheared).reading.curves.points, expected, atol=1e-6)


def test_scans_turn_their_faces_outwards_under_a_mirror_and_an_object_is_one_scan(
    bpy, part, read, link, mesh, instance
):
    home = bpy.data.collections.new("Bay")
    for i in range(2):
        link("Bay", mesh([(0, 0, i), (1, 0, i), (0, 1, i)], (), [(0, 1, 2)]), home)
    item = instance(home, (3, 0, 0))
    item.scale = (-1, 1, 1)
    points, triangles = read(item).surfaces[0]
    assert len(triangles) == 2 and np.isclose(points[:, 0].min(), 2)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()
    assert part("fcn_addon.reading.edge_length").mean_edge_length(
        item, bpy.context.evaluated_depsgraph_get()
    ) == pytest.approx((2 + np.sqrt(2)) / 3)


def test_shared_data_is_read_at_each_place(read, link, mesh):
    data = mesh()
    for i in range(3):
        link("Window", data).location.x = i
    assert firsts(read().reading) == [0, 1, 2]


def test_instances_on_vertices_hide_what_they_stand_on(read, link, mesh):
    host = link("Host", mesh([(0, 0, 0), (7, 0, 0)], [(0, 1)]))
    child = link("Child", mesh())
    child.parent, host.instance_type, host.show_instancer_for_viewport = host, "VERTS", False
    found = read(host)
    assert firsts(found.reading) == [0, 7] and set(found.owner) == {0}


@pytest.mark.parametrize("realize", [False, True])
def test_instances_of_geometry_nodes(read, link, mesh, nodes, realize):
    source = link("Window", mesh())
    source.hide_viewport = True
    host = link("Host", mesh([(0, 0, 0), (3, 0, 0)], ()))

    def settings(group, node):
        if node.bl_idname == "GeometryNodeInstanceOnPoints":
            info = group.nodes.new("GeometryNodeObjectInfo")
            info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = source, True
            group.links.new(info.outputs["Geometry"], node.inputs["Instance"])

    steps = [("InstanceOnPoints", "Points", "Instances"), ("RealizeInstances", "Geometry", "Geometry")]
    nodes(host, *steps[: 1 + realize], settings=settings)
    found = read()
    assert firsts(found.reading) == [0, 3]
    assert left(found) == {"Window": "hidden"}


@pytest.mark.parametrize("kind", ["mesh", "curve"])
def test_curves_that_geometry_nodes_make(bpy, read, link, mesh, nodes, kind):
    data = mesh(((0, 0, 0), (1, 0, 0)), ()) if kind == "mesh" else bpy.data.curves.new("Curve", "CURVE")
    item = link("Host", data)
    item.location.x = 5
    nodes(item, ("CurvePrimitiveCircle", None, "Curve"))
    before = count(bpy)
    found = read()
    assert length(found.reading) == pytest.approx(2 * np.pi, rel=0.01)
    assert firsts(found.reading) == [4]
    assert count(bpy) == before


def test_instances_of_curves_that_geometry_nodes_make(read, link, mesh, nodes):
    item = link("Host", mesh(((0, 0, 0), (7, 0, 0)), ()))

    def settings(group, node):
        circle = group.nodes.new("GeometryNodeCurvePrimitiveCircle")
        group.links.new(circle.outputs["Curve"], node.inputs["Instance"])

    nodes(item, ("InstanceOnPoints", "Points", "Instances"), settings=settings)
    assert firsts(read().reading) == [-1, 6]


def test_a_surface_that_only_a_modifier_makes_and_wires_that_only_a_modifier_leaves(bpy, read, link, mesh, nodes):
    swept = link("Cornice", mesh())
    screw = swept.modifiers.new("Screw", "SCREW")
    screw.angle, screw.screw_offset, screw.axis, screw.steps = 0, 5, "Y", 4
    found = read(swept)
    assert found.reading is None and len(found.surfaces[0][1]) == 2 * 2 * 4
    edges = link("Edges", mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], (), [(0, 1, 2)]))

    def settings(group, node):
        if node.bl_idname == "GeometryNodeDeleteGeometry":
            node.domain, node.mode = "FACE", "ONLY_FACE"

    nodes(edges, ("DeleteGeometry", "Geometry", "Geometry"), settings=settings)
    found = read(edges)
    assert not found.surfaces and length(found.reading) == pytest.approx(2 + np.sqrt(2))


def test_faces_beside_loose_edges(read, link, mesh):
    points = [*LINE, (5, 0, 0), (6, 0, 0), (5, 1, 0)]
    link("Both", mesh(points, [(0, 1), (1, 2)], [(3, 4, 5)]))
    found = read()
    assert found.reading is None and len(found.surfaces[0][1]) == 1
    assert left(found) == {"Both": "loose edges beside faces"}
    found = read(take_edges=True)
    assert not found.surfaces and np.allclose(found.reading.curves.points, LINE)
    assert left(found) == {"Both": "faces beside loose edges"}


def test_hair_curves_of_each_type_are_as_they_are_drawn(bpy, read, link):
    """Lengths of circles through four and eight points, as Blender draws them; straight from point to point is less."""
    data = bpy.data.hair_curves.new("Round")
    if not hasattr(data, "set_types"):
        pytest.skip("this Blender cannot make curves of a type from Python")
    angle = np.arange(8) * np.pi / 4
    circle = np.c_[np.cos(angle), np.zeros(8), np.sin(angle)]
    data.add_curves([8])
    data.attributes["position"].data.foreach_set("vector", circle.astype(np.float32).ravel())
    data.attributes.new("cyclic", "BOOLEAN", "CURVE").data.foreach_set("value", [True])
    link("Round", data)
    before = count(bpy)
    lengths = {}
    for kind in ("POLY", "CATMULL_ROM", "NURBS"):
        data.set_types(type=kind)
        data.update_tag()
        found = read()
        assert found.reading.curves.closed.tolist() == [True]
        lengths[kind] = length(found.reading)
    assert lengths["POLY"] == pytest.approx(16 * np.sin(np.pi / 8), rel=1e-5)
    assert lengths["CATMULL_ROM"] == pytest.approx(2 * np.pi, rel=0.01)
    assert lengths["NURBS"] < lengths["POLY"]  # within its control points
    assert count(bpy) == before
    quiet = read(quiet=True)
    assert length(quiet.reading) == pytest.approx(lengths["POLY"], rel=1e-5)


def make_pencil(bpy, link):
    """Two strokes on a shifted layer, one closed; a hidden layer; the object is moved."""
    square = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
    old = bpy.app.version < (4, 3, 0)
    store = bpy.data.grease_pencils if old or bpy.app.version >= (5, 0, 0) else bpy.data.grease_pencils_v3
    data = store.new("Lines")
    for name, strokes in (("Shown", (square, LINE)), ("Hidden", (square,))):
        layer = data.layers.new(name)
        if old:
            frame = layer.frames.new(1)
            for points in strokes:
                stroke = frame.strokes.new()
                stroke.points.add(len(points))
                stroke.points.foreach_set("co", np.ravel(points))
            frame.strokes[0].use_cyclic = True
            layer.location.z = 5
        else:
            drawing = layer.frames.new(1).drawing
            drawing.add_strokes([len(points) for points in strokes])
            for stroke, points in zip(drawing.strokes, strokes):
                for point, at in zip(stroke.points, points):
                    point.position = at
            drawing.strokes[0].cyclic = True
            layer.translation.z = 5
        layer.hide = name == "Hidden"
    item = link("Lines", data)
    item.location.x = 10
    return item


def test_grease_pencil(bpy, read, link):
    make_pencil(bpy, link)
    curves = read().reading.curves
    assert curves.closed.tolist() == [True, False]
    assert np.allclose(curves.curve(1), np.add(LINE, (10, 0, 5)))
    assert np.allclose(curves.curve(0).min(axis=0), (10, 0, 5))


def test_grease_pencil_under_a_modifier(bpy, read, link):
    item = make_pencil(bpy, link)
    if bpy.app.version < (4, 3, 0):
        mirror = item.grease_pencil_modifiers.new("Mirror", "GP_MIRROR")
    else:
        mirror = item.modifiers.new("Mirror", "GREASE_PENCIL_MIRROR")
    mirror.use_axis_x = True
    assert firsts(read().reading) == [9, 9, 10, 10]


def test_what_is_left_out_is_named_with_its_reason(bpy, read, link, mesh):
    link("Row", mesh())
    for how in ("eye", "monitor", "excluded", "in a hidden collection"):
        item = link(how, mesh())
        if how == "monitor":
            item.hide_viewport = True
        if how not in ("eye", "monitor"):
            home = bpy.data.collections.new(how)
            bpy.context.scene.collection.children.link(home)
            home.objects.link(item)
            bpy.context.scene.collection.objects.unlink(item)
            layer = bpy.context.view_layer.layer_collection.children[how]
            layer.exclude = how == "excluded"
            layer.hide_viewport = how != "excluded"
    text = bpy.data.curves.new("Text", "FONT")
    text.body = "Hi"
    link("Text", text)
    link("Sun", bpy.data.lights.new("Sun", "SUN"))
    link("Cloud", bpy.data.pointclouds.new("Cloud"))
    link("Points", mesh(edges=()))
    link("Same", mesh([(1, 1, 1)] * 2, [(0, 1)]))
    bpy.context.view_layer.update()
    bpy.data.objects["eye"].hide_set(True)
    found = read()
    assert len(found.reading.curves) == 1
    hidden = dict.fromkeys(("eye", "monitor", "excluded", "in a hidden collection"), "hidden")
    assert left(found) == {
        **hidden, "Text": "text", "Sun": "without geometry", "Cloud": "point cloud",
        "Points": "without edges and faces", "Same": "with edges of no length",
    }  # fmt: skip
    line = found.left_out.line()
    assert line.startswith("left out: ") and "4 hidden (" in line and "--hidden takes what is hidden" in line
    assert "1 text ('Text')" in line and "convert text to curves" in line
    assert len(found.left_out.rows()) == len(found.left_out) == 9
