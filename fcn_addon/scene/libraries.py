# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that a .blend needs and that are not where it looks for them."""

from __future__ import annotations

import os

import bpy

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
    for image in _shaping_images():
        if image.source == "FILE" and image.packed_file is None and not _exists(image.filepath, image.library):
            raise InputError(
                f"the image {image.filepath!r}, which a modifier uses, is missing; put it back, or apply the modifier"
            )


def _exists(path, library=None) -> bool:
    return os.path.exists(bpy.path.abspath(path, library=library))


def _missing(kind):
    """Words for the placeholders that stand for what could not be linked."""
    return [f"{kind.removesuffix('s')} {item.name!r}" for item in getattr(bpy.data, kind) if item.is_missing]


def _shaping_images() -> set:
    """Images that displace a surface, or that geometry nodes read."""
    textures = {m.texture for item in bpy.data.objects for m in item.modifiers if getattr(m, "texture", None)}
    images = {texture.image for texture in textures if texture.type == "IMAGE"}
    for group in bpy.data.node_groups:
        for node in group.nodes if group.bl_idname == "GeometryNodeTree" else ():
            if node.bl_idname == "GeometryNodeImageTexture":
                images.add(node.inputs["Image"].default_value)
            elif node.bl_idname == "GeometryNodeInputImage":
                images.add(node.image)
    return images - {None}
