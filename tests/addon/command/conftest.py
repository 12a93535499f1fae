# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line in this process."""

import pytest


@pytest.fixture
def fcn(bpy, part, capsys):
    """Run the command; exit code and what went to stderr."""
    main = part("fcn_addon.command.run").main

    def run(*arguments):
        code = main([str(a) for a in arguments])
        return code, capsys.readouterr().err

    return run


@pytest.fixture
def folder(tmp_path, monkeypatch, arcs):
    """The current folder, with one input in it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.obj").write_text(arcs())
    return tmp_path
