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
