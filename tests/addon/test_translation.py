# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts can be translated. PyPI's bpy has no languages; tests/window/language.py sees them in a real Blender."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
SHOWN = ("job/session.py", "job/completing.py", "job/detecting.py", "scene/reader.py", "scene/edge_length.py")
FILES = sorted(
    [*(ROOT / "operators").rglob("*.py"), *(ROOT / "ui").glob("*.py"), *(ROOT / "fcn_addon" / n for n in SHOWN)]
)
TRANSLATE = {"iface_", "rpt_"}
WORDS = {"label", "report", "progress", "operator", "poll_message_set", "InputError"}


def name_of(call):
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def calls(path, names):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call) and name_of(node) in names]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_words_are_never_mixed_with_values_before_they_are_translated(path):
    """A dictionary knows whole texts: those with places for values must be looked up before these are filled in."""
    for call in calls(path, WORDS):
        for node in ast.walk(call):
            if isinstance(node, ast.JoinedStr):
                said = "".join(part.value for part in node.values if isinstance(part, ast.Constant))
                assert not re.search("[a-z]", said), f"line {node.lineno}: {said}"
    for call in calls(path, TRANSLATE):
        (text,) = call.args
        assert isinstance(text, ast.Constant) and isinstance(text.value, str), f"line {call.lineno}"


def test_places_for_values_are_named():
    """So that a translation may put them in another order."""
    texts = [call.args[0].value for path in FILES for call in calls(path, TRANSLATE)]
    assert len(texts) > 30
    for text in texts:
        assert all(re.match("[a-z]+[!:}]", rest) for rest in text.split("{")[1:]), text
