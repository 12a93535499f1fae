# SPDX-License-Identifier: GPL-3.0-or-later
"""Output files that appear all together and whole, or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from ...core.errors import InputError


class Outputs:
    """A context: files are written under a temporary name beside the final one, and moved when it ends well.

    Every name is tried when the context is entered, so that a long run does not end with a folder that is missing.
    """

    def __init__(self, paths, inputs=()):
        self._final = [Path(path) for path in paths]
        self._inputs = {os.path.realpath(path) for path in inputs}
        self._part = {}

    def __enter__(self):
        try:
            for path in self._final:
                self._try(path)
        except BaseException:
            self._remove()
            raise
        return self

    def _try(self, path):
        if path in self._part:
            raise InputError(f"{path}: two outputs have this name; give each its own")
        if os.path.realpath(path) in self._inputs:
            raise InputError(f"{path}: this is also an input; write to another name")
        part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
        try:
            if path.is_dir():
                raise InputError(f"{path}: cannot be written, it is a folder; give a file name")
            part.touch()
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror}); check the folder") from None
        self._part[path] = part

    def part(self, path) -> str:
        """The temporary name to write to."""
        return str(self._part[Path(path)])

    def __exit__(self, kind, error, trace):
        try:
            if kind is None:
                for path, part in list(self._part.items()):
                    self._move(part, path)
            elif isinstance(error, OSError) and (error.errno == errno.ENOSPC or self._is_part(error.filename)):
                names = ", ".join(map(str, self._final))
                raise InputError(
                    f"{names}: cannot be written ({error.strerror}); make room or check the folder"
                ) from None
        finally:
            self._remove()
        return False

    def _is_part(self, name):
        return name is not None and Path(name) in self._part.values()

    def _move(self, part, path):
        try:
            os.replace(part, path)
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror}); check the folder") from None
        del self._part[path]

    def _remove(self):
        for part in self._part.values():
            part.unlink(missing_ok=True)
        self._part.clear()
