# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to read, made in the open scene."""

import numpy as np
import pytest

LINE = [(0, 0, 0), (1, 0, 0), (1, 0, 1)]


@pytest.fixture
def link(bpy):
    """Puts data into the scene, or into a collection, as an object."""

    def call(name, data, home=None):
        item = bpy.data.objects.new(name, data)
        (home or bpy.context.scene.collection).objects.link(item)
        return item

    return call


@pytest.fixture
def mesh(bpy):
    """Makes a mesh."""

    def call(points=LINE, edges=((0, 1), (1, 2)), faces=(), name="Mesh"):
        data = bpy.data.meshes.new(name)
        data.from_pydata(points, edges, faces)
        return data

    return call


@pytest.fixture
def instance(bpy, link):
    """Makes an empty that instances a collection."""

    def call(collection, location, name="Instance"):
        item = link(name, None)
        item.instance_type, item.instance_collection, item.location = "COLLECTION", collection, location
        return item

    return call


@pytest.fixture
def nodes(bpy):
    """Gives an object geometry nodes: kinds one after the other, with the entry and the exit of each."""

    def call(item, *steps, settings=None):
        group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
        for way in ("INPUT", "OUTPUT"):
            group.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
        last = group.nodes.new("NodeGroupInput").outputs[0]
        for kind, entry, leave in steps:
            node = group.nodes.new(f"GeometryNode{kind}")
            if entry is not None:
                group.links.new(last, node.inputs[entry])
            if settings:
                settings(group, node)
            last = node.outputs[leave]
        group.links.new(last, group.nodes.new("NodeGroupOutput").inputs[0])
        item.modifiers.new("Nodes", "NODES").node_group = group
        return group

    return call


@pytest.fixture
def read(bpy, part):
    """Reads objects, all of the scene by default."""

    def call(*objects, **options):
        bpy.context.view_layer.update()
        objects = objects or list(bpy.context.scene.objects)
        return part("fcn_addon.reading.reader").read(objects, bpy.context.evaluated_depsgraph_get(), **options)

    return call


def length(reading):
    """The length of all curves of a Reading."""
    total = 0.0
    for i, closed in enumerate(reading.curves.closed):
        points = reading.curves.curve(i)
        total += np.linalg.norm(np.diff(np.r_[points, points[:1]] if closed else points, axis=0), axis=1).sum()
    return total
