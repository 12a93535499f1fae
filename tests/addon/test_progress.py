# SPDX-License-Identifier: GPL-3.0-or-later
"""The share of a run that is done, and the time left."""

import pytest


def test_progress_never_goes_back_and_ends_at_one(part):
    progress = part("fcn_addon.progress")
    assert sum(progress.SHARES.values()) == pytest.approx(1)
    assert list(progress.SHARES) == list(part("core.report").STAGES)
    assert list(progress.SCAN) == [*progress.DETECTION, *progress.SHARES] and set(progress.SCAN) == set(progress.LABELS)
    assert sum(progress.DETECTION.values()) == pytest.approx(1) == sum(progress.SCAN.values())
    run, seen = progress.Progress(10, 0.0), []
    for i, stage in enumerate(part("core.report").STAGES):
        for fraction in (0.0, 0.5, 0.2, 1.0):
            run.update(stage, fraction, float(i))
            seen.append(run.fraction)
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx(1)
    assert run.left(5.0) == pytest.approx(0, abs=1e-9)


def test_time_left_starts_with_the_estimate_and_ends_with_what_is_measured(part):
    progress = part("fcn_addon.progress")
    run = progress.Progress(100, 0.0)
    assert run.left(0.0) == 100
    assert run.left(30.0) == 70
    run.update("completion", 0.0, 7.5)
    share = run.fraction
    assert share > 1 / 3  # from there on only what is measured counts
    assert run.left(7.5) == pytest.approx(7.5 * (1 - share) / share)
