# SPDX-License-Identifier: GPL-3.0-or-later
"""The share of a run that is done, and the time left."""

import pytest

EXPECTED = {"blast": 2.0, "seeding": 4.0, "growth": 10.0, "completion": 4.0}


def drive(progress, took, ticks=20, told=()):
    """(seconds since the start, what is said to be left, fraction) along a run whose stages take so long.

    told : stages that say how far they are; the others say 0 all the time
    """
    run, now, seen = progress.Progress(EXPECTED, 0.0), 0.0, []
    for stage, seconds in took.items():
        for i in range(ticks):
            run.update(stage, i / ticks if stage in told else 0.0, now + seconds * i / ticks)
            seen.append((now + seconds * i / ticks, run.left(now + seconds * i / ticks), run.fraction))
        now += seconds
        run.update(stage, 1.0, now)
        seen.append((now, run.left(now), run.fraction))
    return seen


def test_the_tables_have_every_stage_and_its_words(part):
    progress, rates = part("fcn_addon.progress"), part("fcn_addon.rates")
    assert list(rates.COMPLETING) == [*part("core.report").STAGES, "fitting"]
    assert list(rates.DETECTING) == ["mesh", "curvature", "lines"]
    assert {*rates.COMPLETING, *rates.DETECTING} == set(progress.LABELS)
    small, large = rates.completing(2_000), rates.completing(20_000)
    assert all(0 < small[stage] < large[stage] for stage in rates.COMPLETING)
    at_one = sum(base + rate for base, rate, _ in rates.COMPLETING.values())
    assert sum(rates.completing(rates.SAMPLES).values()) == pytest.approx(at_one)


@pytest.mark.parametrize("pace", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("told", [(), tuple(EXPECTED)])
def test_progress_never_goes_back_and_ends_at_one(part, pace, told):
    seen = drive(part("fcn_addon.progress"), {s: pace * t for s, t in EXPECTED.items()}, told=told)
    fractions = [fraction for *_, fraction in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1 and seen[-1][1] == 0
    assert all(f < 1 for f in fractions[:-1])


def test_a_run_as_expected_is_told_to_the_second(part):
    whole = sum(EXPECTED.values())
    for now, left, fraction in drive(part("fcn_addon.progress"), EXPECTED):
        assert left == pytest.approx(whole - now, abs=1e-6)
        assert fraction == pytest.approx(now / whole, abs=1e-6)


@pytest.mark.parametrize("pace", [0.4, 2.5])
def test_a_machine_of_another_speed_is_told_within_half_once_a_third_is_over(part, pace):
    whole = pace * sum(EXPECTED.values())
    seen = drive(part("fcn_addon.progress"), {s: pace * t for s, t in EXPECTED.items()}, told=tuple(EXPECTED))
    late = [(now + left) / whole for now, left, _ in seen if now > whole / 3]
    assert max(late) < 1.5 and min(late) > 1 / 1.5
    first = seen[0][0] + seen[0][1]
    assert not 1 / 1.5 < first / whole < 1.5  # that is where it began


def test_a_stage_that_is_late_and_says_nothing_makes_the_rest_longer_too(part):
    took = {**EXPECTED, "seeding": 20.0}
    seen = drive(part("fcn_addon.progress"), took)
    before, after = ([left for now, left, _ in seen if now == at] for at in (2.0, 22.0))
    assert before[0] == pytest.approx(18.0) and after[0] > 14.0


def test_stages_that_are_passed_over_are_not_waited_for(part):
    run = part("fcn_addon.progress").Progress(EXPECTED, 0.0)
    run.update("blast", 0.0, 0.0)
    run.update("completion", 0.0, 2.0)
    assert run.left(2.0) == pytest.approx(4.0)


def looked(run, since, until, step=0.1):
    """(seconds, what is left) at each tick of the window."""
    ticks = [since + step * i for i in range(1, round((until - since) / step) + 1)]
    return [(run.look(now), (now, run.left(now)))[1] for now in ticks]


def test_better_numbers_are_taken_in_while_it_runs(part):
    better, runs = {**EXPECTED, "growth": 40.0}, []
    for expected in (EXPECTED, better):
        run = part("fcn_addon.progress").Progress(expected, 0.0)
        run.update("blast", 0.0, 0.0)
        run.update("seeding", 0.0, 2.0)
        runs.append(run)
    run, knew = runs
    run.expect(better, now=2.0)
    assert run.left(2.0) == pytest.approx(18.0)  # it does not jump
    seen, wanted = looked(run, 2.0, 7.0), looked(knew, 2.0, 7.0)
    assert seen[0][1] < 19.0 and seen[-1] == pytest.approx(wanted[-1])


@pytest.mark.parametrize("told", [(), ("blast", "seeding"), tuple(EXPECTED)])
@pytest.mark.parametrize("late", EXPECTED)
def test_the_time_left_never_jumps_up_and_is_corrected(part, told, late):
    """One stage takes eight times as long as expected, and some say how far they are."""
    progress = part("fcn_addon.progress")
    took = {s: 8 * t if s == late else t for s, t in EXPECTED.items()}
    run, now, seen = progress.Progress(EXPECTED, 0.0), 0.0, []
    for stage, seconds in took.items():
        for i in range(round(10 * seconds)):
            run.update(stage, i / (10 * seconds) if stage in told else 0.0, now + i / 10)
            seen.append((now + i / 10, run.left(now + i / 10)))
        now += seconds
    for (at, before), (then, after) in zip(seen, seen[1:]):
        assert after <= before + progress.RISE * max(before, progress.SHORT) * (then - at) + 1e-6, then
    if late in told:  # a third of it shows that it is slow
        begun = sum(took[s] for s in list(EXPECTED)[: list(EXPECTED).index(late)])
        third = next(at + left for at, left in seen if at >= begun + took[late] / 3)
        assert 1 / 1.7 < third / now < 1.7


def test_the_pace_does_not_break_where_a_silent_stage_gets_late(part):
    """On a machine that takes twice as long; the time left goes on from tick to tick."""
    run = part("fcn_addon.progress").Progress(EXPECTED, 0.0)
    run.update("blast", 0.0, 0.0)
    run.update("seeding", 0.0, 4.0)
    seen = looked(run, 4.0, 30.0)
    assert max(abs(b - a) for (_, a), (_, b) in zip(seen, seen[1:])) < 0.2


def test_before_anything_is_expected_nothing_is_done(part):
    run = part("fcn_addon.progress").Progress({}, 0.0)
    run.update("blast", 0.5, 1.0)
    run.look(2.0)
    assert run.fraction == 0
    run.expect(EXPECTED)
    run.look(2.0)
    assert 0 < run.fraction < 0.5 and run.left(2.0) > 10
