# SPDX-License-Identifier: GPL-3.0-or-later
"""Datablocks by name and number, which survive undo; references do not."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Identity:
    """A datablock by name and by the number that Blender gives it for a session; it survives renaming and undo."""

    name: str
    uid: int

    @classmethod
    def of(cls, item):
        return cls(item.name, item.session_uid)

    def find(self, items):
        """The datablock, None if it has gone."""
        item = items.get(self.name)
        if item is not None and item.session_uid == self.uid:
            return item
        return next((item for item in items if item.session_uid == self.uid), None)
