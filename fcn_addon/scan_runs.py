# SPDX-License-Identifier: GPL-3.0-or-later
"""The two runs that begin with a scan: its curves alone, and all the way to the completed network."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import detecting, progress, session, sources
from .identity import Identity
from .scans import Detected

DETECT = session.Doing(detecting.take, detecting.seconds, detecting.work, detecting.finish, progress.DETECTION)


def _take(context):
    return detecting.take(context, complete=True)


def _finish(context, task, made):
    """Put the curves and the result into the scene, or neither; the result's collection."""
    item = detecting.finish(context, task, made)
    try:
        reading = Detected(task.label, 0, 0, made.found).reading
        own = sources.Task(
            task.label, task.scene, (Identity.of(item),), reading, np.zeros(reading.count, np.int64),
            reading.edge_length, task.method, task.replace,
        )  # fmt: skip
        return session.finish(context, own, made.completion)
    except BaseException:
        detecting.remove(item)
        raise


def _beside(task):
    return replace(task, method=session.leaving_room(task.method))


COMPLETE_SCAN = session.Doing(_take, detecting.seconds, detecting.work, _finish, progress.SCAN, _beside)
