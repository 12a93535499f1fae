# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a .blend needs and that are not where it looks for them."""

from __future__ import annotations

import os

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ...core.errors import InputError


def require_libraries():
    """Raise InputError where a library, or an image that shapes geometry, cannot be loaded."""
    for library in bpy.data.libraries:
        if library.packed_file is None and not _exists(library.filepath):
            raise InputError(
                f"the library {library.filepath!r} is missing, so what is linked from it is too;"
                " put it back, or remove its links in Blender (Outliner, Blender File)"
            )
    missing = [name for kind in ("objects", "collections", "meshes", "curves") for name in _missing(kind)]
    if missing:
        raise InputError(f"{missing[0]} is linked and no longer in its library; put it back, or remove the link")
    _require_images(_shaping_images(bpy.data.objects, bpy.data.node_groups))


def require_of(objects):
    """Raise InputError where one of these objects, or what it instances, could not be loaded from its library."""
    for item in objects:
        home = item.instance_collection if item.instance_type == "COLLECTION" else None
        for block in (item, item.data, home, *(home.all_objects if home else ())):
            if block is not None and block.is_missing:
                library = block.library.filepath if block.library else ""
                text = rpt_("{name!r} of the library {library!r} is missing; put it back, or choose other objects")
                raise InputError(text.format(name=block.name, library=library))
        _require_images(_shaping_images([item], _groups(item)))


def _require_images(images):
    for image in images:
        if image.source == "FILE" and image.packed_file is None and not _exists(image.filepath, image.library):
            text = rpt_("the image {path!r}, which a modifier uses, is missing; put it back, or apply the modifier")
            raise InputError(text.format(path=image.filepath))


def _groups(item) -> set:
    """The node groups of an object's modifiers, with those inside them."""
    found, left = set(), [m.node_group for m in item.modifiers if m.type == "NODES" and m.node_group]
    while left:
        group = left.pop()
        if group not in found:
            found.add(group)
            left += [node.node_tree for node in group.nodes if getattr(node, "node_tree", None)]
    return found


def _exists(path, library=None) -> bool:
    return os.path.exists(bpy.path.abspath(path, library=library))


def _missing(kind):
    """Words for the placeholders that stand for what could not be linked."""
    return [f"{kind.removesuffix('s')} {item.name!r}" for item in getattr(bpy.data, kind) if item.is_missing]


def _shaping_images(objects, groups) -> set:
    """Images that displace the surfaces of objects, or that geometry nodes of these groups read."""
    textures = {m.texture for item in objects for m in item.modifiers if getattr(m, "texture", None)}
    images = {texture.image for texture in textures if texture.type == "IMAGE"}
    for group in groups:
        for node in group.nodes if group.bl_idname == "GeometryNodeTree" else ():
            if node.bl_idname == "GeometryNodeImageTexture":
                images.add(node.inputs["Image"].default_value)
            elif node.bl_idname == "GeometryNodeInputImage":
                images.add(node.image)
    return images - {None}
