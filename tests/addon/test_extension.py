# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension is enabled, disabled, and unwinds where a room fails."""

import sys
import types

import pytest


def test_it_is_enabled_under_its_name(extension, part):
    import bpy

    assert extension in bpy.context.preferences.addons
    assert part("fcn_addon.registration")._registered  # all rooms
    assert len(part("fcn_addon.registration")._registered) == len(part("fcn_addon.registration").ROOMS)


def test_it_can_be_disabled_and_enabled_again(extension, part):
    root = part("fcn_addon.registration")
    sys.modules[extension].unregister()
    assert root._registered == []
    assert part("fcn_addon.command.subcommand")._handles == []
    sys.modules[extension].register()
    assert len(root._registered) == len(root.ROOMS)
    assert len(part("fcn_addon.command.subcommand")._handles) == 1


@pytest.fixture
def rooms(extension, part, monkeypatch):
    """Three rooms that note what is asked of them, in place of the real ones; the last cannot register."""
    registration, done = part("fcn_addon.registration"), []
    sys.modules[extension].unregister()

    def room(name, fails=False):
        module = types.ModuleType(f"{extension}.{name}")

        def register():
            if fails:
                raise RuntimeError(f"{name} cannot")
            done.append(f"+{name}")

        module.register, module.unregister = register, lambda: done.append(f"-{name}")
        monkeypatch.setitem(sys.modules, module.__name__, module)
        return name

    monkeypatch.setattr(registration, "ROOMS", (room("a"), room("b"), room("c", fails=True)))
    yield registration, done
    monkeypatch.undo()
    sys.modules[extension].register()


def test_a_room_that_fails_is_loud_and_the_others_are_undone_in_reverse(rooms):
    registration, done = rooms
    with pytest.raises(RuntimeError, match="c cannot"):
        registration.register()
    assert done == ["+a", "+b", "-b", "-a"]
    assert registration._registered == []


def test_a_room_that_cannot_be_undone_does_not_keep_the_others(rooms, monkeypatch):
    registration, done = rooms
    registration.ROOMS = registration.ROOMS[:2]
    registration.register()

    def fails():
        raise RuntimeError("b stays")

    registration._registered[1].unregister = fails
    with pytest.raises(RuntimeError, match="b stays"):
        registration.unregister()
    assert done == ["+a", "+b", "-a"]
    assert registration._registered == []
