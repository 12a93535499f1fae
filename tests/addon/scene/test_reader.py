# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects as curves: types, modifiers, world space, strength, and what is refused."""

import numpy as np
import pytest

LINE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


@pytest.fixture
def read(bpy, part):
    def call(*objects):
        bpy.context.view_layer.update()
        graph = bpy.context.evaluated_depsgraph_get()
        return part("fcn_addon.scene.reader").read_objects(objects, graph)

    return call


def link(bpy, name, data):
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def wire(bpy, points=LINE, edges=((0, 1), (1, 2), (2, 3)), faces=(), name="Wire"):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, edges, faces)
    return link(bpy, name, mesh)


def poly(bpy, points=LINE, cyclic=False, kind="POLY", name="Poly"):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new(kind)
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.c_[points, np.ones(len(points))].ravel())
    spline.use_cyclic_u = cyclic
    return link(bpy, name, data)


def test_an_edge_mesh_in_world_space(bpy, read):
    item = wire(bpy)
    item.location, item.scale, item.rotation_euler = (10, 0, 0), (2, 2, 2), (0, 0, np.pi / 2)
    curves = read(item).reading.curves
    assert np.allclose(curves.points, [[10, 0, 0], [10, 2, 0], [8, 2, 0], [8, 0, 0]], atol=1e-6)


def test_parents_count(bpy, read):
    parent = link(bpy, "Parent", None)
    parent.location = (0, 0, 7)
    item = wire(bpy)
    item.parent = parent
    assert np.allclose(read(item).reading.curves.points[:, 2], 7)


def test_a_poly_curve_and_a_closed_one(bpy, read):
    result = read(poly(bpy), poly(bpy, cyclic=True))
    curves = result.reading.curves
    assert curves.closed.tolist() == [False, True]
    assert np.allclose(curves.curve(0), LINE)
    assert {tuple(p) for p in curves.curve(1).tolist()} == {tuple(map(float, p)) for p in LINE}
    assert result.owner.tolist() == [0, 1]
    assert result.names == ("Poly", "Poly.001")


def test_modifiers_are_evaluated(bpy, read):
    item = wire(bpy)
    array = item.modifiers.new("Array", "ARRAY")
    array.count, array.use_relative_offset, array.use_constant_offset = 3, False, True
    array.constant_offset_displace = (5, 0, 0)
    result = read(item)
    assert result.reading.count == 3
    assert np.allclose(
        sorted(result.reading.curves.points[:, 0]), sorted(np.ravel([[0, 1, 1, 0], [5, 6, 6, 5], [10, 11, 11, 10]]))
    )


def test_bezier_curves_are_as_fine_as_they_are_drawn(bpy, read):
    data = bpy.data.curves.new("Bezier", "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("BEZIER")
    spline.bezier_points.add(1)
    for point, x in zip(spline.bezier_points, (0, 1)):
        point.co, point.handle_left, point.handle_right = (x, 0, 0), (x, -1, 0), (x, 1, 0)
    data.resolution_u = 10
    assert len(read(link(bpy, "Bezier", data)).reading.curves.points) == 11


def test_curvature_is_the_strength_and_scales(bpy, read):
    item = wire(bpy)
    item.data.attributes.new("curvature", "FLOAT", "POINT").data.foreach_set("value", [1, -2, 3, 4])
    item.scale = (2, 2, 2)
    assert np.allclose(read(item).reading.curves.strength, [0.5, 1, 1.5, 2])


def test_hair_curves(bpy, read):
    data = bpy.data.hair_curves.new("Hair")
    if not hasattr(data, "add_curves"):
        pytest.skip("this Blender cannot make hair curves from Python")
    data.add_curves([3, 4])
    points = np.arange(21, dtype=np.float32)
    data.attributes["position"].data.foreach_set("vector", points)
    item = link(bpy, "Hair", data)
    item.location = (0, 0, 100)
    curves = read(item).reading.curves
    assert curves.offsets.tolist() == [0, 3, 7]
    assert np.allclose(curves.points, points.reshape(-1, 3) + [0, 0, 100])


def test_junctions_split_and_every_chain_is_an_input_curve(bpy, read):
    result = read(wire(bpy, edges=((0, 1), (1, 2), (1, 3))), wire(bpy))
    assert result.reading.count == 4
    assert result.owner.tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda bpy: link(bpy, "Empty", None), "of type EMPTY"),
        (lambda bpy: wire(bpy, edges=()), "no edges"),
        (lambda bpy: wire(bpy, edges=(), faces=[(0, 1, 2, 3)]), "surface of 1 faces"),
        (lambda bpy: wire(bpy, points=[(0, 0, 0), (float("nan"), 0, 0)], edges=[(0, 1)]), "vertex 1 is not finite"),
        (lambda bpy: wire(bpy, points=[(1, 1, 1)] * 2, edges=[(0, 1)]), "no curve has two different points"),
    ],
)
def test_what_is_wrong_is_named(bpy, read, part, make, message):
    item = make(bpy)
    with pytest.raises(part("core.errors").InputError) as error:
        read(item)
    assert message in str(error.value) and repr(item.name) in str(error.value)


@pytest.mark.parametrize("kind", ["bevel_depth", "extrude", "bevel_object", "2D"])
def test_a_bevel_does_not_matter(bpy, read, kind):
    item = poly(bpy, cyclic=True)
    if kind == "2D":
        item.data.dimensions = kind
    else:
        setattr(item.data, kind, poly(bpy) if kind == "bevel_object" else 0.1)
    item.location = (0, 0, 3)
    before = len(bpy.data.curves), len(bpy.data.objects)
    curves = read(item).reading.curves
    assert {tuple(p) for p in curves.points.tolist()} == {(x, y, 3.0) for x, y, _ in LINE}
    assert curves.closed.tolist() == [True]
    assert (len(bpy.data.curves), len(bpy.data.objects)) == before


def test_a_bevel_under_a_modifier_is_named(bpy, read, part):
    item = poly(bpy)
    item.data.bevel_depth = 0.1
    item.modifiers.new("Deform", "SIMPLE_DEFORM")
    with pytest.raises(part("core.errors").InputError, match="bevel"):
        read(item)


def test_no_object_at_all(read, part):
    with pytest.raises(part("core.errors").InputError, match="no curves are chosen"):
        read()


def test_the_scene_is_not_changed(bpy, read):
    item = wire(bpy)
    before = len(bpy.data.meshes), len(bpy.data.objects), [tuple(v.co) for v in item.data.vertices]
    read(item)
    assert before == (len(bpy.data.meshes), len(bpy.data.objects), [tuple(v.co) for v in item.data.vertices])
