# SPDX-License-Identifier: GPL-3.0-or-later
"""The elements of a PLY file as arrays, ascii and binary of both byte orders.

Names are in lower case. A property that is there twice counts once, its first values. The header is checked whole, and
its counts against the size of the file, before anything of that size is made.
"""

from __future__ import annotations

import re
import warnings
from array import array
from dataclasses import dataclass
from struct import Struct

import numpy as np

from ...errors import InputError
from ..text import blocks, load, without_mark
from .ply_header import INTEGERS, Property, check_counts, cut_off, parse_header


@dataclass(frozen=True)
class Lists:
    """The list of row i is ``values.ravel()[offsets[i]:offsets[i + 1]]``.

    values : (k,) array, or (n, c) where all lists are of one length
    offsets : (n + 1,) int64
    """

    values: np.ndarray
    offsets: np.ndarray


def read_elements(path) -> dict:
    """Element name -> property name -> (n,) array, or Lists."""
    data = without_mark(load(path))
    order, elements, begin = parse_header(path, data)
    check_counts(path, elements, order, len(data) - begin)
    read: _Ascii | _Binary
    read = _Ascii(path, data, begin) if order is None else _Binary(path, memoryview(data)[begin:], order)
    del data
    found = {element.name: read.element(element) if element.properties else {} for element in elements}
    read.check_end()
    return found


