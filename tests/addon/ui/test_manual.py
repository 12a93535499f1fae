# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual that comes with the extension, and where the buttons lead in it."""

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

import pytest


class Page(HTMLParser):
    """What a page holds: ids, pictures, text of headings, and whether all that was opened was closed."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.pictures, self.open, self.cells = [], [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "img":
            self.pictures.append(attributes["src"])
        if tag not in {"img", "meta", "br"}:
            self.open.append(tag)
        self.cells[tag] = self.cells.get(tag, 0) + 1

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture
def page(part, tmp_path):
    return part("fcn_addon.manual").write(tmp_path)


def test_the_page_is_whole_and_its_pictures_are_there(page):
    text = page.read_text(encoding="utf-8")
    found = Page(text)
    assert not found.open and len(found.ids) == len(set(found.ids)) > 5
    assert len(found.pictures) > 5
    for source in found.pictures:
        assert Path(url2pathname(urlparse(source).path)).is_file(), source
    assert found.cells["table"] >= 5 and found.cells["ol"] >= 3
    body = re.sub(r"<style>.*?</style>|<[^>]+>", "", text)
    assert "](" not in body and "**" not in body and "| " not in body


def test_markdown_becomes_what_it_means(part):
    text = "# A & B\n\n1. *one*\n   goes on\n2. `x * y`\n\n| a | b |\n|---|---|\n| **c** | [d](#a--b) |\n\n"
    text += "last [line](x.md)\n"
    found = part("fcn_addon.manual").page(text, ".")
    for wanted in (
        '<h1 id="a--b">A &amp; B</h1>', "<ol><li><i>one</i> goes on</li><li><code>x * y</code></li></ol>",
        "<tr><th>a</th><th>b</th></tr>", '<td><b>c</b></td><td><a href="#a--b">d</a></td>', "<p>last line</p>",
    ):  # fmt: skip
        assert wanted in found


LEADS = {  # heading -> operators that it is about
    "Install in three steps": {"try_example"},
    "From a scan to curves": {"detect", "complete_scan"},
    "From curves to a result": {"complete", "cancel"},
    "The parts of the panel": {
        "measure", "save_preset", "apply", "remove_result", "restore", "select_template", "select_transformation",
        "reject_transformation",
    },
    "Occurrences": {
        "select_occurrence", "select_source", "select_result", "edit_template", "make_unique", "reject_occurrence",
        "delete_occurrence",
    },
    "Files in and out": {"import_curves", "export_curves"},
    "Good to know": {"manual"},
}  # fmt: skip


def heading_of(part, name):
    """The heading of the manual that Blender opens for what it calls a button."""
    from bl_operators.wm import WM_OT_doc_view_manual

    url = WM_OT_doc_view_manual._lookup_rna_url(name, verbose=False)
    manual = part("fcn_addon.manual")
    headings = [line[3:] for line in manual.SOURCE.read_text(encoding="utf-8").splitlines() if line.startswith("## ")]
    return next(h for h in headings if manual.anchor(h) == url.partition("#")[2])


def test_every_operator_leads_to_what_is_said_of_it(bpy, part):
    wanted = {f"fcn.{name}": heading for heading, names in LEADS.items() for name in names}
    idnames = [cls.bl_idname for cls in part("operators").CLASSES]
    assert {name: heading_of(part, f"bpy.ops.{name}") for name in idnames} == wanted
    assert heading_of(part, "bpy.types.FCN_AP_preferences.keep") == "Preferences"
    assert heading_of(part, "bpy.types.FCN_PG_detection.detail") == "From a scan to curves"
    assert heading_of(part, "bpy.types.FCN_PG_result.solo") == "The parts of the panel"


def test_every_button_leads_to_a_part_of_the_manual_that_is_there(bpy, part, page):
    from bl_operators.wm import WM_OT_doc_view_manual

    ids = Page(page.read_text(encoding="utf-8")).ids
    wanted = [f"bpy.ops.{cls.bl_idname}" for cls in part("operators").CLASSES]
    wanted += ["bpy.types.FCN_PG_detection.detail", "bpy.types.FCN_PG_parameters.l0", "bpy.types.FCN_PG_result.view",
               "bpy.types.FCN_PG_settings.form", "bpy.types.FCN_PG_template.colour"]  # fmt: skip
    for name in wanted:
        url = WM_OT_doc_view_manual._lookup_rna_url(name, verbose=False)
        assert url is not None and url.startswith("file:"), name
        assert url.partition("#")[2] in ids, (name, url)
    other = WM_OT_doc_view_manual._lookup_rna_url("bpy.types.Object.location", verbose=False)
    assert other is None or other.startswith("https:")
