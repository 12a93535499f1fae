# SPDX-License-Identifier: GPL-3.0-or-later
"""DXF drawings: what is drawn in model space as lines, in world coordinates. ezdxf reads them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import InputError, NoCurves
from ..reading import Reading, lines_of_points
from ..text import LARGEST, load
from .dxf_held import Damage
from .dxf_space import CURVES, Space, is_curve, points_of

MOST = 2_000_000
"""Entities that a drawing may come to when its blocks are put in, and points beside those that it has room for: some
blocks refer to each other endlessly."""

ROOM = 8
"""Bytes of the file that a point takes at least; so all of them come to three times the file in memory."""

BINARY = b"AutoCAD Binary DXF"

EXTERNAL = 4 | 8
"""Flags of a block that is another drawing; nothing of it is in the file."""

DEEPEST = 50
"""Blocks in blocks; more go in a circle."""

DWG = (b"AC1012", b"AC1014", b"AC1015", b"AC1018", b"AC1021", b"AC1024", b"AC1027", b"AC1032")


def require_ezdxf():
    """The module ezdxf. Raises InputError where it is missing, in words that help."""
    try:
        import ezdxf
    except ModuleNotFoundError:
        raise InputError(
            "DXF needs ezdxf: `pip install ezdxf` for the Python that runs this, `python3 build.py --wheels` for a "
            "Blender, or install the extension's zip again"
        ) from None
    return ezdxf


def read_dxf(path) -> Reading:
    """The lines of a drawing's model space, blocks put in; what is hidden or is no line is left out and named.

    Its entities are pieces of curves, which become one by joining: no input curve has a name in the file.
    """
    _check(path)
    try:
        units, lines, left_out = _drawn(path, *_open(path))
    except Damage:
        units, lines, left_out = _drawn(path, *_open(path, mend=True))
    told = ", ".join(f"{count} {name}" for name, count in sorted(left_out.items()))
    if not lines.sizes:
        raise NoCurves(f"{path}: no curves in its model space; {_remedy(told)}")
    points, offsets = lines.arrays()
    with np.errstate(invalid="ignore"):
        inside = points.max() <= LARGEST and points.min() >= -LARGEST  # neither is so where one is NaN
    if not inside:
        wrong = np.flatnonzero(~(np.abs(points) <= LARGEST).all(axis=1))
        raise InputError(f"{path}: {points[wrong[0]]} is not finite or too large; remove the point from the drawing")
    reading = lines_of_points(path, points, None, offsets, named=np.zeros(len(offsets) - 1, bool))
    return replace(reading, left_out=told, units=units)


def _drawn(path, drawing, space):
    """The code of the unit, Lines, and the Counter of what is left out. Raises Damage where it can be mended."""
    try:
        lines, left_out = _shown(drawing, space)
        for entity in _Expansion(path, drawing, left_out).of(drawing.modelspace()):
            lines.add(points_of(entity))
            if len(lines.points) > 3 * space.most:
                raise InputError(f"{path}: over {space.most} points with all blocks put in; simplify the drawing")
        space.held.check()
    except (InputError, Damage):
        space.held.check()
        raise
    except Exception as error:  # ezdxf raises whatever the damage leads to
        space.held.check()
        raise InputError(f"{path}: the drawing is damaged ({_words(error)}); save it again") from None
    return int(drawing.units), lines, left_out


def _remedy(told) -> str:
    """What to do where nothing is left but what is told of."""
    if not told:
        return f"draw {', '.join(CURVES)}"
    if "another drawing" in told:
        remedy = "bind the other drawing into this one"
    else:
        remedy = "show its layers" if "hidden" in told else "explode it to lines"
    return f"left out are {told}; {remedy}"


def _open(path, mend=False):
    """The drawing without what is drawn in it, and the Space that has that.

    A damaged one is given whole, with a Space of nothing: to mend it ezdxf needs all of it.

    mend : it is known to be damaged
    """
    ezdxf = require_ezdxf()
    from ezdxf import recover

    try:
        if not mend:
            return _read(path)
    except OverflowError:
        raise InputError(f"{path}: over {_most(path)} points; simplify the drawing") from None
    except InputError:
        raise
    except Exception:  # whatever the damage leads to; it may be mended
        pass
    try:
        drawing, audit = recover.readfile(path)
    except InputError:
        raise
    except (ezdxf.DXFError, OSError) as error:
        raise InputError(f"{path}: this is no DXF file or it was cut off ({_words(error)}); save it again") from None
    except Exception as error:
        raise InputError(f"{path}: the drawing is damaged ({_words(error)}); save it again") from None
    if audit.has_errors:
        raise InputError(f"{path}: the drawing is damaged ({_words(audit.errors[0].message)}); save it again")
    return drawing, Space(_most(path))


def _most(path) -> int:
    """How many points a drawing may come to."""
    return MOST + Path(path).stat().st_size // ROOM


def _check(path):
    """Raise InputError for what is no DXF file, or was cut off."""
    head, tail = _ends(path)
    if head.startswith(DWG):
        raise InputError(f"{path}: this is a DWG file; save it as DXF")
    if not head.startswith(BINARY) and b"\0" in head:
        raise InputError(f"{path}: this is binary data, not a DXF file; check the file's format and its ending")
    if b"EOF" not in tail.rstrip()[-256:]:
        raise InputError(f"{path}: this is no DXF file or it was cut off, it has no EOF at its end; save it again")


def _ends(path):
    """The first 65536 bytes of a file, and the last 4096."""
    try:
        with open(path, "rb") as file:
            head = file.read(65536)
            file.seek(max(file.seek(0, 2) - 4096, 0))
            tail = file.read()
    except (OSError, ValueError):
        head = tail = b""
    if not head.strip():
        data = load(path)  # says what is wrong
        head, tail = data[:65536], data[-4096:]
    return head, tail


def _read(path):
    from ezdxf.document import Drawing
    from ezdxf.filemanagement import dxf_file_info
    from ezdxf.lldxf.tagger import ascii_tags_loader, binary_tags_loader

    space = Space(_most(path))
    with open(path, "rb") as file:
        binary = file.read(len(BINARY)) == BINARY
    if binary:
        drawing = Drawing.load(space.passed_on(binary_tags_loader(load(path))))
    else:
        with open(path, encoding=dxf_file_info(str(path)).encoding, errors="surrogateescape") as file:
            drawing = Drawing.load(space.passed_on(ascii_tags_loader(file)))
    space.held.put_back(drawing)
    return drawing, space


def _shown(drawing, space):
    """What of a Space is shown in model space as Lines, and the Counter of what is left out."""
    hidden, paper = _hidden(drawing), drawing.block_records.get("*Paper_Space").dxf.handle
    model = drawing.block_records.get("*Model_Space").dxf.handle
    drawn = Counter(space.lines.where)
    left_out, dropped = Counter(), set()
    for (name, layer, owner, is_paper, is_invisible), place in space.places.items():
        if owner == paper or (owner != model and is_paper):
            dropped.add(place)
            continue
        unseen = is_invisible or layer.lower() in hidden
        count = space.others[place] + (drawn[place] if unseen else 0)
        if count:
            left_out[f"hidden {name}" if unseen else name] += count
        if unseen:
            dropped.add(place)
    return space.lines.without(dropped), left_out


def _hidden(drawing) -> set:
    """Names of the layers that are off or frozen, in small letters."""
    return {layer.dxf.name.lower() for layer in drawing.layers if layer.is_off() or layer.is_frozen()}


def _words(error) -> str:
    return " ".join(str(error).split())[:120] or type(error).__name__


class _Expansion:
    """Entities with the blocks put in, as far as they are shown."""

    def __init__(self, path, drawing, left_out):
        self._path, self._left_out, self._count = path, left_out, 0
        self._drawing, self._hidden = drawing, _hidden(drawing)
        self._frozen = {layer.dxf.name.lower() for layer in drawing.layers if layer.is_frozen()}

    def of(self, entities, depth=0, home="0"):
        """Yield the curve entities among these, those of blocks in world coordinates.

        home : the layer of the INSERT that they are of, on which lies what is on layer 0 of its block
        """
        if depth > DEEPEST:
            raise InputError(f"{self._path}: its blocks refer to each other in a circle; save the drawing again")
        for entity in entities:
            self._count += 1
            if self._count > MOST:
                raise InputError(f"{self._path}: over {MOST} entities with all blocks put in; simplify the drawing")
            name, layer = entity.dxftype(), entity.dxf.get("layer", "0").lower()
            layer = home if layer == "0" else layer
            # Off hides what is on the layer, frozen also what an INSERT on it brings from others.
            if entity.dxf.get("invisible", 0) or layer in (self._frozen if name == "INSERT" else self._hidden):
                self._left_out[f"hidden {name}"] += 1
            elif name == "INSERT":
                for one in self._single(entity):
                    inside = one.virtual_entities(skipped_entity_callback=self._skipped)
                    yield from self.of(inside, depth + 1, layer)
            elif is_curve(entity):
                yield entity
            else:
                self._left_out[name] += 1

    def _single(self, entity):
        if entity.mcount > MOST:
            raise InputError(f"{self._path}: an INSERT of {entity.mcount} copies; simplify the drawing")
        block = self._drawing.blocks.get(entity.dxf.get("name", ""))
        if block is None or block.block.dxf.get("flags", 0) & EXTERNAL:
            self._left_out["INSERT of another drawing" if block is not None else "INSERT of no block"] += 1
            return []
        return entity.multi_insert() if entity.mcount > 1 else [entity]

    def _skipped(self, entity, reason):
        self._left_out[entity.dxftype()] += 1
