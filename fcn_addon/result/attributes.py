# SPDX-License-Identifier: GPL-3.0-or-later
"""Support and labels of completed curves as attributes of their geometry, for geometry nodes.

Curve data has no attributes of its own, and occurrences share theirs. A modifier per object stores them, with one node
group for all; it is saved in the file and works without the add-on.
"""

from __future__ import annotations

import bpy

from ..scene.families import within
from .views import ROLE

NAME = "FCN Attributes"
KINDS = {"support": "FLOAT", "component": "INT", "template": "INT", "occurrence": "INT"}
SOCKETS = {"FLOAT": "NodeSocketFloat", "INT": "NodeSocketInt"}


def update(group, _context):
    """Called by Blender when the switch of a result changes."""
    switch(group.id_data, group.attributes)


def switch(root, on):
    """Give all completed curves of a result the modifier, or take it from them.

    Notes
    -----
    O(objects). With it Blender evaluates every object for itself, which takes about twice as long.
    """
    nodes = _nodes() or (_make() if on else None)
    for item in within(root):
        if "support" in item and item.type == "CURVE":
            mine = [m for m in item.modifiers if m.type == "NODES" and m.node_group == nodes]
            if on and not mine:
                _store(item, item.modifiers.new(NAME, "NODES"), nodes)
            elif not on:
                for modifier in mine:
                    item.modifiers.remove(modifier)
    if nodes is not None and nodes.users == 0:
        bpy.data.node_groups.remove(nodes)


def _nodes():
    """The node group, None where the file has none."""
    return next((g for g in bpy.data.node_groups if g.get(ROLE) == "attributes" and g.library is None), None)


def _make():
    """A node group that stores its inputs as attributes of the curves."""
    nodes = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
    nodes[ROLE] = "attributes"
    face = nodes.interface
    face.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    face.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    for name, kind in KINDS.items():
        face.new_socket(name, in_out="INPUT", socket_type=SOCKETS[kind])
    given, wanted = nodes.nodes.new("NodeGroupInput"), nodes.nodes.new("NodeGroupOutput")
    last = given.outputs[0]
    for i, (name, kind) in enumerate(KINDS.items()):
        node = nodes.nodes.new("GeometryNodeStoreNamedAttribute")
        node.data_type, node.domain, node.location = kind, "CURVE", (200 * (i + 1), 0)
        node.inputs["Name"].default_value = name
        value = next(socket for socket in node.inputs if socket.name == "Value" and socket.enabled)
        nodes.links.new(last, node.inputs["Geometry"])
        nodes.links.new(given.outputs[i + 1], value)
        last = node.outputs["Geometry"]
    nodes.links.new(last, wanted.inputs[0])
    wanted.location = (200 * (len(KINDS) + 1), 0)
    return nodes


def _store(item, modifier, nodes):
    modifier.node_group = nodes
    modifier.show_expanded = False
    for socket in nodes.interface.items_tree:
        if socket.name in KINDS:
            if hasattr(modifier, "properties"):  # Blender 5.2
                getattr(modifier.properties.inputs, socket.identifier).value = item[socket.name]
            else:
                modifier[socket.identifier] = item[socket.name]
