# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a scene is left out, and why."""

from __future__ import annotations

from dataclasses import dataclass

HIDDEN = "hidden"
OWN = "result of an earlier run"
ELSEWHERE = "in another scene"
SCAN = "mesh with faces"
TEXT = "text"
VOLUME = "volume"
CLOUD = "point cloud"
EMPTY = "without edges and faces"
POINTS = "with edges of no length"
OTHER = "without geometry"
LOOSE = "loose edges beside faces"
FACES = "faces beside loose edges"

REMEDIES = {
    HIDDEN: "--hidden takes what is hidden",
    OWN: "--object takes a part of a result",
    ELSEWHERE: "--object takes an object of another scene",
    TEXT: "convert text to curves to take it",
    SCAN: "name a scan with --object to detect its curves",
    LOOSE: "--take-edges takes loose edges",
}
NAMED = 3  # names that a line gives for each reason


@dataclass(frozen=True)
class LeftOut:
    """Objects that are no input: pairs of a name and a reason, in the order in which they were met."""

    objects: tuple[tuple[str, str], ...] = ()

    def __add__(self, other):
        return LeftOut((*self.objects, *other.objects))

    def __len__(self):
        return len(self.objects)

    def without(self, reason) -> LeftOut:
        """All but those with a reason."""
        return LeftOut(tuple(pair for pair in self.objects if pair[1] != reason))

    def groups(self) -> dict[str, list[str]]:
        """Reason -> names."""
        found = {}
        for name, reason in self.objects:
            found.setdefault(reason, []).append(name)
        return found

    def words(self) -> str:
        """How many of what: "2 hidden, 1 text"; empty where nothing is left out."""
        return ", ".join(f"{len(names)} {reason}" for reason, names in self.groups().items())

    def line(self) -> str:
        """A line of the command line, with some names and what to do; empty where nothing is left out."""
        parts, remedies = [], []
        for reason, names in self.groups().items():
            shown = ", ".join(repr(name) for name in names[:NAMED]) + (", ..." if len(names) > NAMED else "")
            parts.append(f"{len(names)} {reason} ({shown})")
            if reason in REMEDIES:
                remedies.append(REMEDIES[reason])
        return "left out: " + "; ".join([", ".join(parts), *remedies]) if parts else ""

    def rows(self) -> list[dict]:
        """For the report."""
        return [{"object": name, "reason": reason} for name, reason in self.objects]
