# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of a result look at."""

import numpy as np


def scene(bpy):
    """The scene, up to date."""
    bpy.context.view_layer.update()
    return bpy.context.scene


def seen(bpy, root):
    """Visible objects of a result, by the kind of collection that they are in."""
    scene(bpy)
    return {c["fcn_role"]: {o.name for o in c.all_objects if o.visible_get()} for c in root.children}


def occurrence(bpy, root, i):
    """The curves of an occurrence, selected, the first one active."""
    objects = [o for o in root.all_objects if o.get("occurrence") == i and "support" in o]
    for item in bpy.context.selected_objects:
        item.select_set(False)
    for item in objects[:1]:
        item.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
    return objects


def parts(root):
    """The completed curves of a result."""
    return [o for o in root.all_objects if "support" in o]


def world(item):
    """(n, 3) points of a dense curve where they are in the scene."""
    points = np.array([p.co[:3] for s in item.data.splines for p in s.points])
    matrix = np.array(item.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def same_points(a, b):
    """Whether two sets of points are one, whatever their order."""
    return len(a) == len(b) and np.allclose(np.array(sorted(np.round(a, 3).tolist())), sorted(np.round(b, 3).tolist()))