class _Ascii:
    """Numbers one after the other, wherever their lines end."""

    def __init__(self, path, data, begin):
        values = array("d")
        for body in blocks(data, begin):
            values.frombytes(self._numbers(path, body).tobytes())
        self._values = np.frombuffer(values, np.float64) if values else np.zeros(0)
        self._path, self._at = path, 0

    def _numbers(self, path, body) -> np.ndarray:
        if re.search(rb"(?:^|[\r\n])[ \t]*(?:comment|obj_info)\b", body):
            body = re.sub(rb"(?:(?<=[\r\n])|\A)[ \t]*(?:comment|obj_info)\b[^\r\n]*", b"", body)
        if not body or body.isspace():
            return np.zeros(0)
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            try:
                return np.fromstring(body.replace(b"\0", b"?"), np.float64, sep=" ")
            except (DeprecationWarning, ValueError):
                self._blame(path, body)

    @staticmethod
    def _blame(path, body):
        for word in body.split():
            try:
                float(word)
            except ValueError:
                shown = word[:40].decode("latin1")
                raise InputError(f"{path}: {shown!r} in the body is not a number; export it again") from None
        raise InputError(f"{path}: the body does not hold numbers alone; export it again")

    def element(self, element) -> dict:
        width, left = len(element.properties), len(self._values) - self._at
        if not any(p.length for p in element.properties):
            if element.count * width > left:
                cut_off(self._path, element, left // width)
            table = self._values[self._at : self._at + element.count * width].reshape(element.count, width)
            self._at += element.count * width
            return {p.name: table[:, i] for i, p in reversed(list(enumerate(element.properties)))}
        if width == 1 and (even := self._even(element, left)) is not None:
            return {element.properties[0].name: even}
        starts, counts = self._walk(element)
        out = {}
        for i, p in reversed(list(enumerate(element.properties))):
            start, count = starts[i::width], counts[i::width]
            offsets = np.r_[0, np.cumsum(count)]
            at = np.arange(offsets[-1]) + np.repeat(start - offsets[:-1], count)
            out[p.name] = Lists(self._values[at], offsets) if p.length else self._values[at]
        return out

    def _even(self, element, left) -> Lists | None:
        """The lists of an element that has nothing else, where all are of one length; None where they are not."""
        size = self._values[self._at] if left and element.count else -1.0
        if not (0 <= size < left and size == int(size)) or element.count * (int(size) + 1) > left:
            return None
        size = int(size)
        table = self._values[self._at : self._at + element.count * (size + 1)].reshape(element.count, size + 1)
        if (table[:, 0] != size).any():
            return None
        self._at += table.size
        return Lists(table[:, 1:], np.arange(element.count + 1) * size)

    def check_end(self):
        """Raise InputError for numbers that belong to no row: then a row is too long, and all behind it are wrong."""
        if self._at < len(self._values):
            raise InputError(
                f"{self._path}: {len(self._values) - self._at} numbers more than its header tells of; export it again"
            )

    def _walk(self, element):
        """Where the values of each property of each row begin, and how many there are."""
        starts, counts, at, size = array("q"), array("q"), self._at, len(self._values)
        lists = [bool(p.length) for p in element.properties]
        values = self._values
        for row in range(element.count):
            for has_length in lists:
                count = 1
                if has_length:
                    if at >= size:
                        cut_off(self._path, element, row)
                    count = _length(self._path, element, row, float(values[at]))
                    at += 1
                if at + count > size:
                    cut_off(self._path, element, row)
                starts.append(at)
                counts.append(count)
                at += count
        self._at = at
        return np.frombuffer(starts, np.int64), np.frombuffer(counts, np.int64)


class _Binary:
    """Rows of bytes; lists of one length have one layout, so that one read takes them all."""

    def __init__(self, path, body, order):
        self._path, self._body, self._order, self._at = path, body, order, 0
        self._bytes = np.frombuffer(body, np.uint8)

    def element(self, element) -> dict:
        if not element.count:
            return {p.name: _empty(p) for p in element.properties}
        return self._even(element) or self._uneven(element)

    def check_end(self):
        """Bytes behind the last element are passed over."""

    def _even(self, element):
        """The element where all its lists are as long as those of the first row, else None."""
        layout, size = [], 0
        for i, p in enumerate(element.properties):
            if p.length is None:
                layout.append((f"v{i}", self._order + p.kind))
            else:
                at, code = self._at + size, Struct(self._order + INTEGERS[p.length])
                if at + code.size > len(self._body):
                    return None
                length = code.unpack_from(self._body, at)[0]
                if not 0 <= length <= len(self._body):
                    return None
                layout += [(f"n{i}", self._order + p.length), (f"v{i}", self._order + p.kind, (length,))]
            size = np.dtype(layout).itemsize
        row = np.dtype(layout)
        if self._at + element.count * row.itemsize > len(self._body):
            return None
        values = np.frombuffer(self._body, row, element.count, self._at)
        lists = [i for i, p in enumerate(element.properties) if p.length]
        if any((values[f"n{i}"] != row[f"v{i}"].shape[0]).any() for i in lists):
            return None
        self._at += element.count * row.itemsize
        out = {}
        for i, p in reversed(list(enumerate(element.properties))):
            column = values[f"v{i}"]
            if p.length:
                offsets = np.arange(element.count + 1) * row[f"v{i}"].shape[0]
                out[p.name] = Lists(column, offsets)
            else:
                out[p.name] = column
        return out

    def _uneven(self, element) -> dict:
        starts, counts = self._walk(element)
        out, width = {}, len(element.properties)
        for i, p in reversed(list(enumerate(element.properties))):
            start, count = starts[i::width], counts[i::width]
            offsets, kind = np.r_[0, np.cumsum(count)], np.dtype(self._order + p.kind)
            at = np.repeat(start - offsets[:-1] * kind.itemsize, count) + np.arange(offsets[-1]) * kind.itemsize
            values = self._bytes[at[:, None] + np.arange(kind.itemsize)].reshape(-1).view(kind)
            out[p.name] = Lists(values, offsets) if p.length else values
        return out

    def _walk(self, element):
        """Where the values of each property of each row begin in the body, and how many there are."""
        kinds = [
            (Struct(self._order + INTEGERS[p.length]) if p.length else None, np.dtype(p.kind).itemsize)
            for p in element.properties
        ]
        starts, counts, at, size = array("q"), array("q"), self._at, len(self._body)
        for row in range(element.count):
            for code, item in kinds:
                count = 1
                if code is not None:
                    if at + code.size > size:
                        cut_off(self._path, element, row)
                    count = _length(self._path, element, row, code.unpack_from(self._body, at)[0])
                    at += code.size
                if at + count * item > size:
                    cut_off(self._path, element, row)
                starts.append(at)
                counts.append(count)
                at += count * item
        self._at = at
        return np.frombuffer(starts, np.int64), np.frombuffer(counts, np.int64)


def _empty(p: Property):
    values = np.zeros(0, p.kind)
    return Lists(values, np.zeros(1, np.int64)) if p.length else values


def _length(path, element, row, value) -> int:
    if not (0 <= value < np.inf and value == int(value)):
        raise InputError(f"{path}: {element.name} {row}: {value:g} is no length of a list; export it again")
    return int(value)
