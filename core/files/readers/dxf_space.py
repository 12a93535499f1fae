# SPDX-License-Identifier: GPL-3.0-or-later
"""The entities of a DXF drawing as it is read, one after the other, so that most of them are not kept.

ezdxf keeps seven to eight times the size of the file for what is drawn. So what the section ENTITIES holds becomes
points while the drawing is read. What is in blocks, and the INSERT of blocks, is held until all blocks are known.
ezdxf gets the rest.
"""

from __future__ import annotations

from array import array
from collections import Counter

import numpy as np

from .dxf_held import Held, compiled, loaded, place_of

CURVES = ("LINE", "POLYLINE", "LWPOLYLINE", "SPLINE", "ARC", "CIRCLE", "ELLIPSE")
"""Entities that are read; INSERT stands for those of its block."""

SAGITTA = 5e-4
"""How far a chord may lie off its arc, as a share of the size of the entity."""

PUT_IN = ("INSERT", "ATTRIB")
"""What is held of the section ENTITIES: blocks are put in when all are known."""

FRAME = ("SECTION", "ENDSEC", "EOF")
"""What ezdxf gets, and of blocks their begins and ends."""

PARTS = ("VERTEX", "SEQEND")
"""What follows a POLYLINE, or an INSERT, and is of it."""


class Lines:
    """Polylines, as numbers: some 24 bytes a point.

    points : x, y, z of all, one after the other; sizes : how many points each has; where : what stands for its place
    """

    def __init__(self):
        self.points, self.sizes, self.where = array("d"), array("q"), array("l")

    def add(self, points, where=-1):
        """Add one of points (k, 3)."""
        if len(points) > 1:
            self.points.frombytes(np.ascontiguousarray(points, np.float64).tobytes())
            self.sizes.append(len(points))
            self.where.append(where)

    def without(self, places) -> Lines:
        """Those that are not at these places; itself where all are kept."""
        if not places or not self.sizes:
            return self
        kept = ~np.isin(np.frombuffer(self.where, np.dtype("l")), list(places))
        if kept.all():
            return self
        points, offsets = self.arrays()
        out = Lines()
        for i in np.flatnonzero(kept):
            out.add(points[offsets[i] : offsets[i + 1]])
        return out

    def arrays(self):
        """(n, 3) float64 and the offsets, (m + 1,) int64."""
        points = np.frombuffer(self.points, np.float64).reshape(-1, 3) if self.points else np.zeros((0, 3))
        return points, np.r_[0, np.cumsum(np.frombuffer(self.sizes, np.int64))] if self.sizes else np.zeros(1, np.int64)


class Space:
    """Takes what is drawn out of the tags of a drawing; give what `passed_on` yields to ezdxf.

    lines : Lines, whose `where` is an index into `places`
    places : (type, layer, owner, whether it is of paper space, whether it is invisible) -> its index
    most : how many points there may be
    others : Counter of what is no line, by the index of its place
    held : what is to be put back into the drawing when it has been read
    """

    def __init__(self, most):
        self.lines, self.places, self.others, self.held = Lines(), {}, Counter(), Held()
        self.most, self._open, self._attributes = most, [], False

    def passed_on(self, tags):
        """Yield the tags but for what is drawn. Raises OverflowError where there are too many points."""
        take, entity = None, []
        for tag in tags:
            if take is None:
                yield tag
                if entity and tag.code == 2:
                    take = {"ENTITIES": self._entity, "BLOCKS": self._in_block}.get(tag.value)
                entity = [tag] if tag.code == 0 and tag.value == "SECTION" else []
                continue
            if tag.code == 0:
                yield from take(entity)
                entity = []
                if tag.value == "ENDSEC":
                    self._close()
                    self.held.end(whole=False)
                    take = None
                    yield tag
                    continue
            entity.append(tag)
        yield from entity  # the file was cut off

    def _in_block(self, tags):
        """Hold one entity of the section BLOCKS, or yield its tags."""
        if not tags or tags[0].code != 0 or tags[0].value in (*FRAME, "BLOCK", "ENDBLK"):
            self.held.end()
            yield from tags
        else:
            yield from self.held.take(compiled(tags))

    def _entity(self, tags):
        """Take one entity, or yield its tags."""
        name = tags[0].value if tags else ""
        if self._open and name in PARTS:
            self._open.append(tags)
            return
        self._close()
        if name == "POLYLINE":
            self._open = [tags]
        elif name in CURVES:
            self._draw(_linked([tags]))
        elif name in FRAME or tags and tags[0].code != 0:
            self.held.end()
            yield from tags
        elif name in (*PUT_IN, *PARTS):
            yield from self._put_in(name, compiled(tags))
        elif tags:
            self.others[self._place(_linked([tags]))] += 1

    def _put_in(self, name, tags):
        """Hold an INSERT, or what follows it."""
        yield from self.held.take(tags, None if self._attributes else place_of(tags))
        if self._attributes:
            self._attributes = name != "SEQEND"
        else:
            self._attributes = name == "INSERT" and any(tag.code == 66 and tag.value for tag in tags)

    def _close(self):
        """Take the POLYLINE whose vertices came until now."""
        if self._open:
            parts, self._open = self._open, []
            self._draw(_linked(parts))

    def _draw(self, entity):
        place = self._place(entity)
        if is_curve(entity):
            self.lines.add(points_of(entity), place)
        else:
            self.others[place] += 1
        if len(self.lines.points) > 3 * self.most:
            raise OverflowError

    def _place(self, entity) -> int:
        dxf = entity.dxf
        flags = bool(dxf.get("paperspace", 0)), bool(dxf.get("invisible", 0))
        key = entity.dxftype(), dxf.get("layer", "0"), dxf.get("owner"), *flags
        return self.places.setdefault(key, len(self.places))


def _linked(parts):
    """The entity of these tags, with its vertices."""
    from ezdxf.entities.subentity import entity_linker

    link = entity_linker()
    made = [loaded(compiled(tags)) for tags in parts]
    for one in made:
        link(one)
    return made[0]


def is_curve(entity) -> bool:
    """Whether an entity is a line that is read; a POLYLINE may be a mesh."""
    name = entity.dxftype()
    return name in CURVES and (name != "POLYLINE" or entity.is_2d_polyline or entity.is_3d_polyline)


def points_of(entity) -> np.ndarray:
    """(k, 3) float64, an entity as a polyline in world coordinates; a closed one repeats its first point."""
    from ezdxf.path import make_path

    if entity.dxftype() == "LINE":
        return np.array([entity.dxf.start.xyz, entity.dxf.end.xyz])
    path = make_path(entity)
    corners = np.array([p.xyz for p in path.control_vertices()]).reshape(-1, 3)
    if not path.has_curves or not len(corners):
        return corners
    size = float(np.ptp(corners, axis=0).max())
    if not np.isfinite(size):
        return corners
    return np.array([p.xyz for p in path.flattening(max(SAGITTA * size, 1e-300), segments=4)])
