# SPDX-License-Identifier: GPL-3.0-or-later
"""Entities of a DXF drawing that are put in later: what is in blocks, and the INSERT of blocks.

ezdxf keeps seven to eight times the text of an entity. So it gets a POINT instead of each run of them, which says to
which block they belong. Their tags are kept, packed, and become entities of ezdxf anew each time a block is put in.
"""

from __future__ import annotations

import marshal
import zlib

PIECE = 4000
"""Tags that are packed at once: some 40 kilobytes of text."""

READY = 100_000
"""Tags whose entities are kept as blocks are put in again and again; they take some 10 MB."""

LINKED = ("VERTEX", "ATTRIB", "SEQEND")
"""What follows an entity and is of it."""


class Damage(Exception):
    """What is held is no entity."""


class Held:
    """Takes entities out of the tags of a drawing, and puts them back where it has been read."""

    def __init__(self):
        self._runs, self._open, self._place, self.room = {}, None, None, READY

    def take(self, tags, place=()):
        """Take an entity of compiled tags; yield what ezdxf gets.

        place : (owner, whether it is of paper space) where it is not in a block; None is the place of the one before
        """
        if self._open is None or place not in (None, self._place):
            self.end()
            name = f"held {len(self._runs)}"
            self._open = self._runs[name] = Run(self)
            self._place = place
            yield from _point(name, _first(tags, 5), *(place or ()))
        self._open.add(tags)

    def end(self, *, whole=True):
        """What comes next is of another run. whole : a POLYLINE must not be open"""
        if self._open is not None:
            self._open.end(whole)
        self._open = None

    def put_back(self, drawing):
        """Let the blocks of a drawing hold what was taken; asking them raises Damage where an entity has any."""
        for record in drawing.block_records:
            space = record.entity_space
            parts = [self._runs.get(e.dxf.get("layer")) if e.dxftype() == "POINT" else None for e in space.entities]
            if any(parts):
                space.entities = Contents(run or e for run, e in zip(parts, space.entities))
        for run in self._runs.values():
            run.drawing = drawing

    def check(self):
        """Raise Damage where an entity has any, though it may be in no block that is put in."""
        for run in self._runs.values():
            run.check()


class Contents:
    """What is in a block: entities, and runs of them that become entities when they are asked for."""

    def __init__(self, parts):
        self._parts = list(parts)

    def __len__(self):
        return sum(part.count if isinstance(part, Run) else 1 for part in self._parts)

    def __iter__(self):
        for part in self._parts:
            if isinstance(part, Run):
                yield from part
            else:
                yield part


class Run:
    """Entities that follow each other, as packed tags.

    count : how many, but for what is linked to one
    """

    def __init__(self, held):
        self._held, self.drawing, self._whole = held, None, False
        self._pieces, self._tags, self._loose = [], 0, []  # the last are entities that are not packed yet
        self._size, self._made, self._asked, self._sound = 0, None, False, False
        self.count = 0

    def add(self, tags):
        """Add an entity."""
        self.count += tags[0].value not in LINKED
        self._loose.append([x for tag in tags for x in (tag.code, tag.value)])
        self._tags += len(tags)
        self._size += len(tags)
        if self._tags >= PIECE:
            self._pack()

    def end(self, whole):
        """There are no more."""
        self._whole = whole
        self._pack()

    def _pack(self):
        if self._loose:
            self._pieces.append(zlib.compress(marshal.dumps(self._loose), 1))
        self._loose, self._tags = [], 0

    def check(self):
        """Load all entities, if they never were."""
        if not self._sound:
            for _ in self._entities():
                pass

    def __iter__(self):
        if self._made is None and self._asked and self._size <= self._held.room:
            self._held.room -= self._size
            self._made = list(self._entities())
        self._asked = True
        return self._entities() if self._made is None else iter(self._made)

    def _entities(self):
        """Yield the entities, with what is linked to them."""
        from ezdxf.entities import factory
        from ezdxf.entities.subentity import entity_linker

        link, last = entity_linker(), None
        try:
            for entity in self._loaded():
                if not link(entity):
                    if last is not None:
                        yield last
                    last = entity
            # Only one that waits for its end takes a SEQEND.
            if self._whole and last.dxftype() in ("POLYLINE", "INSERT") and link(factory.new("SEQEND")):
                raise Damage(f"{last.dxftype()} without SEQEND")
        except Exception as error:  # ezdxf raises whatever the damage leads to
            raise Damage(str(error)) from None
        yield last
        self._sound = True

    def _loaded(self):
        """Yield what the tags are, as ezdxf does when it reads a drawing."""
        from ezdxf.lldxf.types import is_valid_handle

        database = self.drawing.entitydb
        for piece in self._pieces:
            for values in marshal.loads(zlib.decompress(piece)):
                entity = loaded(_tags(values), self.drawing)
                if entity.dxf.handle is None:
                    entity.dxf.handle = database.next_handle()
                elif entity.dxf.handle == "0" or not is_valid_handle(entity.dxf.handle):
                    raise ValueError(f"Invalid handle {entity.dxf.handle}.")
                entity.post_load_hook(self.drawing)
                yield entity


def compiled(tags) -> list:
    """Tags of an entity, with numbers for words and points for their coordinates."""
    from ezdxf.lldxf.tagger import tag_compiler
    from ezdxf.lldxf.types import DXFTag

    # A point in a plane ends where the next tag is no z: without one it would be lost.
    return list(tag_compiler(iter([*tags, DXFTag(0, "EOF")])))[:-1]


def loaded(tags, drawing=None):
    """The entity of compiled tags."""
    from ezdxf.entities import factory
    from ezdxf.lldxf.extendedtags import ExtendedTags

    return factory.load(ExtendedTags(tags), drawing)


def place_of(tags):
    """The owner of an entity, None where it has none, and whether it is of paper space."""
    paper = any(tag.code == 67 and tag.value for tag in tags)
    return _first(tags, 330), paper


def _first(tags, code):
    """The value of the first tag of a code before any subclass, but for those in braces; None where it is not there."""
    inside = False
    for tag in tags:
        if tag.code == 100:
            return None
        if tag.code == 102:
            inside = tag.value.startswith("{")
        elif tag.code == code and not inside:
            return tag.value
    return None


def _point(name, handle, owner=None, paper=False):
    """The tags of a POINT that stands for a run."""
    from ezdxf.lldxf.types import DXFTag

    values = (0, "POINT"), (5, handle), (330, owner), (67, int(paper) or None), (8, name)
    return [DXFTag(code, value) for code, value in values if value is not None]


def _tags(values) -> list:
    """Tags of codes and values, in turn."""
    from ezdxf.lldxf.types import DXFBinaryTag, DXFTag, DXFVertex

    kinds: dict[type, type] = {tuple: DXFVertex, bytes: DXFBinaryTag}
    turns = iter(values)
    return [kinds.get(type(value), DXFTag)(code, value) for code, value in zip(turns, turns)]
