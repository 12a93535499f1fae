# SPDX-License-Identifier: GPL-3.0-or-later
"""The bytes of a file, its numbers, and where in it something is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import InputError


def load(path) -> bytes:
    """All bytes of a file. Raises InputError where it is missing, no file, not readable or empty."""
    path = Path(path)
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except IsADirectoryError:
        raise InputError(f"{path}: this is a folder; give the file in it") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check that you may read it") from None
    if not data.strip():
        raise InputError(f"{path}: the file is empty; export it again")
    return data


def load_lines(path) -> list[bytes]:
    """The lines of a text file; InputError where it holds binary data."""
    data = load(path)
    if b"\0" in data[:65536]:
        raise InputError(f"{path}: this is binary data, not text; check the file's format and its ending")
    return data.splitlines()


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
    try:
        values = np.array(fields, dtype=bytes).astype(np.float64 if dtype is float else np.int64)
    except (ValueError, OverflowError):
        values = None
    if values is None or (dtype is float and not np.isfinite(values).all()):
        _blame(path, rows, numbers, dtype)
    return values


def _blame(path, rows, numbers, dtype):
    for row, number in zip(rows, numbers):
        for field in row.split():
            word = field.decode("latin1")
            try:
                value = dtype(field)
            except (ValueError, OverflowError):
                kind = "a number" if dtype is float else "a whole number"
                raise InputError(f"{path}: line {number}: {word[:40]!r} is not {kind}; correct the line") from None
            if not np.isfinite(float(value)):
                raise InputError(f"{path}: line {number}: {word!r} is not finite; remove the point or correct it")
    raise InputError(f"{path}: a number is too large; scale the scene")
