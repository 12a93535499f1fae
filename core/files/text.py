# SPDX-License-Identifier: GPL-3.0-or-later
"""The bytes of a file, its numbers, and where in it something is wrong."""

from __future__ import annotations

import codecs
from pathlib import Path

import numpy as np

from ..errors import InputError

LONGEST = 64
"""Characters of a number; longer words are none, and an array of words is as wide as its longest."""

LARGEST = 1e100
"""No coordinate is beyond it: squares of larger ones overflow."""

MARKS = (
    (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF32_LE, "utf-32-le"), (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"),
)  # fmt: skip
"""Byte order marks and what they tell; the longer ones first, as one begins with another."""


def load(path) -> bytes:
    """All bytes of a file. Raises InputError where it is missing, no file, not readable or empty."""
    path = Path(path)
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except IsADirectoryError:
        raise InputError(f"{path}: this is a folder; give the file in it") from None
    except ValueError:
        raise InputError(f"{str(path)!r}: this is no file name; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check that you may read it") from None
    if not data or data.isspace():
        raise InputError(f"{path}: the file is empty; export it again")
    return data


def load_text(path) -> bytes:
    """A text file in UTF-8 without its byte order mark, whatever Unicode it was written in.

    Raises InputError where it holds binary data.
    """
    data = without_mark(load(path)).rstrip(b"\0\x1a")
    if b"\0" in data[:65536]:
        raise InputError(f"{path}: this is binary data, not text; check the file's format and its ending")
    if not data or data.isspace():
        raise InputError(f"{path}: the file is empty; export it again")
    return data


def without_mark(data) -> bytes:
    """Bytes of a file without a byte order mark; where that tells of UTF-16 or UTF-32, as UTF-8."""
    for mark, name in MARKS:
        if data.startswith(mark):
            data = data[len(mark) :]
            return data if name == "utf-8" else data.decode(name, "replace").encode()
    return data


BLOCK = 1 << 18
"""Bytes of text that are cut into words at once: words take ten times the memory of their text."""


def blocks(data, begin=0):
    """The text from a place on, in pieces of about `BLOCK` bytes.

    Each ends with a line, and with what it goes on with after a backslash.
    """
    while begin < len(data):
        end = (data.find(b"\n", begin + BLOCK) + 1) or (data.find(b"\r", begin + BLOCK) + 1)
        while end and data[max(begin, end - 200) : end].rstrip().endswith(b"\\"):
            end = data.find(b"\n", end) + 1
        end = end or len(data)
        yield data[begin:end]
        begin = end


def rows_of(path):
    """Lines of a text file that are neither empty nor begin with #, block by block: lists of them and their numbers.

    Raises InputError where it holds binary data.
    """
    before = 0
    for block in blocks(load_text(path)):
        lines = block.splitlines()
        kept = [i for i, line in enumerate(lines) if line.strip() and not line.lstrip().startswith(b"#")]
        if kept:
            yield [lines[i] for i in kept], [before + i + 1 for i in kept]
        before += len(lines)


def parse_numbers(path, rows, numbers, dtype=float) -> np.ndarray:
    """Parse fields as numbers, and name the line of the first that is none or not finite.

    Parameters
    ----------
    rows : list of bytes, fields separated by white space
    numbers : sequence of int, the line of the file that each row stands in
    dtype : float or int

    Returns
    -------
    (n,) float64 or int64, the fields of all rows one after the other
    """
    fields = b" ".join(rows).split()
    values = numbers_of(fields, dtype)
    if values is None or (dtype is float and not (np.abs(values) <= LARGEST).all()):
        _blame(path, rows, numbers, dtype)
    return values


def numbers_of(fields, dtype=float):
    """(n,) float64 or int64, the words as numbers; None where one is none."""
    if max(map(len, fields), default=0) > LONGEST:
        return None
    try:
        return np.array(fields, dtype=bytes).astype(np.float64 if dtype is float else np.int64)
    except (ValueError, OverflowError):
        return None


def _blame(path, rows, numbers, dtype):
    kind = "a number" if dtype is float else "a whole number"
    for row, number in zip(rows, numbers):
        for field in row.split():
            word = field.decode("latin1")
            try:
                if len(field) > LONGEST:
                    raise ValueError
                value = dtype(field)
            except (ValueError, OverflowError):
                raise InputError(f"{path}: line {number}: {word[:40]!r} is not {kind}; correct the line") from None
            if not np.isfinite(float(value)):
                raise InputError(f"{path}: line {number}: {word!r} is not finite; remove the point or correct it")
            if abs(value) > (LARGEST if dtype is float else 2**63 - 1):
                raise InputError(f"{path}: line {number}: {word} is too large a number; correct the line")
    raise InputError(f"{path}: a number is not as it should be; export the file again")
