# SPDX-License-Identifier: GPL-3.0-or-later
"""From the progress of single stages to that of the whole run and the time left."""

from __future__ import annotations

# Share of the whole time that each stage takes, measured on the scenes of benchmarks/.
SHARES = {"blast": 0.12, "seeding": 0.3, "growth": 0.4, "orbits": 0.02, "selection": 0.01, "completion": 0.15}
DETECTION = {"mesh": 0.1, "curvature": 0.55, "lines": 0.35}
SCAN = {name: 0.1 * share for name, share in DETECTION.items()} | {name: 0.9 * x for name, x in SHARES.items()}
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
}


class Progress:
    """How far a run is.

    estimate : seconds that the run is thought to take, before anything is known
    now : seconds of some clock
    shares : stage -> share of the time, in the order of the stages
    """

    def __init__(self, estimate, now, shares=SHARES):
        self.stage = ""
        self._shares = shares
        self.fraction = 0.0
        self._estimate = estimate
        self._began = self._at = now

    def expect(self, estimate):
        """Take in how many seconds the run is thought to take."""
        self._estimate = estimate

    def update(self, stage, fraction, now):
        """Take in what a stage says; the whole never goes back."""
        order = list(self._shares)
        known = stage in self._shares
        before = sum(self._shares[s] for s in order[: order.index(stage)]) if known else self.fraction
        done = before + self._shares.get(stage, 0.0) * min(max(fraction, 0.0), 1.0)
        self.stage = stage
        self.fraction = min(max(self.fraction, done), 1.0)
        self._at = now

    def left(self, now) -> float:
        """Seconds that it will still take: the estimate at first, more and more what is measured."""
        elapsed = now - self._began
        trust = self.fraction
        if trust <= 0:
            return max(self._estimate - elapsed, 0.0)
        since = now - self._at
        measured = (elapsed - since) * (1 - trust) / trust - since
        weight = min(1.0, 3 * trust)
        return max(weight * measured + (1 - weight) * (self._estimate - elapsed), 0.0)

    @property
    def label(self) -> str:
        """The stage in words."""
        return LABELS.get(self.stage, self.stage.capitalize() or "Starting")
