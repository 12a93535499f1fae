# SPDX-License-Identifier: GPL-3.0-or-later
"""The header of a PLY file, checked whole: its elements, and whether the file has room for what they count."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ..text import load, without_mark

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
    "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float32": "f4", "float64": "f8", "int64": "i8", "uint64": "u8",
}  # fmt: skip
INTEGERS = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "i8": "q", "u8": "Q"}
"""Types that the length of a list may have, and what `struct` calls them."""
_ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class Property:
    """kind : type of its values, as numpy has it; length : type of a list's length, None for one value"""

    name: str
    kind: str
    length: str | None


@dataclass(frozen=True)
class Element:
    """What the header says of an element."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def least_bytes(self, order) -> int:
        """Bytes that a row has at least; of ascii each number with the space behind it."""
        if order is None:
            return 2 * len(self.properties)
        return sum(np.dtype(p.length or p.kind).itemsize for p in self.properties)


def read_header(path) -> list[Element]:
    """The elements that the header names, in their order."""
    return parse_header(path, without_mark(load(path)))[1]


def parse_header(path, data):
    """Byte order (None for ascii), the elements, and where the body begins."""
    head = data[: 1 << 20]
    first = re.match(rb"ply[ \t]*(\r\n|\n|\r)", head, re.IGNORECASE)
    end = first and re.compile(rb"(?:\r|\n)[ \t]*end_header[ \t]*" + first[1], re.IGNORECASE).search(head)
    if not end:
        raise InputError(f"{path}: no PLY header; this is not a PLY file or it was cut off")
    order, elements = False, []
    for number, line in enumerate(head[: end.start()].decode("latin1").split(first[1].decode()), 1):
        words = line.lower().split()
        try:
            match words:
                case [] | ["comment" | "obj_info", *_]:
                    pass
                case ["ply"] if number == 1:
                    pass
                case ["format", name, *_] if order is False:
                    order = _ORDERS[name]
                case ["element", name, count] if name not in (e[0] for e in elements):
                    elements.append((name, _count(count), []))
                case ["property", "list", length, kind, name]:
                    if _TYPES[length] not in INTEGERS:
                        raise ValueError
                    elements[-1][2].append(Property(name, _TYPES[kind], _TYPES[length]))
                case ["property", kind, name]:
                    elements[-1][2].append(Property(name, _TYPES[kind], None))
                case _:
                    raise ValueError
        except (KeyError, ValueError, IndexError):
            raise InputError(f"{path}: line {number}: {line[:60]!r} is not PLY; export it again") from None
    if order is False:
        raise InputError(f"{path}: the header has no `format` line; export it again")
    return order, [Element(name, count, tuple(properties)) for name, count, properties in elements], end.end()


def _count(word) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 19):
        raise ValueError
    return int(word)


def check_counts(path, elements, order, size):
    """Raise InputError where the body, of `size` bytes, has no room for the rows that the header counts."""
    for element in elements:
        least = element.least_bytes(order)
        if element.count * least > size + 1:
            cut_off(path, element, size // least)
        size = max(size - element.count * least, 0)


def cut_off(path, element, found):
    """Raise InputError for an element that ends too soon."""
    raise InputError(
        f"{path}: the file was cut off, it has {found} of {element.count} rows of `{element.name}`; export it again"
    )
