"""A self-contained HTML page: headings with a table of contents, tables, inline figures."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from voussoir.files import read_text
from voussoir.html_page import cell, document, escape, table

_STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 74rem; padding: 0 1rem 4rem; background: #fff; color: #1a1a1a;
  font: 1rem/1.55 STIXGeneral, "STIX Two Text", Georgia, serif; overflow-wrap: break-word; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 2rem 0 .5rem; }
h2 { font-size: 1.45rem; margin: 3rem 0 .5rem; padding-top: .5rem; border-top: 2px solid #1a1a1a; }
h3 { font-size: 1.15rem; margin: 2rem 0 .4rem; }
p, ul, ol { max-width: 46rem; }
nav { background: #f4f4f1; padding: .6rem 1.2rem; margin: 1.5rem 0; }
nav ol { margin: .3rem 0; padding-left: 1.3rem; columns: 2; column-gap: 2.5rem; }
nav li { break-inside: avoid; }
a { color: #174a82; }
figure { margin: 1.5rem 0; }
figcaption, .caption { font-size: .95rem; max-width: 46rem; margin: 0; padding: .4rem 0; }
.paper { color: #555; }
.table { margin: 1.5rem 0; }
.wide { overflow-x: auto; }
.wide:focus { outline: 2px solid #1f5fa8; }
figure svg { display: block; width: 100%; height: auto; max-width: calc(1.2*var(--width)); }
#top img { max-width: min(34rem, 100%); }
.pair { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr));
  gap: 1rem; align-items: end; }
figure img { display: block; max-width: 100%; height: auto; }
table { border-collapse: collapse; font: .86rem/1.35 Arial, Helvetica, sans-serif;
  font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .5rem; text-align: right; white-space: nowrap;
  border-bottom: 1px solid #d6d6d0; }
th { border-bottom: 2px solid #1a1a1a; vertical-align: bottom; }
td small, th small { display: block; color: #555; }
tr > :first-child { position: sticky; left: 0; background: #fff; }
table.words td { text-align: left; white-space: normal; }
pre { overflow-x: auto; background: #f4f4f1; padding: .8rem; font-size: .82rem; line-height: 1.4; }
summary { cursor: pointer; }
@media (max-width: 40rem) { nav ol { columns: 1; } h1 { font-size: 1.5rem; }
  body { padding: 0 .6rem 3rem; } table { font-size: .72rem; } th, td { padding: .2rem .28rem; }
  th { white-space: normal; } }
@media print { @page { margin: 12mm; } body { max-width: none; padding: 0; font-size: 10pt; }
  .wide, pre { overflow: visible; } table { font-size: 7pt; } th, td { padding: 1pt 3pt; }
  th { white-space: normal; } pre { white-space: pre-wrap; } figure, tr, .caption { break-inside: avoid; }
  figure svg { width: calc(.85*var(--width)); max-width: 100%; max-height: 150mm; }
  #top img { max-height: 95mm; width: auto; } nav { break-inside: avoid; } h2 { margin-top: 1.5rem; }
  h2, h3, .caption { break-after: avoid; } .pair { display: block; } .pair figure + figure { display: none; } }
"""


class Page:
    """A page that grows from top to bottom, below its title."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._body: list[str] = []
        self._contents: list[tuple[int, str, str]] = []
        self._figures = 0

    def section(self, title: str, anchor: str, level: int = 2) -> None:
        """Begin a section; those of level 2 and 3 are in the table of contents."""
        self._contents.append((level, title, anchor))
        self._body.append(f'<h{level} id="{anchor}">{escape(title)}</h{level}>')

    def text(self, *paragraphs: str) -> None:
        """Add paragraphs; they may hold HTML."""
        self._body += [f"<p>{paragraph}</p>" for paragraph in paragraphs]

    def table(
        self, caption: str, head: Sequence[str], rows: Iterable[Sequence[str]], anchor: str = "", words: bool = False
    ) -> None:
        """Add a table, of words rather than numbers where said; headings may hold HTML."""
        heads = [f'<th scope="col">{word}</th>' for word in head]
        body = table(heads, ([cell(word) for word in row] for row in rows), "words" if words else "")
        named = f' id="{anchor}"' if anchor else ""
        self._body.append(
            f'<div class="table"{named}><p class="caption">{caption}</p>'
            f'<div class="wide" tabindex="0">{body}</div></div>')

    def figure(self, svg: Path, caption: str, anchor: str) -> None:
        """Add a figure from an SVG file."""
        self._figures += 1
        drawing = inline_svg(read_text(svg), f"f{self._figures}-", caption)
        self._body.append(
            f'<figure id="{anchor}"><div class="wide" tabindex="0">{drawing}</div>'
            f"<figcaption>{caption}</figcaption></figure>"
        )

    def begin_pair(self) -> None:
        """Put the figures that follow side by side, where there is room."""
        self._body.append('<div class="pair">')

    def end_pair(self) -> None:
        """End what `begin_pair` has begun."""
        self._body.append("</div>")

    def picture(self, file: Path, caption: str, anchor: str) -> None:
        """Add a GIF or a PNG."""
        data = base64.b64encode(file.read_bytes()).decode("ascii")
        plain = escape(re.sub("<[^>]*>", "", caption))
        self._body.append(
            f'<figure id="{anchor}"><img alt="{plain}" src="data:image/{file.suffix[1:]};base64,{data}">'
            f"<figcaption>{caption}</figcaption></figure>"
        )

    def listing(self, title: str, text: str) -> None:
        """Add a text that opens at a click."""
        self._body.append(f"<details><summary>{escape(title)}</summary><pre>{escape(text)}</pre></details>")

    def render(self) -> str:
        """The page as HTML; the table of contents stands where the first section begins."""
        entries = "".join(
            f'<li><a href="#{anchor}">{escape(title)}</a></li>' for level, title, anchor in self._contents if level == 2
        )
        nav = f'<nav aria-label="Contents"><strong>Contents</strong><ol>{entries}</ol></nav>'
        place = next((i for i, part in enumerate(self._body) if part.startswith("<h2")), 0)
        body = [*self._body[:place], nav, *self._body[place:]]
        return document(self._title, _STYLE, "\n".join([f"<h1>{escape(self._title)}</h1>", *body, ""]))


def inline_svg(text: str, prefix: str, label: str) -> str:
    """An SVG file as an element of a page, as wide as its place and at most as wide as it was drawn.

    The prefix goes before all its names, which otherwise meet those of other figures; the label is for those who cannot
    see it.
    """
    svg = text[text.index("<svg") :].strip()
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r'\bid="', f'id="{prefix}', svg)
    svg = re.sub(r'href="#', f'href="#{prefix}', svg)
    svg = re.sub(r"url\(#", f"url(#{prefix}", svg)
    head, _, rest = svg.partition(">")
    width = re.search(r'\bwidth="([\d.]+)pt"', head)
    head = re.sub(r'\s(width|height)="[\d.]+pt"', "", head)
    plain = escape(re.sub("<[^>]*>", "", label))
    points = float(width.group(1)) if width else 460.0
    style = f'style="--width: {points * 4 / 3:.0f}px"'
    return f'{head} role="img" aria-label="{plain}" {style}>{rest}'
