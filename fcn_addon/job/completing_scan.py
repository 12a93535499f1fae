# SPDX-License-Identifier: GPL-3.0-or-later
"""The run from a scan all the way to the completed network."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..detected import kept
from ..scans import Detected
from ..scene.identity import Identity
from . import completing, detecting
from .session import RunKind


def _take(context):
    return detecting.take(context, complete=True)


def _finish(context, task, made):
    """Put the curves and the result into the scene, or neither; the result's collection."""
    item = detecting.finish(context, task, made)
    try:
        reading = Detected(task.label, 0, 0, made.found).reading
        own = completing.Task(
            task.label, task.scene, (Identity.of(item),), reading, np.zeros(reading.count, np.int64),
            reading.edge_length, task.method, task.replace,
        )  # fmt: skip
        return completing.finish(context, own, made.completion, made.fitted)
    except BaseException:
        kept.remove(item)
        raise


def _beside(task):
    return replace(task, method=completing.leaving_room(task.method))


COMPLETE_SCAN = RunKind(_take, detecting.expected, detecting.work, _finish, _beside)
