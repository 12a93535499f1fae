# SPDX-License-Identifier: GPL-3.0-or-later
"""What a terminal and a log are told of a run."""

import io


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def test_progress_in_a_log_is_a_line_a_tenth_with_the_time_left(part):
    clock, stream = Clock(), io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(stream=stream, clock=clock)
    for i in range(101):
        clock.now = i * 1.0
        terminal.progress("blast", i / 100)
    lines = stream.getvalue().splitlines()
    assert len(lines) == 11
    assert lines[2].split() == ["blast", "20%", "1", "min", "20", "s", "left"]
    assert lines[-1].split() == ["blast", "100%", "1", "min", "40", "s"]


def test_progress_of_a_short_stage_is_one_line_in_a_log(part):
    stream = io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(stream=stream, clock=Clock())
    for stage in ("blast", "seeding"):
        for i in range(11):
            terminal.progress(stage, i / 10)
    assert [line.split()[:2] for line in stream.getvalue().splitlines()[1:]] == [["blast", "100%"], ["seeding", "100%"]]


def test_quiet_says_errors_only(part):
    stream = io.StringIO()
    terminal = part("fcn_addon.command.terminal").Terminal(quiet=True, stream=stream)
    terminal.say("a")
    terminal.progress("blast", 0.5)
    terminal.error("b\nc")
    assert stream.getvalue() == "error: b c\n"
