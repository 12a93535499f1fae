# SPDX-License-Identifier: GPL-3.0-or-later
"""From the progress of single stages to that of the whole run and the time left."""

from __future__ import annotations

LABELS = {
    "mesh": "Cleaning the mesh",
    "curvature": "Measuring curvature",
    "lines": "Tracing feature curves",
    "blast": "Matching curves",
    "seeding": "Refining matches",
    "growth": "Growing what recurs",
    "orbits": "Finding orbits",
    "selection": "Selecting the model",
    "completion": "Completing curves",
    "fitting": "Fitting lines and arcs",
}

TRUST = 0.15
"""Share of the whole run that must be over for what was measured to count as much as what was expected."""

AGREED = 0.15
"""Share of a stage that must be over for its own speed to count as much as what was expected of it."""


LATE = 0.5
"""Share of the time by which a stage is late that it still takes, where it does not say how far it is."""

RISE, SHORT = 0.25, 2.0
"""Share by which the time left may rise in a second, and the seconds for which it is meant where less is left. What is
learned of a run shows within seconds, and the number does not jump under the eye."""


class Progress:
    """How far a run is.

    expected : stage -> seconds that it is thought to take, in the order of the stages
    now : seconds of some clock
    """

    def __init__(self, expected, now):
        self.stage, self.fraction = "", 0.0
        self._expected = dict(expected)
        self._began = now
        self._since, self._done = now, 0.0  # of the present stage: when it began, and how much of it is over
        self._took = {}  # stage that is over -> seconds
        self._skipped = set()
        self._left, self._at = sum(self._expected.values()), now

    def expect(self, expected, now=None):
        """Take in how many seconds each stage is thought to take."""
        first, self._expected = not self._expected, dict(expected)
        now = self._at if now is None else now
        if first:  # there was no number yet that could jump
            self._left, self._at = sum(self._expected.values()), now
        else:
            self._look(now)

    def update(self, stage, fraction, now):
        """Take in what a stage says; the whole never goes back."""
        if stage != self.stage:
            if self.stage:
                self._took[self.stage] = self._took.get(self.stage, 0.0) + now - self._since
                for skipped in self._between(self.stage, stage):
                    self._skipped.add(skipped)
            self.stage, self._since, self._done = stage, now, 0.0
        self._done = max(self._done, min(max(fraction, 0.0), 1.0))
        self._look(now)

    def look(self, now):
        """Take in that time has gone by."""
        self._look(now)

    def left(self, now) -> float:
        """Seconds that it will still take."""
        return max(self._left - (now - self._at), 0.0)

    @property
    def label(self) -> str:
        """The stage in words."""
        return LABELS.get(self.stage, self.stage.capitalize() or "Starting")

    def _between(self, before, after):
        order = list(self._expected)
        if before not in order or after not in order:
            return []
        return order[order.index(before) + 1 : order.index(after)]

    def _look(self, now):
        """Work out the time left: what stages are expected to take, by how this run compares with that so far."""
        if not self._expected:  # nothing is known yet
            return
        pace = self._pace(now)
        over = {*self._took, *self._skipped, self.stage}
        rest = sum(s * pace for stage, s in self._expected.items() if stage not in over)
        shown = self.left(now)
        most = shown + RISE * max(shown, SHORT) * (now - self._at)
        self._left, self._at = min(rest + self._left_of_stage(now, pace), most), now
        whole = now - self._began + self._left
        ended = self._is_last() and self._done >= 1
        share = 1.0 if ended else (now - self._began) / whole if whole > 0 else 0.0
        self.fraction = min(max(self.fraction, share), 1.0)

    def _pace(self, now):
        """How many times as long as expected this run takes: 1 at first, more and more what is measured."""
        start = TRUST * sum(self._expected.values())
        expected = start + sum(self._expected.get(stage, 0.0) for stage in self._took)
        measured, here = start + sum(self._took.values()), now - self._since
        own = self._expected.get(self.stage, 0.0)
        if self._done > 0:
            measured, expected = measured + here, expected + own * self._done
        pace = measured / expected if expected > 0 else 1.0
        late = self.stage and self._done <= 0 and here > own * pace  # and it does not say how far it is
        return (measured + here) / (expected + own) if late and expected + own > 0 else pace

    def _left_of_stage(self, now, pace):
        """Seconds that the present stage still takes, by what was expected and by its own speed."""
        if not self.stage or self._done >= 1:
            return 0.0
        here, by_plan = now - self._since, self._expected.get(self.stage, 0.0) * pace
        if self._done <= 0:
            return max(by_plan - here, LATE * (here - by_plan))
        by_speed = here / self._done
        weight = self._done / (self._done + AGREED) if by_plan > 0 and by_speed > 0 else 1.0
        # Both may be wrong by a factor: the mean of their logarithms.
        return (1 - self._done) * by_speed**weight * max(by_plan, 1e-9) ** (1 - weight)

    def _is_last(self):
        return bool(self._expected) and self.stage == list(self._expected)[-1]
