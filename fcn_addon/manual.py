# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual that comes with the extension, as a page for a browser: docs/blender.md, made into HTML when asked for.

It needs no network and is always that of the version that is installed.
"""

from __future__ import annotations

import html
import re
from pathlib import Path

from .installation import ROOT, version

SOURCE = ROOT / "docs" / "blender.md"
STYLE = (
    "body { font: 16px/1.5 sans-serif; max-width: 52em; margin: 2em auto; padding: 0 1em; color: #222 }"
    " img { max-width: 100%; border: 1px solid #ccc } table { border-collapse: collapse; margin: 1em 0 }"
    " td, th { border: 1px solid #ccc; padding: .3em .6em; text-align: left; vertical-align: top }"
    " code { background: #f0f0f0; padding: 0 .2em }"
)


def write(folder) -> Path:
    """Write the page into a folder; its path."""
    path = Path(folder) / f"feature_curves_{version()}.html"
    path.write_text(page(SOURCE.read_text(encoding="utf-8"), SOURCE.parent), encoding="utf-8")
    return path


def page(text, folder) -> str:
    """Markdown as this project writes it, as a whole page; pictures are those of `folder`."""
    body = "\n".join(_blocks(text.splitlines(), folder))
    title = next((line[2:] for line in text.splitlines() if line.startswith("# ")), "Manual")
    head = f'<meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style>'
    return f"<!doctype html><html><head>{head}</head><body>{body}</body></html>\n"


def anchor(heading) -> str:
    """What a heading is linked by: "The parts of the panel" is the-parts-of-the-panel."""
    return re.sub(r"[^\w-]", "", heading.strip().lower().replace(" ", "-"))


def _blocks(lines, folder):
    """HTML of headings, lists, tables and paragraphs, one after the other."""
    i = 0
    while i < len(lines):
        line = lines[i]
        heading = re.match(r"(#{1,4}) (.*)", line)
        if heading:
            level = len(heading[1])
            yield f'<h{level} id="{anchor(heading[2])}">{_inline(heading[2], folder)}</h{level}>'
            i += 1
        elif line.startswith("|"):
            end = _end(lines, i, lambda text: text.startswith("|"))
            yield _table(lines[i:end], folder)
            i = end
        elif re.match(r"(\d+\.|-) ", line):
            end = _end(lines, i, lambda text: not text or text.startswith(" ") or re.match(r"(\d+\.|-) ", text))
            yield _list(lines[i:end], folder)
            i = end
        elif not line.strip() or line.startswith("<!--"):
            i += 1
        else:
            end = _end(lines, i, lambda text: text.strip() and not re.match(r"#{1,4} |\||(\d+\.|-) ", text))
            yield f"<p>{_inline(' '.join(lines[i:end]), folder)}</p>"
            i = end


def _end(lines, first, goes_on):
    """Index after the last line of a block."""
    return next((k for k in range(first + 1, len(lines)) if not goes_on(lines[k])), len(lines))


def _table(rows, folder):
    cells = [[_inline(cell.strip(), folder) for cell in row.strip().strip("|").split("|")] for row in rows]
    cells = [row for row in cells if not all(re.fullmatch(r":?-+:?", cell) for cell in row)]
    head, *rest = ("<tr>" + "".join(f"<{tag}>{c}</{tag}>" for c in row) + "</tr>" for tag, row in _tagged(cells))
    return "<table>" + head + "".join(rest) + "</table>"


def _tagged(rows):
    return [("th" if i == 0 else "td", row) for i, row in enumerate(rows)]


def _list(lines, folder):
    """A list; what is indented belongs to its item."""
    kind, items = ("ol" if lines[0][0].isdigit() else "ul"), []
    for line in lines:
        start = re.match(r"(?:\d+\.|-) (.*)", line)
        if start:
            items.append([start[1]])
        else:
            items[-1].append(line.strip())
    out = []
    for item in items:
        parts = " ".join(item[k] or "\n" for k in range(len(item))).split("\n")
        out.append("<li>" + "<br>".join(_inline(p.strip(), folder) for p in parts if p.strip()) + "</li>")
    return f"<{kind}>" + "".join(out) + f"</{kind}>"


def _inline(text, folder) -> str:
    """Words with code, pictures, links, bold and slanted ones."""
    out = []
    for i, part in enumerate(re.split(r"`([^`]*)`", text)):
        part = html.escape(part, quote=False)
        if i % 2:
            out.append(f"<code>{part}</code>")
            continue
        part = re.sub(r"!\[([^\]]*)\]\(([^)]*)\)", lambda m: _picture(m[1], m[2], folder), part)
        part = re.sub(r"\[([^\]]*)\]\((#[^)]*)\)", r'<a href="\2">\1</a>', part)
        part = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", part)  # other pages are not here
        part = re.sub(r"\*\*([^*]+)\*\*", r"<b>\1</b>", part)
        out.append(re.sub(r"\*([^*]+)\*", r"<i>\1</i>", part))
    return "".join(out)


def _picture(words, path, folder):
    place = (Path(folder) / path).resolve()
    return f'<img alt="{html.escape(words)}" src="{place.as_uri()}">'
